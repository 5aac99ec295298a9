"""Runs of which a model does not know the offset, scored as a user would use them: with a zero taken from the run."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.drive import Drive
from fricmodels.recording import RUN, Recording
from fricmodels.score.torque import torque_error


def zeroed(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Recording:
    r"""Return a recording with the offset taken off the torque of every run that the model was not fitted to.

    A model with an offset for each run (:attr:`fricmodels.term.Effect.fitted_runs`) says nothing of another run's,
    which has to be measured there. Each half of such a run is given the offset that the other half shows, the mean of
    its torque error, so that no sample takes part in its own score (two-fold cross-validation). A model without such
    offsets is scored as it is.

    Args:
        drive: the model.
        values: parameters by key.
        prepared: what the model was not fitted to, with velocity and acceleration.
    """
    return _less(drive, values, prepared, _of_the_other_half)


def unknown_runs(drive: Drive, recording: Recording) -> Index:
    """Return the numbers of the runs whose offset a model does not know; none where it has no offsets of runs."""
    fitted = [effect.fitted_runs for effect in drive.model.effects if effect.fitted_runs is not None]
    if not fitted:
        return np.array([], dtype=np.int64)
    run = np.unique(recording.signal(RUN)).astype(np.int64)
    return np.setdiff1d(run, list(frozenset.intersection(*fitted)))


def levelled(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Recording:
    """Return a recording with the mean torque error of every run that a model was not fitted to taken off its torque.

    What is then looked for in what a model leaves meets no offset, and no step in the middle of a run as after
    :func:`zeroed`, which scores.

    Args:
        drive: the model.
        values: parameters by key.
        prepared: with velocity and acceleration.
    """
    return _less(drive, values, prepared, _of_all)


def _less(
    drive: Drive, values: Mapping[str, float], prepared: Recording, offset: Callable[[Array], Array]
) -> Recording:
    """Return a recording less the offset that the torque error of each run unknown to a model shows, shape (n,)."""
    unknown = unknown_runs(drive, prepared)
    if not len(unknown):
        return prepared
    error, run = torque_error(drive, values, prepared), prepared.signal(RUN)
    torque = prepared.torque.copy()
    for number in unknown:
        torque[run == number] -= offset(error[run == number])
    return prepared.with_channels(derived="torque" in prepared.derived, torque=torque)


def _of_all(error: Array) -> Array:
    return np.full(len(error), np.mean(error))


def _of_the_other_half(error: Array) -> Array:
    first, second = np.array_split(error, 2)
    pairs = ((first, second), (second, first))
    return np.concatenate([np.full(len(half), np.mean(other) if len(other) else 0.0) for half, other in pairs])
