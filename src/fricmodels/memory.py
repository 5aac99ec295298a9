"""The internal states of terms with memory, integrated along a measured motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmodels.kernels import Scan
from fricmodels.model import Model
from fricmodels.term import SIGNALS

_GAMMA = 1 - 1 / math.sqrt(2)


def trace(
    model: Model,
    signals: Mapping[str, ArrayLike],
    time: NDArray[np.float64],
    run: NDArray[np.int64],
    parameters: ArrayLike,
    width: float,
) -> tuple[NDArray[np.float64], ...]:
    r"""Return each internal state of a model at every sample, one array of shape (N,) for each.

    Every run starts from the declared initial states. With rates f, their derivative F by the states and the step h,
    a step is the second-order Rosenbrock formula

    .. math::
        (I - \gamma h F) k_1 &= f(z_n, t_n) + \gamma\,[f(z_n, t_{n+1}) - f(z_n, t_n)] \\
        (I - \gamma h F) k_2 &= f(z_n + h k_1, t_{n+1}) - 2 k_1 - \gamma\,[f(z_n, t_{n+1}) - f(z_n, t_n)] \\
        z_{n+1} &= z_n + \tfrac h2 (3 k_1 + k_2), \qquad \gamma = 1 - 1/\sqrt2

    which is L-stable: a contact that bends within less than a sample settles at once instead of ringing. States that a
    term advances itself (:meth:`fricmodels.term.Term.advance`) follow its formula.

    Args:
        model: the model with memory.
        signals: value or array of shape (N,) of each signal that the model needs.
        time: sample times [s]; run: run number of each sample.
        parameters: all of the model's parameters, in order.
        width: width of rest.

    Source: J. G. Verwer et al., "A second-order Rosenbrock method", SIAM J. Sci. Comput. 20 (1999).
    """
    scan = _scan(model)
    first = [state.initial for state in model.states]
    columns = np.empty((len(time), len(model.needs)))
    for i, name in enumerate(_in_order(model)):
        columns[:, i] = signals[name]
    steps = np.diff(time)
    broken = np.flatnonzero(np.diff(run)) + 1
    states = np.empty((len(time), len(first)))
    for begin, end in zip([0, *broken], [*broken, len(time)], strict=True):
        rows = np.column_stack([steps[begin : end - 1], columns[begin : end - 1], columns[begin + 1 : end]])
        _, outputs, _ = scan(first, rows, [*np.asarray(parameters, dtype=float), width])
        states[begin] = first
        states[begin + 1 : end] = outputs
    return tuple(states.T)


def _in_order(model: Model) -> list[str]:
    return [name for name in SIGNALS if name in model.needs]


@lru_cache(maxsize=64)
def _scan(model: Model) -> Scan:
    import casadi

    e = model.expression()
    needed = _in_order(model)
    signals = casadi.vertcat(*(e.signals[name] for name in needed))
    begin, end = (casadi.SX.sym(name, signals.numel()) for name in ("begin", "end"))
    h = casadi.SX.sym("h")

    def at(expression: Any, states: Any, ends: Any) -> Any:
        return casadi.substitute(expression, casadi.vertcat(e.states, signals), casadi.vertcat(states, ends))

    following = casadi.SX(e.states)
    integrated = [i for i in range(e.states.numel()) if i not in e.advanced]
    if integrated:
        states, rates = e.states[integrated], e.rates[integrated]
        before, after = at(rates, e.states, begin), at(rates, e.states, end)
        slope = casadi.jacobian(rates, states)
        mean_slope = (at(slope, e.states, begin) + at(slope, e.states, end)) / 2
        matrix = casadi.SX.eye(len(integrated)) - _GAMMA * h * mean_slope
        change = _GAMMA * (after - before)
        k1 = casadi.solve(matrix, before + change)
        moved = casadi.SX(e.states)
        moved[integrated] = states + h * k1
        k2 = casadi.solve(matrix, at(rates, moved, end) - 2 * k1 - change)
        following[integrated] = states + h / 2 * (3 * k1 + k2)
    given = casadi.vertcat(signals, *(e.later[name] for name in needed), e.step)
    for i, expression in e.advanced.items():
        following[i] = casadi.substitute(expression, given, casadi.vertcat(begin, end, h))
    constants = casadi.vertcat(e.parameters, e.width)
    step = casadi.Function(
        "memory", [e.states, casadi.vertcat(h, begin, end), constants], [following, following], {"cse": True}
    )
    return Scan(step)
