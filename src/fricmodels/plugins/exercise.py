"""Calls in a child process what a plugin defines, as every command does that may meet it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

STEP = "step"


def exercise(kind: str, cls: type[Any], doing: Callable[[str], None]) -> None:
    """Make a law or an effect and build its equations; what goes wrong with them is told where they are used.

    Args:
        kind: ``law``, ``effect``, ``estimator``, ``reader`` or ``controller``; the first two are used without being
            asked for by name.
        cls: the class.
        doing: is told which method is called next.
    """
    if kind not in ("law", "effect"):
        return
    import casadi

    from fricmodels.term import SIGNALS, Parameters, Signals

    term = cls()
    values = {name: casadi.SX.sym(name) for name in (*SIGNALS, *term.channels)}
    states = {state.symbol: casadi.SX.sym(state.symbol) for state in term.states}
    s, later = Signals(values, states), Signals(values, {})
    p = Parameters({parameter.symbol: casadi.SX.sym(parameter.symbol) for parameter in term.parameters})
    calls: dict[str, Callable[[], Any]] = {"torque": lambda: term.torque(s, p)}
    if states:
        calls["rates"] = lambda: term.rates(s, p)
        calls["discrete_step"] = lambda: term.discrete_step(s, later, casadi.SX.sym(STEP), p)
    for method, call in calls.items():
        doing(method)
        with suppress(Exception):
            call()
