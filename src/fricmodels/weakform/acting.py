"""The torque in whose share a diagnosis tells everything."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.arrays import Array

if TYPE_CHECKING:
    from fricmodels.weakform.problem import WeakFormProblem


def acting(problem: WeakFormProblem) -> Array:
    r"""Return what acts on the drive in each row: :math:`\int\varphi (\tau_m - \tau_L)\,dt`, shape (rows,).

    Of a drive that coasts, on which no torque acts, it is that of its inertia, :math:`-J\int\varphi\,d\omega`.
    """
    return problem.driving if problem.driving.any() else problem.target
