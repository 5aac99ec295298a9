"""A friction model split for variable projection: columns of linear parameters, and what depends on the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import rest_width
from fricmodels.kernels import ArrayFunction
from fricmodels.model import Model
from fricmodels.recording import Recording

Array = NDArray[np.float64]
Memory: TypeAlias = Callable[[Array], Sequence[Array]]


@dataclass(frozen=True)
class Separable:
    r"""The friction torque as :math:`\tau_F = \sum_k A_k(\alpha)\,\theta_k + b(\alpha)`.

    Rows that do not depend on :math:`\alpha` are *fixed* and evaluated once; the others are *moving* and come with
    their derivatives by :math:`\alpha`, as far as these are not zero everywhere.

    Attributes:
        model: the friction model.
        linear, nonlinear: indices of the parameters :math:`\theta` and :math:`\alpha` among the model's.
        fixed: rows evaluated once, by index into :math:`(A, b)`; b has the index ``len(linear)``.
        moving: rows evaluated for every :math:`\alpha`.
        slopes: pairs (row, index into α) of the derivatives that are not zero everywhere.
    """

    model: Model
    linear: tuple[int, ...]
    nonlinear: tuple[int, ...]
    fixed: tuple[int, ...]
    moving: tuple[int, ...]
    slopes: tuple[tuple[int, int], ...]
    _fixed: ArrayFunction
    _values: ArrayFunction
    _moving: ArrayFunction

    def fixed_rows(self, recording: Recording) -> Array:
        """Return the fixed rows at every sample, shape (len(fixed), N)."""
        none = [0.0] * len(self.model.states)
        return self._evaluate(self._fixed, len(self.fixed), recording, (), none)

    def moving_rows(self, recording: Recording, alpha: Array, memory: Memory, *, slopes: bool = True) -> Array:
        """Return the moving rows, then the slopes if wanted, at every sample, shape (rows, N).

        Args:
            recording: gives the signals.
            alpha: the nonlinear parameters.
            memory: all parameters → internal states at every sample. The slopes of a model with internal states are
                by differences, because the states change with the parameters too.
        """
        if not self.model.states:
            function, rows = (self._moving, len(self.slopes)) if slopes else (self._values, 0)
            return self._evaluate(function, len(self.moving) + rows, recording, tuple(alpha), ())
        here = self._remembered(recording, alpha, memory)
        if not slopes:
            return here
        differences = []
        for j in range(len(alpha)):
            moved = alpha.copy()
            moved[j] += 1e-4 * (abs(alpha[j]) or 1.0)
            differences.append((self._remembered(recording, moved, memory) - here) / (moved[j] - alpha[j]))
        return np.concatenate([here, *([differences[j][self.moving.index(row)]] for row, j in self.slopes)])

    def _remembered(self, recording: Recording, alpha: Array, memory: Memory) -> Array:
        parameters = np.zeros(len(self.model.parameters))
        parameters[list(self.nonlinear)] = alpha
        return self._evaluate(self._moving, len(self.moving), recording, tuple(alpha), memory(parameters))

    def _evaluate(
        self, function: ArrayFunction, rows: int, recording: Recording, alpha: tuple[float, ...], states: Sequence[Any]
    ) -> Array:
        signals: list[Any] = [
            recording.signal(name) if name in self.model.needs else 0.0 for name in self.model.signals
        ]
        (values,) = function(*signals, *alpha, *states, rest_width(recording))
        return np.broadcast_to(values, (rows, len(recording)))


@lru_cache(maxsize=128)
def separable(model: Model) -> Separable:
    """Split a model; built once per model."""
    import casadi

    e = model.expression()
    linear = tuple(i for i, is_linear in enumerate(model.linear) if is_linear)
    nonlinear = tuple(i for i, is_linear in enumerate(model.linear) if not is_linear)
    theta = e.parameters[list(linear)] if linear else casadi.SX(0, 1)
    alpha = e.parameters[list(nonlinear)] if nonlinear else casadi.SX(0, 1)
    zero = casadi.SX.zeros(len(linear), 1)
    design = casadi.substitute(casadi.jacobian(e.torque, theta).T, theta, zero)
    rows = casadi.vertcat(design, casadi.substitute(e.torque, theta, zero))
    derivative = casadi.jacobian(rows, alpha)
    present = set(rows.sparsity().row())
    if model.states:
        slopes = tuple((row, j) for row in sorted(present) for j in range(len(nonlinear)))
        moving = tuple(sorted(present))
        chosen = casadi.vertcat(*(rows[i] for i in moving))
    else:
        slopes = tuple(sorted(zip(*derivative.sparsity().get_triplet(), strict=True)))
        moving = tuple(sorted({row for row, _ in slopes}))
        chosen = casadi.vertcat(*(rows[i] for i in moving), *(derivative[i, j] for i, j in slopes))
    fixed = tuple(i for i in range(rows.numel()) if i in present and i not in moving)
    signals = list(e.signals.values())
    return Separable(
        model,
        linear,
        nonlinear,
        fixed,
        moving,
        slopes,
        ArrayFunction(
            casadi.Function("fixed", [*signals, e.states, e.width], [casadi.vertcat(*(rows[i] for i in fixed))])
        ),
        ArrayFunction(
            casadi.Function(
                "values", [*signals, alpha, e.states, e.width], [casadi.vertcat(*(rows[i] for i in moving))]
            )
        ),
        ArrayFunction(casadi.Function("moving", [*signals, alpha, e.states, e.width], [chosen])),
    )
