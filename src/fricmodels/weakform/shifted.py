r"""A regression in which torque and motion may be shifted against each other by part of a sample.

Whether a torque was held for a sample, which shifts it by half of one, is often not known, nor at which instant of its
interval a sample was taken. So the rows have one free direction more, :math:`\gamma \int \varphi\,d\tau_m`, with
:math:`|\gamma| \le 0.6\,h`. It is bounded for each set of columns anew: what the shift would be without an effect says
nothing about what it is with it. A larger shift is an effect of its own, whose parameter is a delay.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.term import Effect
from fricmodels.weakform.directions import base_directions
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import SAME, Evidence, ProjectedGram, Regression, unwarned
from fricmodels.weakform.row_noise import noise_in_columns
from fricmodels.weakform.staircase import scatter_of_torque

FREE_SHIFT = 0.6
"""Samples by which torque and motion may be shifted: half a sample for a torque that was held, and a tenth more for
stamps that are not exact."""


class ShiftedRegression(Regression):
    """The base model's regression with a bounded shift in time.

    Args:
        unshifted: the regression without a shift.
        direction: what a shift by a second adds, shape (M,).
        most: largest shift [s].
    """

    def __init__(self, unshifted: Regression, direction: Array, most: float) -> None:
        self._unshifted, self._direction, self._most = unshifted, direction, most
        own = self._unshifted.project_out(direction[None])[0]
        size = float(own @ own)
        self._residual_and_own = np.column_stack([self._unshifted.residual, own])
        self._per_size = 1 / size if size > SAME**2 * float(direction @ direction) else 0.0
        self._shift = self._per_size * float(own @ self._unshifted.residual)
        self._cases: dict[int, Regression] = {}
        self._case = self._case_of(self._shift)
        chosen = self._regression(self._case)
        self.base, self.target, self.terms, self.terms_once = (
            chosen.base,
            chosen.target,
            chosen.terms,
            chosen.terms_once,
        )
        self._basis, self._edges = chosen._basis, chosen._edges
        self.residual, self.loss = chosen.residual, chosen.loss

    @property
    def unshifted(self) -> Regression:
        """The regression without a shift."""
        return self._unshifted

    def explained(self, columns: Array, lower: Array, upper: Array) -> tuple[float, Array]:
        """Return by how much columns lower the sum of squares, and the coefficients, as far as these may go."""
        case, gained, theta = self._best(columns, lower, upper)
        if case != self._case:
            before, after = (float(r @ r) for r in (self.residual, self._regression(case).residual))
            gained += before - after
        return gained, theta

    def test(self, columns: Array, against: Regression | None = None) -> Evidence:
        """Test whether columns, all of them visible, belong to the model."""
        unlimited = np.full(len(columns), np.inf)
        case, _, _ = self._best(columns, -unlimited, unlimited)
        return self._regression(case).test(columns, against or self)

    @unwarned
    def _best(self, columns: Array, lower: Array, upper: Array) -> tuple[int, float, Array]:
        """Return the case, the explained sum of squares, and the coefficients.

        The shift is free where it stays within its bounds, and where the columns can be told from it as well as from
        the base model.
        """
        held = self._unshifted.projected_gram(columns)
        right, own = (columns @ self._residual_and_own).T
        free = ProjectedGram(held.gram - self._per_size * own[:, None] * own, held.power)
        case = self._case
        if case == 0 or set(held.kept) <= set(free.kept):
            gained, theta = free.explained(right - self._shift * own, lower, upper)
            used = theta != 0
            case = self._case_of(self._shift - self._per_size * float(theta[used] @ own[used]))
            if case == 0:
                return case, gained, theta
        return case, *held.explained(right - case * self._most * own, lower, upper)

    def _case_of(self, shift: float) -> int:
        return 0 if abs(shift) <= self._most else int(np.sign(shift))

    def _regression(self, case: int) -> Regression:
        """Return the regression with the shift free (0), or held at its bound (±1)."""
        if case not in self._cases:
            own = self._unshifted
            self._cases[case] = own.less(case * self._most * self._direction) if case else own.beside(self._direction)
        return self._cases[case]


def regression_of(
    problem: WeakFormProblem, parameters: Mapping[str, float], also: Array | None = None, added: Effect | None = None
) -> Regression:
    """Return the base model's regression, with two freedoms of how recordings are made that are no effects.

    The instant of every reversal may be off by part of a sample, and torque and motion may be shifted against each
    other by up to ``FREE_SHIFT`` (a held torque by half a sample). A larger shift is held there; what is left over is
    then for an effect to explain whose parameter is a delay. Beside such an effect there is no second shift.

    Args:
        problem: drive and recording.
        parameters: the model's estimated parameters.
        also: columns that are taken to be in the model already, shape (k, rows).
        added: the effect that the last of these columns belong to.
    """
    base = base_directions(problem, parameters)
    if also is not None:
        base = np.vstack([base, also])
    delayed = problem.drive.model.delay is not None or (added is not None and any(p.delay for p in added.parameters))
    base = np.vstack([base, problem.sign_change[None]])
    rounding = scatter_of_torque(problem)
    unshifted = Regression(base, problem.target, problem.independent, problem.repeats, rounding)
    if delayed:
        return unshifted
    return ShiftedRegression(unshifted, problem.torque_rate, FREE_SHIFT * problem.recording.interval)


def noise_within(problem: WeakFormProblem, regression: Regression, columns: Array, perturbed: Array) -> Array:
    """Return what noise makes of columns freed of the base directions, shape (k, rows).

    Args:
        problem: the rows.
        regression: gives the base directions.
        columns, perturbed: of the problem and of its ``perturbed``, shape (k, rows).
    """
    momentum = problem.momentum if problem.drive.inertia is None else None
    return noise_in_columns(regression, columns, perturbed - columns, momentum, problem.noise_of_momentum)
