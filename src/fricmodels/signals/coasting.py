"""Drives that coast: the motor has no torque, and friction shows in units of an inertia that is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.errors import InputError
from fricmodels.once import once
from fricmodels.recording import Recording

_PIECES = 256
"""In which the slope of a run's velocity is taken, at the most."""
_SAMPLES = 4
"""In a piece, at the least."""
_SLOWS = 0.95
"""RMS speed over the second half of a run, of that over its first half, up to which it coasts."""
PER_INERTIA = "a drive that coasts tells friction per inertia only"


def coasting(recording: Recording, inertia: float | None) -> Recording:
    r"""Return the recording with a torque to tell errors by, where the motor has none; else as it is.

    Without a motor torque the balance is :math:`J\dot\omega = -\tau_F - \tau_L`: friction is known per inertia, so that
    this has to be given, and errors are told in percent of the RMS of :math:`J\dot\omega`. Its slope is that from one
    piece of a run to the next, of 256 or less. Of runs that coast beside others which are driven errors are told in
    percent of the RMS motor torque of all.

    Args:
        recording: as read, or what is usable of it.
        inertia: J [kg m²] or M [kg], or ``None`` if it is to be estimated.

    Raises:
        InputError: where the torque is zero throughout, and the inertia is not known or the drive does not slow down.
    """
    if recording.reference_torque:
        return recording
    if recording.torque.any():
        beside = None if len(recording.run_numbers) == 1 else _beside_driven_runs(recording)
        return recording if beside is None else beside
    source, way_out = recording.provenance.get("source", recording.name), "map the column that drives the motion"
    if inertia is None:
        raise InputError(f"{source}: the torque is zero throughout; {way_out}, or give --inertia: {PER_INERTIA}")
    means = [_means(run) for run in recording.runs()]
    if not _slows(means):
        raise InputError(f"{source}: the torque is zero throughout, yet the drive does not slow down; {way_out}")
    slopes = [np.diff(velocity) / np.diff(time) for time, velocity in means]
    return replace(recording, reference_torque=inertia * rms(np.concatenate(slopes)))


def coasts(recording: Recording) -> bool:
    """Whether the motor has no torque throughout, and the drive slows down in every run."""
    return not recording.torque.any() and _slows([_means(run) for run in recording.runs()])


def _slows(means: Sequence[tuple[Array, Array]]) -> bool:
    halves = (np.array_split(velocity, 2) for _, velocity in means)
    return all(rms(later) <= _SLOWS * rms(before) for before, later in halves)


@once
def _beside_driven_runs(recording: Recording) -> Recording | None:
    """Return it with the RMS torque of all runs, if one of them coasts."""
    driven = np.unique(recording.run[recording.torque != 0.0])
    if len(driven) == len(recording.run_numbers):
        return None
    return replace(recording, reference_torque=recording.rms_torque)


def _means(run: Recording) -> tuple[Array, Array]:
    """Return mean time and mean velocity in the pieces of a run."""
    time, velocity = run.time, run.channels.get("velocity")
    if velocity is None:
        velocity = np.gradient(run["position"], time) if len(run) > 1 else np.zeros(len(run))
    pieces = np.array_split(np.arange(len(run)), max(2, min(_PIECES, len(run) // _SAMPLES)))
    mean_time, mean_velocity = (np.array([np.mean(values[piece]) for piece in pieces]) for values in (time, velocity))
    return mean_time, mean_velocity
