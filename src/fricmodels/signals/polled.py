"""Logs that were written more often than the device had new values: each of its samples stands in several rows.

A row that repeats the one before in all channels is no sample. Taken for one, it is a drive that stood still for a
moment under a torque, and then jumped.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.recording import Recording

_LEAST = 200
"""Rows from which that can be told."""
_NEW = 0.6
"""Share of the rows that are new, up to which they were polled: two rows a sample, and some that were late."""
_TOGETHER = 0.95
"""Share of the new rows with a new torque, at least: what was polled apart, or is in coarse steps, changes apart."""
_MOVES = 0.5
"""Share of them in which the motion has a new value as well, at least."""


def once_each(recording: Recording) -> Recording:
    """Return a recording with each sample once, in the row in which it first stands; as it is if none repeat.

    Where nothing changes for longer, at rest, the rows go on as far apart.
    """
    rows = _rows_of_samples(recording)
    if rows is None:
        return recording
    found = recording.select(rows)
    known = {"rows": len(recording), "samples": len(rows)}
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
    apart = int(np.median(lengths))
    if apart < 2:
        return None
    inside = np.arange(len(recording)) - np.repeat(begins, lengths)
    lasts = np.repeat(lengths, lengths) >= 2 * apart
    return np.flatnonzero((inside == 0) | (lasts & (inside % apart == 0)))


def _changes(values: Array) -> Array:
    return np.asarray(np.diff(values) != 0.0)
