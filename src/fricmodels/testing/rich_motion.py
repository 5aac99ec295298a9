"""The rich motion of the exam: what drives it, and whatever else a term asks of a recording."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.readers.units import FURTHER_UNITS
from fricmodels.recording import OTHER, RATE, RUN, Recording
from fricmodels.simulation import simulate
from fricmodels.term import Effect, Term

_SIZE = 2.0
"""RMS value of a further channel in its unit: with an angle, the other joint turns over a wide range."""
_RUNS = 3
_TONES = (0.2, 3.0)
"""Least and most frequency [Hz] of a further channel."""


def rich_motion(drive: Drive, values: Mapping[str, float], term: Term, needs: frozenset[str], name: str) -> Recording:
    """Simulate a drive under a motor torque of several frequencies and amplitudes.

    Further channels are sums of tones, always the same ones. Where the number of the run is asked for there are several
    runs.

    Args:
        drive: the drive; values: its parameters by key.
        term: the term that is tried, whose further channels the recording has.
        needs: signals beside motion and torque that the recording must have.
        name: of the recording.

    Raises:
        FricmodelsError: where the drive cannot be simulated.
    """
    rng = np.random.default_rng(0)
    time = np.asarray(1e-3 * np.arange(8000), dtype=float)
    tones = np.array([(0.35, 0.3), (0.8, 0.35), (1.7, 0.3), (3.9, 0.25), (9.1, 0.15)])
    torque = tones[:, 1] @ _sines(time, tones[:, 0], rng)
    load = 0.25 * np.sin(2 * np.pi * 0.23 * time + 0.4) + 0.1 * np.sin(2 * np.pi * 1.1 * time)
    further = {name: _further(time, rng) for name in further_channels(term)}
    return simulate(
        drive,
        values,
        time,
        torque,
        load_torque=load if "load_torque" in needs else None,
        temperature=20 + 15 * np.sin(2 * np.pi * 0.9 * time / time[-1]) if "temperature" in needs else None,
        further=further,
        units={name: _unit(term, name) for name in further},
        run=np.arange(len(time)) * (_RUNS if RUN in term.channels else 1) // len(time),
        substeps=4,
        with_position=True,
        name=name,
    )


def further_channels(term: Term) -> tuple[str, ...]:
    """Return the further channels that a term asks of a recording, for itself or for their rates."""
    return tuple(dict.fromkeys(name.removeprefix(RATE) for name in term.channels if name != RUN))


def _further(time: Array, rng: np.random.Generator) -> Array:
    frequencies = np.geomspace(*_TONES, 5) * rng.uniform(0.8, 1.2, 5)
    return np.asarray(_SIZE * (2 / 5) ** 0.5 * np.sum(_sines(time, frequencies, rng), axis=0))


def _sines(time: Array, frequencies: Array, rng: np.random.Generator) -> Array:
    return np.asarray(np.sin(2 * np.pi * (np.outer(frequencies, time) + rng.uniform(0, 1, (len(frequencies), 1)))))


def _unit(term: Term, channel: str) -> str:
    """Return a unit in which the term would be a candidate for a channel; none where it is one in no unit."""
    if not isinstance(term, Effect) or not channel.startswith(OTHER):
        return ""
    nothing = np.zeros(2)
    channels = {"time": np.arange(2.0), "torque": nothing, "velocity": nothing, channel: nothing}
    for unit in FURTHER_UNITS:
        recording = Recording("two samples", Motion.ROTARY, channels, nothing.astype(np.int64), units={channel: unit})
        if any(channel in further_channels(candidate) for candidate in type(term).candidates(recording)):
            return unit
    return ""
