"""The tracking error that a fit leaves when its model compensates friction, as a figure of a leaderboard."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.rig.rig import Rig
from fricmodels.tracking.experiment import Experiment
from fricmodels.tracking.settings import Settings

MOTIONS = 2
"""Motions of each drive, the same for all models."""


def tracking_errors(rig: Rig, drive: Drive, values: Mapping[str, float], width: float) -> dict[str, float]:
    """Return the RMS tracking error of a controlled drive whose friction a model compensates.

    The controller, the motions and their number are the same for every model; see :class:`Experiment`.

    Args:
        rig: the drive. drive: the model that was fitted. values: its parameters by key. width: its width of rest.

    Returns:
        ``tracking_error`` [rad or m], ``tracking_error_percent`` of that without compensation, and
        ``tracking_limit_cycle``, 1 where the drive swings on at rest. What runs away is infinite.

    Raises:
        InputError: for a drive that cannot be controlled, or a model that needs what a controller does not have.
    """
    experiments, without = _experiments(rig)
    runs = [one.run(one.compensator(drive, values, width)).figures for one in experiments]
    error = _rms(np.array([run.rms_error for run in runs]))
    return {
        "tracking_error": error,
        "tracking_error_percent": 100 * error / without,
        "tracking_limit_cycle": float(any(run.limit_cycle for run in runs)),
    }


@lru_cache(maxsize=8)
def _experiments(rig: Rig) -> tuple[tuple[Experiment, ...], float]:
    experiments = tuple(Experiment(rig, Settings(seed=seed)) for seed in range(MOTIONS))
    return experiments, _rms(np.array([one.run(None).figures.rms_error for one in experiments]))


def _rms(errors: Array) -> float:
    value = float(np.sqrt(np.mean(np.square(errors))))
    return value if math.isfinite(value) else math.inf
