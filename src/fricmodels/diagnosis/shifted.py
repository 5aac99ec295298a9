r"""A regression in which torque and motion may be shifted against each other by part of a sample.

Neither the instant at which a sample was taken nor how long a torque was held is known better than to about a sample,
so that the rows have one free direction more, :math:`\gamma \int \varphi\,d\tau_m` with :math:`|\gamma| \le h`. It is
bounded for each set of columns anew: what the shift would be without an effect says nothing about what it is with it.
A larger shift than a sample is an effect of its own, `sensor-delay`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.evidence import Evidence, Regression

Array = NDArray[np.float64]


class ShiftedRegression(Regression):
    """The base model's regression with a bounded shift in time.

    Args:
        base: base directions, shape (k, M).
        target: shape (M,).
        independent: about how many of the M rows are independent.
        direction: what a shift by a second adds, shape (M,).
        most: largest shift [s].
    """

    def __init__(self, base: Array, target: Array, independent: float, direction: Array, most: float) -> None:
        self._apart = Regression(base, target, independent)
        self._given = (base, target, independent)
        self._direction, self._most = direction, most
        self._own = self._apart.free(direction[None])[0]
        self._cases: dict[int, Regression] = {}
        self._case = self._case_of(self._shift(np.zeros((0, len(target))), np.zeros(0)))
        chosen = self._regression(self._case)
        super().__init__(chosen.base, chosen.target, independent)

    @property
    def unshifted(self) -> Regression:
        """The regression without a shift."""
        return self._apart

    def explained(self, columns: Array, lower: Array, upper: Array) -> tuple[float, Array]:
        """Return by how much columns lower the sum of squares, and the coefficients, as far as these may go."""
        case, told = self._case, self._tells(columns)
        if told:
            gained, theta = self._regression(0).explained(columns, lower, upper)
            case = self._case_of(self._shift(columns, theta))
        if case or not told:
            gained, theta = self._regression(case).explained(columns, lower, upper)
        before, after = (float(r @ r) for r in (self.residual, self._regression(case).residual))
        return gained + before - after, theta

    def test(self, columns: Array, against: Regression | None = None) -> Evidence:
        """Test whether columns, all of them visible, belong to the model."""
        case = self._case
        if self._tells(columns):
            unlimited = np.full(len(columns), np.inf)
            _, theta = self._regression(0).explained(columns, -unlimited, unlimited)
            case = self._case_of(self._shift(columns, theta))
        return self._regression(case).test(columns, against or self)

    def _tells(self, columns: Array) -> bool:
        """Whether columns can be told from a free shift as well as from the base model."""
        if self._case == 0:
            return True
        return bool(np.all(self._regression(0).visible(columns)[self.visible(columns)]))

    def _shift(self, columns: Array, theta: Array) -> float:
        size = float(self._own @ self._own)
        return float(self._own @ (self._apart.residual - theta @ columns)) / size if size > 0 else 0.0

    def _case_of(self, shift: float) -> int:
        return 0 if abs(shift) <= self._most else int(np.sign(shift))

    def _regression(self, case: int) -> Regression:
        """Return the regression with the shift free (0), or held at its bound (±1)."""
        if case not in self._cases:
            base, target, independent = self._given
            if case == 0:
                base = np.vstack([base, self._direction[None]])
            self._cases[case] = Regression(base, target - case * self._most * self._direction, independent)
        return self._cases[case]
