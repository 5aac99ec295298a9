"""How well a delay between torque and motion is known: no better than the instants of the samples."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from fricmodels.arrays import Array
from fricmodels.weakform.problem import WeakFormProblem

TRUE_TO = 0.05
"""Samples: how true instants are where none of them is known to be shifted. By another twentieth the inertia torque,
ten times the viscous one, would change K_v by a tenth."""


def variance_of_instants(problem: WeakFormProblem, held: Collection[str]) -> Array:
    """Return the variance [s²] that instants of samples add to each delay of a model, and 0 to all else, shape (n,).

    Rows may tell a delay to a thousandth of a sample. That is the sum of the delay and of how the samples stand in
    time: when in its interval each was taken, how the torque ran between two of them, what a filter of the velocity
    did.
    """
    free = [p.declared.delay and p.key not in held for p in problem.drive.parameters]
    return np.where(free, (TRUE_TO * problem.recording.interval) ** 2, 0.0)
