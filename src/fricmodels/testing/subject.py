"""A law or an effect as the exam sees it: functions of signals, parameters and states, and values to try."""

from __future__ import annotations

import inspect
import math
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import Array, Mask
from fricmodels.dimension import DIMENSIONLESS, VELOCITY, Dimension
from fricmodels.errors import FricmodelsError
from fricmodels.expressions import rest_treatment
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.term import SIGNALS, Effect, Law, Parameters, Signals, Term
from fricmodels.testing.faults import Fault

VELOCITY_PLACE = list(SIGNALS).index("velocity")
_LARGEST = 1e6
"""Stands for a bound that is missing."""


@dataclass(frozen=True)
class Subject:
    """A term and its functions of one *column*: signals, parameters, states, width of rest.

    Attributes:
        term, model: the term, and the model that it makes alone.
        torque_and_rates: column → (1 + states,).
        slopes: column → derivative of the torque by the velocity and each parameter.
        smooth: ``torque_and_rates`` with tanh for sgn.
        dimensions: of each element of the column.
        touched: signals that the term uses.
    """

    term: Term
    model: Model
    torque_and_rates: Any
    slopes: Any
    smooth: Any
    dimensions: tuple[Dimension, ...]
    touched: frozenset[str]

    @property
    def linear(self) -> Mask:
        """Which parameters enter linearly."""
        return np.array(self.model.linear, dtype=bool)

    def values(self, column: Array) -> Array:
        """Return torque and rates at a column."""
        return np.array(self.torque_and_rates(column)).ravel()

    def torque(self, column: Array) -> float:
        """Return the torque at a column."""
        return float(self.values(column)[0])

    def place(self, parameter: int) -> int:
        """Return where a parameter stands in the column."""
        return len(self.model.signals) + parameter

    @property
    def linear_places(self) -> list[int]:
        """Where the linear parameters stand in the column."""
        return [self.place(i) for i, linear in enumerate(self.model.linear) if linear]

    def column(
        self,
        rng: np.random.Generator,
        *,
        velocity: float | None = None,
        parameters: Sequence[float] | None = None,
        width: float = 1e-6,
    ) -> Array:
        """Return random signals, parameters within their bounds, states, and the width of rest."""
        signals = rng.uniform(-2, 2, len(self.model.signals))
        signals[list(SIGNALS).index("time")] = rng.uniform(0, 2)
        if velocity is not None:
            signals[VELOCITY_PLACE] = velocity
        chosen = drawn(self.term.parameters, rng) if parameters is None else list(parameters)
        states = rng.uniform(0.1, 1, len(self.term.states)) * 10 ** rng.uniform(-5, 0)
        return np.array([*signals, *chosen, *states, width])

    def written(self, column: Array) -> str:
        """Write the velocity and the parameters of a column in words."""
        parameters = [f"{p.symbol} = {column[self.place(i)]:.3g}" for i, p in enumerate(self.term.parameters)]
        return ", ".join([f"ω = {column[VELOCITY_PLACE]:.3g}", *parameters])


@lru_cache(maxsize=64)
def subject(cls: type[Term]) -> Subject:
    """Build the functions of a term.

    Raises:
        Fault: where the term's own code fails, or what it returns is no torque.
    """
    import casadi

    term = _made(cls)
    signals = {name: casadi.SX.sym(name) for name in (*SIGNALS, *term.channels)}
    _check_equations(term, signals)
    model = Model.only(_declared(term))
    try:
        e, smooth = model.expression(), model.expression(smooth=True)
    except FricmodelsError as error:
        raise Fault(f"{error}; return a rate for every declared state from rates()") from None
    column, smooth_column = (casadi.vertcat(*x.signals.values(), x.parameters, x.states, x.width) for x in (e, smooth))
    slopes = casadi.densify(casadi.jacobian(e.torque, casadi.vertcat(e.signals["velocity"], e.parameters)))
    dimensions = [
        *(SIGNALS.get(name, DIMENSIONLESS) for name in model.signals),
        *(p.dimension for p in term.parameters),
    ]
    dimensions += [*(state.dimension for state in term.states), VELOCITY]
    return Subject(
        term,
        model,
        casadi.Function("f", [column], [casadi.vertcat(e.torque, e.rates)]),
        casadi.Function("g", [column], [slopes]),
        casadi.Function("h", [smooth_column], [casadi.vertcat(smooth.torque, smooth.rates)]),
        tuple(dimensions),
        model.needs,
    )


