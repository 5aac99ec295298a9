"""Logs that were written more often than the device had new values: each of its samples stands in several rows.

A row that repeats the one before in all channels is no sample. Taken for one, it is a drive that stood still for a
moment under a torque, and then jumped. Nor is one in which the motion repeats, and the torque, of the program that
logs, goes on: a motor controller that tells position and velocity every 20 ms, in a log with a row every 5 ms.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.recording import Recording
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.segments import stretches

_LEAST = 200
"""Rows from which that can be told."""
_NEW = 0.6
"""Share of the rows that are new, up to which they were polled: two rows a sample, and some that were late."""
_TOGETHER = 0.95
"""Share of the new rows with a new torque, at least: what was polled apart, or is in coarse steps, changes apart."""
_MOVES = 0.5
"""Share of them in which the motion has a new value as well, at least."""
_EVEN = 0.8
"""Share of the values of a motion that stand in equally many rows, at least: a coarse encoder's last as it moves."""
_STEPS = 4.0
"""Steps of its grid by which a channel changes, as a rule, where a repeated value is no rounding."""


def once_each(recording: Recording) -> Recording:
    """Return a recording with each sample once, in the row in which it first stands; as it is if none repeat.

    Where nothing changes for longer, at rest, the rows go on as far apart.
    """
    rows = _rows_of_samples(recording)
    if rows is not None:
        return _at(rows, recording)
    every = _rows_of_a_motion(recording)
    if every is None:
        return recording
    return _at(_regularly(every, recording), _averaged(recording, every), of="motion")


def _at(rows: Index, recording: Recording, **of: str) -> Recording:
    found = recording.select(rows)
    known = {"rows": len(recording), "samples": len(rows), **of}
    return replace(found, provenance={**found.provenance, "polled": known})


def _rows_of_samples(recording: Recording) -> Index | None:
    if len(recording) < _LEAST:
        return None
    joined = np.diff(recording.run) == 0
    torque = joined & (np.diff(recording.torque) != 0.0)
    moved = joined & np.any([_changes(recording[c]) for c in ("position", "velocity") if c in recording], axis=0)
    new = torque | moved
    count = np.count_nonzero(new)
    if not 0 < count <= _NEW * np.count_nonzero(joined):
        return None
    if np.count_nonzero(torque) < _TOGETHER * count or np.count_nonzero(new & moved) < _MOVES * count:
        return None
    begins = np.flatnonzero(np.r_[True, new | ~joined])
    lengths = np.diff(np.r_[begins, len(recording)])
    return None if np.median(lengths) < 2 else _regularly(begins, recording)


def _regularly(begins: Index, recording: Recording) -> Index:
    """Return the rows in which a sample begins; where one lasts for longer, rows as far apart as usual."""
    lengths = np.diff(np.r_[begins, len(recording)])
    apart = int(np.median(lengths))
    inside = np.arange(len(recording)) - np.repeat(begins, lengths)
    lasts = np.repeat(lengths, lengths) >= 2 * apart
    return np.flatnonzero((inside == 0) | (lasts & (inside % apart == 0)))


def _rows_of_a_motion(recording: Recording) -> Index | None:
    """Return the rows with a new motion, where it has one every so many rows, whatever the torque.

    Of position and velocity each is new with the other. Where one is measured alone it changes by many steps of its
    grid at once: a coarse one at a steady speed changes as evenly. Of a short log every row is needed.
    """
    measured = [recording[c] for c in ("position", "velocity") if recording.measures(c)]
    joined = np.diff(recording.run) == 0
    changed = [joined & _changes(values) for values in measured]
    new = np.any(changed, axis=0) if changed else np.zeros(0, dtype=bool)
    count = np.count_nonzero(new)
    if not _LEAST <= count <= _NEW * np.count_nonzero(joined):
        return None
    if np.count_nonzero(np.all(changed, axis=0)) < _MOVES * count:
        return None
    if len(measured) == 1 and np.median(np.abs(np.diff(measured[0]))[new]) < _STEPS * quantum(measured[0]):
        return None
    begins = np.flatnonzero(np.r_[True, new | ~joined])
    between = np.diff(begins)[recording.run[begins[1:]] == recording.run[begins[:-1]]]
    apart = int(np.median(between)) if len(between) else 0
    return begins if apart >= 2 and np.mean(between == apart) >= _EVEN else None


def _averaged(recording: Recording, begins: Index) -> Recording:
    """Return a recording with the mean of the torque about each row, over as many rows as a sample lasts.

    By the trapezoidal rule, so that it is centred; over fewer rows at the ends of a run.
    """
    half = int(np.median(np.diff(begins))) / 2.0
    torque = np.empty(len(recording))
    for part in stretches(recording.time, recording.run):
        values = recording.torque[part]
        work, row = np.r_[0.0, np.cumsum(0.5 * (values[1:] + values[:-1]))], np.arange(len(values))
        reach = np.minimum(half, np.minimum(row, len(values) - 1 - row))
        over = np.interp(row + reach, row, work) - np.interp(row - reach, row, work)
        torque[part] = np.divide(over, 2.0 * reach, out=values.copy(), where=reach > 0.0)
    return replace(recording, channels={**recording.channels, "torque": torque})


def _changes(values: Array) -> Array:
    return np.asarray(np.diff(values) != 0.0)
