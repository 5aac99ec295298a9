"""What the author wrote beside the equation, and how: the formula as text, foreign functions, copies."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import Array
from fricmodels.term import Law, Term
from fricmodels.testing.faults import Fault, SkipTest
from fricmodels.testing.formula_text import NotRead, Value, equations
from fricmodels.testing.subject import Subject, place_of, subject

_OF_NUMBERS = ("where", "select", "piecewise", "heaviside", "clip")
_TRIES = 12
_MOST_ORDERS = 5000


def check_own_functions(s: Subject) -> None:
    """The sign is that of :mod:`fricmodels.expressions`: numpy's and CasADi's is 0 at rest, and is never smoothed."""
    import casadi

    e = s.model.expression()
    made = casadi.Function("torque", [*e.signals.values(), e.parameters, e.states, e.width], [e.torque, e.rates])
    if any(made.instruction_id(i) == casadi.OP_SIGN for i in range(made.n_instructions())):
        raise Fault(
            f"np.sign() or casadi.sign() is used{place_of(s.term, 'sign(')}: it is 0 at rest, where friction holds, "
            "and no estimator can smooth it; write sign(s.velocity) of fricmodels.expressions"
        )
    for name in _OF_NUMBERS:
        for package in ("np", "numpy"):
            where = place_of(s.term, f"{package}.{name}(")
            if where:
                raise Fault(
                    f"{package}.{name}() is used{where}: it decides for numbers, and takes a symbol for true "
                    "whatever it stands for; write where(condition, yes, no), maximum(x, y) or minimum(x, y) of "
                    "fricmodels.expressions"
                )


def check_formula(s: Subject) -> None:
    """The formula that is printed says what ``torque`` and ``rates`` compute.

    Raises:
        SkipTest: for a formula that cannot be read, because it needs words.
    """
    parameters, states = [p.symbol for p in s.term.parameters], [z.symbol for z in s.term.states]
    try:
        readings = equations(s.term.formula, parameters, states)
    except NotRead as reason:
        raise SkipTest(f"the formula is not read: {reason}") from None
    if not any("τ" in reading for reading in readings):
        raise SkipTest("the formula has no equation τ = …")
    for symbol in states:
        if not any(f"d{symbol}/dt" in reading for reading in readings):
            raise Fault(
                f"the formula does not say how the state {symbol} changes; add ';  d{symbol}/dt = …' to it, as rates() "
                "computes it"
            )
    wrong = [_difference(s, reading) for reading in readings]
    if all(wrong):
        raise Fault(f"{wrong[0]}; write the same in both")


def _difference(s: Subject, reading: Mapping[str, Value]) -> str:
    """Return in words where a reading of the formula and the code differ; empty where they agree."""
    rng = np.random.default_rng(12)
    names = [*s.model.signals, *(p.symbol for p in s.term.parameters), *(z.symbol for z in s.term.states)]
    lines = {"τ": 0} | {f"d{z.symbol}/dt": i + 1 for i, z in enumerate(s.term.states)}
    for number in range(_TRIES):
        speed = float(rng.uniform(0.3, 2.0))
        column = s.column(rng, velocity=speed if number % 2 else -speed)
        given = dict(zip(names, column.tolist(), strict=False))
        computed = s.values(column)
        for line, place in lines.items():
            if line not in reading:
                continue
            try:
                said = float(reading[line](given))
            except (ArithmeticError, ValueError, TypeError, KeyError) as error:
                raise SkipTest(f"the formula cannot be evaluated: {error}") from None
            if not abs(said - computed[place]) <= 1e-6 * max(abs(said), abs(computed[place]), 1e-9):
                method = "rates()" if place else "torque()"
                return (
                    f"the formula says {line} = {said:.4g}, {method} gives {computed[place]:.4g} at {s.written(column)}"
                )
    return ""


def check_no_copy(s: Subject) -> None:
    """No other registered term has the same equation, unless the class says so."""
    kind = "law" if isinstance(s.term, Law) else "effect"
    registry = plugins.load().registries[kind]
    for name in registry.names:
        entry = registry.entry(name)
        if entry.cls is type(s.term) or name == s.term.name or name in s.term.same_as:
            continue
        if entry.distribution != "fricmodels" or not _alike(s.term, entry.cls):
            continue
        try:
            cls: Any = entry.cls
            other = subject(cls)
        except Fault:
            continue
        if _same(s, other):
            raise Fault(
                f"it is '{name}' of {entry.distribution} under another name: the torque is the same for the same "
                f"numbers; use that, or say same_as = frozenset({{'{name}'}}) where it is meant"
            )


def _alike(term: Term, cls: type[Any]) -> bool:
    units = sorted(str(p.dimension) for p in term.parameters)
    return len(term.states) == len(cls.states) and units == sorted(str(p.dimension) for p in cls.parameters)


def _same(s: Subject, other: Subject) -> bool:
    """Whether two terms are the same function, their parameters and states in some order."""
    if s.model.signals != other.model.signals or not s.term.parameters:
        return False
    rng = np.random.default_rng(13)
    columns = [s.column(rng, velocity=v) for v in (0.7, -1.3, 1.9, -0.4)]
    start = len(s.model.signals)
    for order in itertools.islice(_orders(s.term, other.term), _MOST_ORDERS):
        if all(_agree(s, other, column, start, order) for column in columns):
            return True
    return False


def _agree(s: Subject, other: Subject, column: Array, start: int, order: tuple[int, ...]) -> bool:
    there = column.copy()
    count = len(order)
    there[start : start + count] = column[start : start + count][list(order)]
    ours, theirs = s.torque(column), other.torque(there)
    return abs(ours - theirs) <= 1e-9 * max(abs(ours), abs(theirs), 1e-12)


def _orders(first: Term, second: Term) -> Iterator[tuple[int, ...]]:
    """Yield in which order the first's parameters stand for the second's, units alike."""
    kinds = [str(p.dimension) for p in first.parameters]
    wanted = [str(p.dimension) for p in second.parameters]
    for order in itertools.permutations(range(len(kinds))):
        if [kinds[i] for i in order] == wanted:
            yield order