def written_anew(term: Term) -> Any:
    """Call ``torque`` and ``rates`` once more; return a function of the column, as :attr:`Subject.torque_and_rates`."""
    import casadi

    signals = {name: casadi.SX.sym(name) for name in (*SIGNALS, *term.channels)}
    own = {p.symbol: casadi.SX.sym(p.symbol) for p in term.parameters}
    memory = {z.symbol: casadi.SX.sym(z.symbol) for z in term.states}
    width = casadi.SX.sym("width")
    with rest_treatment(width, smooth=False):
        torque = _called("torque", term, signals, own, memory)
        rates = _called("rates", term, signals, own, memory) if memory else {}
    column = casadi.vertcat(*signals.values(), *own.values(), *memory.values(), width)
    return casadi.Function("anew", [column], [casadi.vertcat(torque, *(rates[symbol] for symbol in memory))])


def _made(cls: type[Term]) -> Term:
    try:
        return cls()
    except Exception as error:
        raise Fault(
            f"{cls.__name__}() raises {type(error).__name__}: {error}; a term is made without arguments"
        ) from None


def _declared(term: Term) -> Law | Effect:
    if not isinstance(term, (Law, Effect)):
        raise Fault(f"{type(term).__name__} is neither a Law nor an Effect; derive it from one of them")
    return term


def _check_equations(term: Term, symbols: dict[str, Any]) -> None:
    """Call torque and rates once and look at what they return."""
    import casadi

    own = {p.symbol: casadi.SX.sym(p.symbol) for p in term.parameters}
    memory = {z.symbol: casadi.SX.sym(z.symbol) for z in term.states}
    with rest_treatment(casadi.SX.sym("width"), smooth=False):
        returned = {"torque()": _called("torque", term, symbols, own, memory)}
        rates = _called("rates", term, symbols, own, memory) if memory else {}
    if not isinstance(rates, dict):
        raise Fault(f"rates() returns {type(rates).__name__}; return a dict with the rate of each state by symbol")
    for symbol in memory:
        if symbol not in rates:
            raise Fault(f"rates() has no rate for the state '{symbol}'; return {{'{symbol}': …}}")
    returned |= {f"rates()['{symbol}']": rate for symbol, rate in rates.items()}
    for what, value in returned.items():
        _check_scalar(what, value)


def _check_scalar(what: str, value: Any) -> None:
    import casadi

    if value is None:
        raise Fault(f"{what} returns nothing; end it with return and the expression")
    if isinstance(value, int | float):
        return
    if not isinstance(value, casadi.SX):
        raise Fault(f"{what} returns {type(value).__name__}, no expression; write it with fricmodels.expressions")
    if value.shape != (1, 1):
        rows, columns = value.shape
        raise Fault(f"{what} has the wrong shape {rows}×{columns}; return one scalar, the torque at one sample")


def _called(method: str, term: Term, symbols: dict[str, Any], own: dict[str, Any], memory: dict[str, Any]) -> Any:
    try:
        with plugins.unheard():
            return getattr(term, method)(Signals(symbols, memory), Parameters(own))
    except (Exception, SystemExit) as error:
        raise Fault(
            f"{method}() raises {type(error).__name__}: {_in_words(error)} ({_authors_line(error, term)}); "
            f"{_instead(error, symbols, own)}"
        ) from None


