"""A friction model split for variable projection: columns of linear parameters, and what depends on the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, TypeAlias

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import rest_width
from fricmodels.expressions import constant_slopes
from fricmodels.kernels import ArrayFunction
from fricmodels.model import Model
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.weakform.alike import alike

Memory: TypeAlias = Callable[[Model, Array], Sequence[Array]]
"""A model of one term and its parameters → internal states at every sample."""


@dataclass(frozen=True)
class SeparableTerm:
    """One term of a model, split; the attributes are as of :class:`Separable`, rows and α counted as there.

    Attributes:
        model: the term alone.
        own: indices of the term's nonlinear parameters among its own.
        nonlinear: indices into α of these.
        moving: rows evaluated for every α, by index as the fixed ones.

    Of moving rows, and of slopes, that are alike only one is evaluated; see :mod:`.alike`.
    """

    model: Model
    own: tuple[int, ...]
    nonlinear: tuple[int, ...]
    fixed: tuple[int, ...]
    moving: tuple[int, ...]
    slopes: tuple[tuple[int, int], ...]
    _alike: tuple[tuple[int, float], ...]
    """Each moving row, then each slope: which distinct one it is, and its sign."""
    _distinct: int
    """How many of the moving rows are distinct."""
    fixed_derivatives: Array
    """Constant derivatives of each fixed row by acceleration and motor torque; 0 where it is none, shape (2, rows)."""
    _derivatives: Array
    """The same of each distinct moving row, then of each distinct slope."""
    _fixed: ArrayFunction
    _moving: ArrayFunction
    """Distinct moving rows, then distinct slopes."""

    def fixed_rows(self, recording: Recording) -> Array:
        """Return the fixed rows at every sample, shape (len(fixed), N)."""
        return self._evaluate(self._fixed, recording, (), [0.0] * len(self.model.states))

    def moving_rows(self, recording: Recording, alpha: Array, memory: Memory, *, slopes: bool = True) -> Array:
        """Return the moving rows, then the slopes if wanted, at every sample, shape (rows, N).

        Args:
            recording: gives the signals.
            alpha: the term's nonlinear parameters.
            memory: gives the internal states. The slopes of a term with internal states are by differences, because the
                states change with the parameters too.
            slopes: whether they are wanted.
        """
        return self.completed(self.distinct_rows(recording, alpha, memory, slopes=slopes), slopes=slopes)

    def completed(self, distinct: Array, *, slopes: bool) -> Array:
        """Return all moving rows, then the slopes if wanted, by the distinct ones: at samples, or their integrals.

        Args:
            distinct: see :meth:`distinct_rows`.
            slopes: whether slopes are wanted.
        """
        chosen = self._alike if slopes else self._alike[: len(self.moving)]
        if all(sign == 1.0 and place == i for i, (place, sign) in enumerate(chosen)):
            return distinct
        found = np.empty((len(chosen), distinct.shape[1]))
        for row, (place, sign) in zip(found, chosen, strict=True):
            np.multiply(distinct[place], sign, out=row)
        return found

    def distinct_rows(self, recording: Recording, alpha: Array, memory: Memory, *, slopes: bool) -> Array:
        """Return one of all moving rows that are alike, then of all slopes; see :meth:`moving_rows`."""
        if not self.model.states:
            return self._evaluate(self._moving, recording, tuple(alpha), (), None if slopes else self._distinct)
        here = self._remembered(recording, alpha, memory)
        if not slopes:
            return here
        found = [here]
        for j in range(len(alpha)):
            moved = alpha.copy()
            moved[j] += 1e-4 * (abs(alpha[j]) or 1.0)
            found.append((self._remembered(recording, moved, memory) - here) / (moved[j] - alpha[j]))
        return np.concatenate(found)

    def distinct_derivatives(self, count: int) -> Array:
        """Return :attr:`fixed_derivatives` of each of :meth:`distinct_rows`, shape (2, count)."""
        found = np.zeros((2, count))
        known = self._derivatives[:, :count]
        found[:, : known.shape[1]] = known
        return found

    def _remembered(self, recording: Recording, alpha: Array, memory: Memory) -> Array:
        parameters = np.zeros(len(self.model.parameters))
        parameters[list(self.own)] = alpha
        return self._evaluate(self._moving, recording, tuple(alpha), memory(self.model, parameters))

    def _evaluate(
        self,
        function: ArrayFunction,
        recording: Recording,
        alpha: tuple[float, ...],
        states: Sequence[Any],
        first: int | None = None,
    ) -> Array:
        known, key = _known(recording), function
        if key not in known:
            signals: list[Any] = [
                recording.signal(name) if name in self.model.needs else 0.0 for name in self.model.signals
            ]
            later = [None] * (len(alpha) + len(states))
            known[key] = function.given(*signals, *later, rest_width(recording))
        (values,) = known[key](*alpha, *states, first=first)
        return values if values.shape[1] == len(recording) else np.broadcast_to(values, (len(values), len(recording)))


@once
def _known(_: Recording) -> dict[ArrayFunction, Callable[..., list[Array]]]:
    """Functions of nonlinear parameters and internal states alone, at the samples of a recording."""
    return {}


@dataclass(frozen=True)
class Separable:
    r"""The friction torque as :math:`\tau_F = \sum_k A_k(\alpha)\,\theta_k + b(\alpha)`.

    Rows that do not depend on :math:`\alpha` are *fixed* and evaluated once; the others are *moving* and come with
    their derivatives by :math:`\alpha`, as far as these are not zero everywhere. A model is the sum of its terms; each
    is split by itself, so that a row is evaluated again only where a parameter of its own term moved. Several terms
    may add to b.

    Attributes:
        terms: the law and the effects.
        linear, nonlinear: indices of the parameters :math:`\theta` and :math:`\alpha` among the model's.
        fixed: rows evaluated once, by index into :math:`(A, b)`; b has the index ``len(linear)``.
        slopes: pairs (row, index into α) of the derivatives that are not zero everywhere.
    """

    terms: tuple[SeparableTerm, ...]
    linear: tuple[int, ...]
    nonlinear: tuple[int, ...]
    fixed: tuple[int, ...]
    slopes: tuple[tuple[int, int], ...]

    def fixed_rows(self, recording: Recording) -> Array:
        """Return the fixed rows at every sample, shape (len(fixed), N)."""
        return np.concatenate([term.fixed_rows(recording) for term in self.terms])

    def moving_blocks(self, alpha: Array, rows: Callable[[SeparableTerm, tuple[float, ...]], Array]) -> list[Array]:
        """Return the moving rows of each of the terms that move, shape (rows, number of samples or of equations).

        Args:
            alpha: the nonlinear parameters.
            rows: gives those of a term by its own nonlinear parameters, followed by its slopes if these are wanted.
        """
        return [rows(term, tuple(alpha[list(term.nonlinear)].tolist())) for term in self.moving_terms]

    @cached_property
    def moving_terms(self) -> tuple[SeparableTerm, ...]:
        """The terms that have moving rows."""
        return tuple(term for term in self.terms if term.moving)


@lru_cache(maxsize=128)
def separable(model: Model) -> Separable:
    """Split a model; built once per model."""
    linear = tuple(i for i, is_linear in enumerate(model.linear) if is_linear)
    nonlinear = tuple(i for i, is_linear in enumerate(model.linear) if not is_linear)
    terms, first = [], 0
    for term in model.terms:
        flags = model.linear[first : first + len(term.parameters)]
        places = [i for i in range(first, first + len(flags)) if model.linear[i]]
        rows = [*(linear.index(i) for i in places), len(linear)]
        alphas = [nonlinear.index(i) for i in range(first, first + len(flags)) if not model.linear[i]]
        terms.append(_split(Model.only(term), flags, rows, alphas))
        first += len(flags)
    return Separable(
        tuple(terms),
        linear,
        nonlinear,
        tuple(row for term in terms for row in term.fixed),
        tuple(slope for term in terms for slope in term.slopes),
    )


def _split(model: Model, flags: Sequence[bool], rows: Sequence[int], alphas: Sequence[int]) -> SeparableTerm:
    """Split one term.

    Args:
        model: the term alone.
        flags: which of its parameters are linear.
        rows: row of each linear one in the whole model, then that of b.
        alphas: place of each nonlinear one in α.
    """
    import casadi

    e = model.expression()
    own = tuple(i for i, is_linear in enumerate(flags) if not is_linear)
    chosen = [i for i, is_linear in enumerate(flags) if is_linear]
    theta = e.parameters[chosen] if chosen else casadi.SX(0, 1)
    alpha = e.parameters[list(own)] if own else casadi.SX(0, 1)
    zero = casadi.SX.zeros(len(chosen), 1)
    design = casadi.substitute(casadi.jacobian(e.torque, theta).T, theta, zero)
    every = casadi.vertcat(design, casadi.substitute(e.torque, theta, zero))
    present = sorted(set(every.sparsity().row()))
    derivative = casadi.jacobian(every, alpha)
    moving = [row for row in present if casadi.depends_on(every[row], casadi.vertcat(alpha, e.states))]
    if model.states:  # one parameter after the other, all rows of each: so they are by differences
        slopes = [(row, j) for j in range(len(own)) for row in moving]
    else:
        slopes = sorted(zip(*derivative.sparsity().get_triplet(), strict=True))
    fixed = [row for row in present if row not in moving]
    inputs = [*e.signals.values(), alpha, e.states, e.width]

    def function(name: str, arguments: list[Any], outputs: list[Any]) -> ArrayFunction:
        return ArrayFunction(casadi.Function(name, arguments, [casadi.vertcat(*outputs)]))

    by = [e.signals["acceleration"], e.signals["motor_torque"]]
    values = [every[row] for row in moving]
    derivatives = [] if model.states else [derivative[i, j] for i, j in slopes]
    likeness = [(i, 1.0) for i in range(len(values) + len(slopes))]
    if not model.states:
        values, of_values = alike(values)
        derivatives, of_slopes = alike(derivatives)
        likeness = [*of_values, *((len(values) + place, sign) for place, sign in of_slopes)]
    return SeparableTerm(
        model,
        own,
        tuple(alphas),
        tuple(rows[row] for row in fixed),
        tuple(rows[row] for row in moving),
        tuple((rows[row], alphas[j]) for row, j in slopes),
        tuple(likeness),
        len(values),
        constant_slopes([every[row] for row in fixed], by),
        constant_slopes([*values, *derivatives], by),
        function("fixed", [*e.signals.values(), e.states, e.width], [every[row] for row in fixed]),
        function("moving", inputs, [*values, *derivatives]),
    )
