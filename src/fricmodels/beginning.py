"""The states with which a run began, where its motion does not tell them: found from its torque."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.kernels import ArrayFunction
from fricmodels.model import Model
from fricmodels.term import Term


@dataclass(frozen=True)
class Balance:
    """What the torque of a term is seen in: the equation of motion of a drive without it.

    Attributes:
        needed: driving torque, less what no unknown factor multiplies [N m or N], shape (N,).
        columns: what may make it beside the term, each times an unknown factor, shape (k, N).
        moving: samples at which the torque is a function of the motion, shape (N,).
    """

    needed: Array
    columns: Array
    moving: Mask


class Beginning:
    r"""The first states of a run, found from the torque.

    The states z of a term whose rates are linear in them are what the motion makes from a known beginning, and what an
    unknown one leaves to ring down: :math:`z = z_f + R(t)\,\Delta z`. With a torque :math:`A\,(t_0 + g'z)` of amplitude
    A,

    .. math:: \tau = \theta'x + A\,(t_0 + g'z_f) + \sum_i A\,\Delta z_i\; g'R_i

    is linear in θ, A and :math:`A\Delta z`, which are found by least squares over the samples of the run. What would
    make more torque than the states do by the motion anywhere in the run is no beginning, but something else that
    happened there: it is made as small as that, unless the states have limits of their own.

    Args:
        balance: what the torque is seen in.
        part: the samples of the run.

    Source: Elementary; initial conditions are fitted so wherever output errors are, as in L. Ljung, System
    Identification (1999), §7.4.
    """

    def __init__(self, balance: Balance, part: slice) -> None:
        self._moving = balance.moving[part]
        beside = np.where(self._moving, np.vstack([balance.columns, balance.needed])[:, part], 0.0)
        self._beside, self._gram = beside, beside @ beside.T
        self._count = int(np.count_nonzero(self._moving))

    def __call__(self, without: Array, forced: Array, left: Array, *, limited: bool = False) -> Array:
        """Return by how much the first states differ from those that the forced ones began from, shape (q,).

        Args:
            without: the term's torque per unit of its amplitude without its states, shape (n,).
            forced: what its states add to that from the known beginning, shape (n,).
            left: what a unit more of each first state adds, as long as it lasts, shape (q, m).
            limited: whether limits of the states bound what is found.
        """
        nothing, known, there = np.zeros(len(left)), len(self._beside) - 1, left.shape[1]
        whole = np.where(self._moving, without + forced, 0.0)
        beginning = np.where(self._moving[:there], left, 0.0)
        beside, lasting = self._beside @ whole, self._beside[:, :there] @ beginning.T
        gram = np.empty((known + 1 + len(left),) * 2)
        gram[:known, :known] = self._gram[:known, :known]
        gram[known, :known] = gram[:known, known] = beside[:known]
        gram[known, known] = whole @ whole
        gram[:known, known + 1 :], gram[known + 1 :, :known] = lasting[:known], lasting[:known].T
        gram[known + 1 :, known] = gram[known, known + 1 :] = beginning @ whole[:there]
        gram[known + 1 :, known + 1 :] = beginning @ beginning.T
        size = np.sqrt(np.diag(gram))
        if self._count <= len(gram) or not size[known] > 0.0:
            return nothing
        size = np.where(size > 0.0, size, 1.0)
        right = np.concatenate([self._gram[:known, known], [beside[known]], lasting[known]]) / size
        found = np.linalg.lstsq(gram / np.outer(size, size), right, rcond=1e-12)[0] / size
        if not found[known] > 0.0:
            return nothing
        first = np.asarray(found[known + 1 :] / found[known])
        largest, most = float(np.max(np.abs(first @ left))), float(np.max(np.abs(forced)))
        return first if limited or largest <= most else first * (most / largest)


class UnitTorque:
    """The torque of a term per unit of its one linear parameter, as far as its states go: :math:`t_0 + g'z`.

    Args:
        term: with one linear parameter, and a torque that is linear in its states.
        given: value or array of shape (N,) of each signal that it needs.
        width: width of rest.
    """

    def __init__(self, term: Term, given: Mapping[str, Array], width: float) -> None:
        self._function, needs = _unit_torque(term)
        self._given, self._width = [given[name] for name in needs], width

    def __call__(self, values: Array, part: slice) -> tuple[Array, Array]:
        """Return t_0, shape (n,), and g, shape (q, n) or (q, 1), over the samples of a run.

        Args:
            values: the term's parameters, in order.
            part: the samples.
        """
        (rows,) = self._function(*(given[part] for given in self._given), *values, self._width)
        return rows[0], rows[1:]


def unknown_beginnings(model: Model) -> Iterator[tuple[Term, slice, slice]]:
    """Yield the terms of which the first states are unknown, with the places of their parameters and states."""
    parameter = state = 0
    for term in model.terms:
        ends = parameter + len(term.parameters), state + len(term.states)
        if term.beginning_unknown:
            yield term, slice(parameter, ends[0]), slice(state, ends[1])
        parameter, state = ends


@lru_cache(maxsize=64)
def _unit_torque(term: Term) -> tuple[ArrayFunction, tuple[str, ...]]:
    """Return t_0 and g by signals, parameters and width, and the names of the signals."""
    import casadi

    model = Model.only(term)  # type: ignore[arg-type]
    e = model.expression()
    needs = tuple(name for name in model.signals if name in model.needs)
    (linear,) = (i for i, is_linear in enumerate(model.linear) if is_linear)
    torque = casadi.substitute(e.torque, e.parameters[linear], 1.0)
    rows = casadi.vertcat(casadi.substitute(torque, e.states, 0), casadi.jacobian(torque, e.states).T)
    given: list[Any] = [*(e.signals[name] for name in needs), e.parameters, e.width]
    return ArrayFunction(casadi.Function("unit_torque", given, [casadi.densify(rows)])), needs