def _authors_line(error: BaseException, term: Term) -> str:
    """Return the line of the author's own file in which an error comes up, and what is written there."""
    frames = traceback.extract_tb(error.__traceback__)
    files = {inspect.getsourcefile(cls) for cls in type(term).__mro__ if cls.__module__.partition(".")[0] != "builtins"}
    ours = str(Path(__file__).parents[1])
    own = [frame for frame in frames if frame.filename in files and not frame.filename.startswith(ours)]
    foreign = [f for f in frames if not f.filename.startswith(ours) and "casadi" not in Path(f.filename).parts]
    line = (own or foreign or [*frames])[-1]
    code = f": {line.line}" if line.line else ""
    return f"line {line.lineno} of {Path(line.filename).name}{code}"


def _in_words(error: BaseException) -> str:
    """Return the first line of an error; CasADi's go on with the places in its own source."""
    text = str(error).strip()
    if "truth value" in text:
        return "a symbol is neither true nor false"
    return " ".join(text.splitlines()[-1].split()) if text else "no reason is given"


def _instead(error: BaseException, symbols: Mapping[str, Any], own: Mapping[str, Any]) -> str:
    text = str(error)
    if "truth value" in text or "ambiguous" in text:
        return (
            "write where(condition, yes, no) for if, maximum(x, y) for max(), minimum(x, y) for min(), and sign() and "
            "where() of fricmodels.expressions for numpy's"
        )
    if isinstance(error, AttributeError) and "there is no" in text:
        wrong = text.partition("'")[2].partition("'")[0]
        near = get_close_matches(wrong, [*symbols, *own], n=1)
        return f"did you mean {'p' if near[0] in own else 's'}.{near[0]}?" if near else "use one of those"
    return "use s.SIGNAL, p.SYMBOL and the functions of fricmodels.expressions"


def place_of(term: Term, written: str) -> str:
    """Return `` in line 12 of name.py`` for where some text stands in the code of a class; empty if it cannot be found.

    Args:
        term: of that class; written: the text.
    """
    try:
        lines, first = inspect.getsourcelines(type(term))
        name = Path(inspect.getsourcefile(type(term)) or "").name
    except (OSError, TypeError):
        return ""
    found = [
        first + number for number, line in enumerate(lines) if written in line and not line.lstrip().startswith("#")
    ]
    return f" in line {found[0]} of {name}" if found else ""


def drawn(parameters: Sequence[Parameter], rng: np.random.Generator) -> list[float]:
    """Return random values within the bounds, of the size of the initial values; none below its ``at_least``."""
    values: dict[str, float] = {}
    for p in parameters:
        size = abs(p.initial) or 1.0
        value = size * float(10 ** rng.uniform(-1, 1)) * (1 if p.lower >= 0 else float(rng.choice([-1, 1])))
        values[p.symbol] = float(np.clip(value, p.lower, p.upper))
    for p in in_order(parameters):
        if p.at_least is not None:
            values[p.symbol] = min(p.upper, values[p.at_least] + abs(values[p.symbol]))
    return [values[p.symbol] for p in parameters]


def in_order(parameters: Sequence[Parameter]) -> list[Parameter]:
    """Return the parameters in an order in which each comes after the one that it must not fall below."""
    left, placed = list(parameters), []
    while left:
        ready = [p for p in left if p.at_least not in {other.symbol for other in left if other is not p}]
        if not ready:
            raise Fault(f"at_least goes round in a circle among {', '.join(p.symbol for p in left)}; break it")
        placed += ready
        left = [p for p in left if p not in ready]
    return placed


def at_bounds(parameters: Sequence[Parameter], rng: np.random.Generator) -> list[tuple[str, list[float]]]:
    """Return, for each bound, its name and values of which one parameter lies on it."""
    cases = []
    for i, p in enumerate(parameters):
        for side, bound in (("lower", p.lower), ("upper", p.upper)):
            value = bound if math.isfinite(bound) else math.copysign(_LARGEST, bound)
            values = drawn(parameters, rng)
            values[i] = value
            cases.append((f"{p.symbol} at its {side} bound {bound:g}", values))
    return cases
