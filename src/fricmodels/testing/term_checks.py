"""What is asked of every law and every effect, apart from estimation."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.errors import FricmodelsError
from fricmodels.term import SIGNALS, Effect, Term
from fricmodels.testing.faults import Fault, SkipTest
from fricmodels.testing.subject import VELOCITY_PLACE, Subject, at_bounds, written_anew

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_AT_REST = (0.0, -0.0, 1e-300, -1e-300, 1e-9, -1e-9)


def check_declaration(cls: type[Term]) -> None:
    """Name, formula, docstring, units and meanings of parameters."""
    name = getattr(cls, "name", None)
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise Fault(f"name is {name!r}; write it in lower case with hyphens, as in 'coulomb-viscous'")
    if not cls.formula:
        raise Fault("formula is empty; write the equation in plain text, as lists and reports print it")
    if not (cls.__doc__ or "").strip():
        raise Fault(f"{cls.__name__} has no docstring; say in one sentence what it is, with equation and source")
    for p in cls.parameters:
        try:
            _ = p.dimension
        except (FricmodelsError, ValueError) as error:
            raise Fault(f"unit of {p.symbol}: {error}") from None
        if not p.meaning:
            raise Fault(f'parameter {p.symbol} has no meaning; say in words what it is: meaning="…"')
    if issubclass(cls, Effect):
        for attribute in ("signature", "needs_motion"):
            if not getattr(cls, attribute):
                raise Fault(f"{attribute} is empty; say in words {_WORDS[attribute]}")


_WORDS = {
    "signature": "what the missing effect leaves in the residual torque",
    "needs_motion": "what a recording must contain to show it",
}


def check_parameters_matter(s: Subject) -> None:
    """Every declared parameter changes the torque; nonlinear ones say where to look for them."""
    import casadi

    e = s.model.expression()
    both = casadi.vertcat(e.torque, e.rates)
    symbols = casadi.vertsplit(e.parameters) if s.term.parameters else []
    for p, symbol in zip(s.term.parameters, symbols, strict=True):
        if not casadi.depends_on(both, symbol):
            raise Fault(f"{p.symbol} is declared but enters neither torque() nor rates(); use it or take it out")
    if not s.term.parameters:
        raise Fault('there is no parameter to estimate; declare one: K = Parameter("K", unit="N m", …)')
    for p, linear in zip(s.term.parameters, s.linear, strict=True):
        if p.constant:
            continue
        if not linear and not p.scan and not p.periodic:
            raise Fault(
                f"{p.symbol} enters nonlinearly and has no scan: no estimator knows where to begin; give the values to "
                "try first, in units of the recording's peak speed, range and duration: scan=(0.03, 0.1, 0.3)"
            )
        if linear and (p.scan or p.periodic):
            raise Fault(f"{p.symbol} enters linearly and is solved for directly; take its scan out")


def check_same_every_time(s: Subject) -> None:
    """The equations depend on signals, states and parameters alone, and on the time only where it is claimed."""
    rng = np.random.default_rng(2)
    first, second = written_anew(s.term), written_anew(s.term)
    for _ in range(3):
        column = s.column(rng)
        if not np.array_equal(np.array(first(column)), np.array(second(column)), equal_nan=True):
            raise Fault(
                "torque() gives another expression at every call: it uses the clock, a random number or something kept "
                "from before; use s.time for time, and a State for memory"
            )
    uses = "time" in s.touched
    if uses and not s.term.depends_on_time:
        raise Fault(
            "the torque depends on the time itself and does not say so; declare depends_on_time = True, or take "
            "s.time out (memory of the motion belongs in a State)"
        )
    if s.term.depends_on_time and not uses:
        raise Fault("depends_on_time = True is claimed, but torque() does not touch s.time; take the claim out")


def check_finite(s: Subject) -> None:
    """Torque, rates and derivatives are finite at rest, near rest and at the bounds of every parameter."""
    rng = np.random.default_rng(1)
    for velocity in _AT_REST:
        _finite(s, s.column(rng, velocity=velocity), "at rest")
    for where, values in at_bounds(s.term.parameters, rng):
        for velocity in (0.0, 1.0, -1.0):
            _finite(s, s.column(rng, velocity=velocity, parameters=values), f"with {where}")


def _finite(s: Subject, column: Array, where: str) -> None:
    functions: dict[str, Callable[[Array], Any]] = {"torque": s.torque_and_rates, "smoothed torque": s.smooth}
    for what, function in functions.items():
        if not np.all(np.isfinite(np.array(function(column)))):
            raise Fault(
                f"the {what} is not finite {where} ({s.written(column)}); there is a division by zero or a root of a "
                "negative number: use absolute(), power(), or a bound that keeps away from it"
            )
    slopes = np.array(s.slopes(column)).ravel()
    names = ["velocity", *(p.symbol for p in s.term.parameters)]
    for name, slope in zip(names, slopes, strict=True):
        if not np.isfinite(slope):
            kind = "not a number" if np.isnan(slope) else "infinite"
            raise Fault(
                f"the derivative of the torque by {name} is {kind} {where} ({s.written(column)}); write |ω|^n as "
                "power(s.velocity, n), whose slope stays finite, instead of sqrt or **"
            )


def check_derivatives(s: Subject) -> None:
    """Derivatives by velocity and parameters agree with central differences."""
    rng = np.random.default_rng(3)
    names = ["velocity", *(p.symbol for p in s.term.parameters)]
    places = [VELOCITY_PLACE, *(s.place(i) for i in range(len(s.term.parameters)))]
    for _ in range(10):
        column = s.column(rng)
        for name, place, slope in zip(names, places, np.array(s.slopes(column)).ravel(), strict=True):
            step = 1e-6 * max(abs(column[place]), 1e-3)
            ends = []
            for moved in (column[place] - step, column[place] + step):
                there = column.copy()
                there[place] = moved
                ends.append(s.torque(there))
            size = max(abs(slope), *map(abs, ends))
            if not abs((ends[1] - ends[0]) / (2 * step) - slope) <= 2e-4 * size + 1e-9:
                raise Fault(
                    f"the derivative by {name} is {slope:.4g}, the torque changes by "
                    f"{(ends[1] - ends[0]) / 2 / step:.4g} ({s.written(column)}); "
                    "floor(), rounding or a jump hides the slope: write a smooth expression"
                )


def check_smooth_limit(s: Subject) -> None:
    """With sgn replaced by a tanh of small width, the torque away from rest is the same."""
    rng = np.random.default_rng(4)
    for _ in range(10):
        column = s.column(rng, velocity=float(rng.choice([-1, 1]) * rng.uniform(0.05, 2)), width=1e-4)
        sharp, smooth = s.values(column), np.array(s.smooth(column)).ravel()
        if not np.allclose(sharp, smooth, rtol=1e-9, atol=1e-12):
            raise Fault(
                f"smoothed, the torque is {smooth[0]:.6g} and not {sharp[0]:.6g} away from rest ({s.written(column)}); "
                "take sign(), positive() and power() of the velocity itself, not of something small"
            )


def check_linear(s: Subject) -> None:
    """The torque obeys superposition in the parameters that are solved linearly."""
    rng = np.random.default_rng(5)
    places = s.linear_places
    for _ in range(10):
        column = s.column(rng)

        def at(theta: Array, column: Array = column) -> float:
            there = column.copy()
            there[places] = theta
            return s.torque(there)

        a, b = rng.normal(size=(2, len(places)))
        nothing = at(np.zeros(len(places)))
        both, alone = at(2 * a - 3 * b) - nothing, 2 * (at(a) - nothing) - 3 * (at(b) - nothing)
        if not abs(both - alone) <= 1e-8 * max(1.0, abs(both), abs(alone)):
            listed = ", ".join(p.symbol for p, linear in zip(s.term.parameters, s.linear, strict=True) if linear)
            raise Fault(f"the torque is not linear in {listed}, though its derivatives say so ({s.written(column)})")


def check_dissipative(s: Subject) -> None:
    """Where it is claimed: the torque never pushes, τ·ω ≥ 0, for all parameters within their bounds."""
    if not s.term.dissipative:
        raise SkipTest("dissipative = False: it may push")
    if s.term.states:
        raise SkipTest("a term with memory gives back what it stored")
    rng = np.random.default_rng(6)
    for _ in range(300):
        column = s.column(rng, velocity=float(rng.choice([-1, 1]) * 10 ** rng.uniform(-4, 1)))
        torque = s.torque(column)
        if torque * column[VELOCITY_PLACE] < -1e-12 * abs(torque):
            raise Fault(_pushes(s, column, torque))


def _pushes(s: Subject, column: Array, torque: float) -> str:
    where = f"τ = {torque:.3g} at {s.written(column)}"
    for i in (i for i, linear in enumerate(s.model.linear) if linear):
        alone = column.copy()
        alone[[place for place in s.linear_places if place != s.place(i)]] = 0.0
        mirrored = alone.copy()
        mirrored[VELOCITY_PLACE] *= -1
        p = s.term.parameters[i]
        powers = [s.torque(x) * x[VELOCITY_PLACE] for x in (alone, mirrored)]
        if min(powers) >= 0:
            continue
        if signed := _signed_signal(s, i, alone):
            return signed
        if p.lower < 0:
            return (
                f"the torque pushes along the motion with a negative {p.symbol}, which its bounds "
                f"[{p.lower:g}, {p.upper:g}] allow: {where}; declare lower=0.0, or dissipative = False"
            )
        if max(powers) > 0:
            return (
                f"the part with {p.symbol} does not turn with the direction and pushes in one of them: {where}; "
                "multiply it by sign(s.velocity), and write absolute(s.velocity) for speed"
            )
        return (
            f"the part with {p.symbol} has the wrong sign and pushes along the motion: {where}; friction τ_F is "
            "positive when ω is positive"
        )
    return (
        f"the torque pushes along the motion: {where}; look at signs, at absolute(s.velocity) and at bounds "
        "(at_least for a stick torque), or declare dissipative = False"
    )


def _signed_signal(s: Subject, i: int, alone: Array) -> str:
    """Say with which signal the part of a parameter changes its sign; empty where there is none: a bound is no cure."""
    p = s.term.parameters[i]
    for name in sorted(s.touched - {"velocity"}):
        place, powers = list(s.model.signals).index(name), []
        for side in (1.0, -1.0):
            column = alone.copy()
            column[s.place(i)], column[place] = abs(column[s.place(i)]), side * abs(column[place])
            powers.append(s.torque(column) * column[VELOCITY_PLACE])
        if powers[0] > 0.0 > powers[1]:
            return (
                f"the part with {p.symbol} pushes along the motion where {name} is negative, with a positive "
                f"{p.symbol} too: τ = {s.torque(column):.3g} at {name} = {column[place]:.3g}, {s.written(column)}; "
                f"write absolute(s.{name}) or another factor that is never negative, or declare dissipative = False"
            )
    return ""


def check_symmetry(s: Subject) -> None:
    """Where it is claimed: the torque is odd or even in the velocity, all other signals as they are.

    A state may turn over with the velocity, as a deflection does, or stay, as a temperature does.
    """
    claim = s.term.symmetry
    if claim is None:
        raise SkipTest("symmetry = None: nothing is claimed")
    if claim not in ("odd", "even"):
        raise Fault(f"symmetry is {claim!r}; it is 'odd', 'even' or None")
    ways = [_turned_over(s, turned) for turned in product((1.0, -1.0), repeat=len(s.term.states))]
    if any(found[claim] for found, _ in ways):
        return
    found, example = ways[0][0], ways[-1][1][claim]
    other = "even" if claim == "odd" else "odd"
    if found[other]:
        advice = (
            "the sign of the direction is forgotten: multiply by sign(s.velocity)"
            if claim == "odd"
            else 'declare symmetry = "odd"'
        )
        raise Fault(f"symmetry '{claim}' is claimed, but the torque is {other}: {example}; {advice}")
    raise Fault(
        f"symmetry '{claim}' is claimed, but the directions differ in size: {example}; use absolute(s.velocity) where "
        "speed is meant, or declare symmetry = None"
    )


def _turned_over(s: Subject, states: Sequence[float]) -> tuple[dict[str, bool], dict[str, str]]:
    """Return whether a torque is odd and even if states turn over (−1) or stay (1), and where it is not."""
    rng = np.random.default_rng(8)
    found, examples = {"odd": True, "even": True}, dict[str, str]()
    for _ in range(60):
        column = s.column(rng, velocity=float(10 ** rng.uniform(-2, 1)))
        mirrored = column.copy()
        mirrored[VELOCITY_PLACE] *= -1
        mirrored[len(mirrored) - 1 - len(states) : -1] *= states
        forward, backward = s.torque(column), s.torque(mirrored)
        size = 1e-9 * max(abs(forward), abs(backward), 1e-12)
        found["odd"] &= abs(forward + backward) <= size
        found["even"] &= abs(forward - backward) <= size
        for claim, holds in found.items():
            if not holds:
                examples.setdefault(claim, f"τ = {forward:.4g} forward, {backward:.4g} backward at {s.written(column)}")
    return found, examples


def check_neutral(s: Subject) -> None:
    """An effect whose linear parameters are zero changes nothing: the model contains the one without it."""
    if not isinstance(s.term, Effect):
        raise SkipTest("a law needs no neutral value")
    if not s.linear.any():
        raise Fault("no parameter enters linearly, so nothing scales the effect; multiply it by an amplitude")
    for p, linear in zip(s.term.parameters, s.linear, strict=True):
        if linear and not p.constant and not p.lower <= 0.0 <= p.upper:
            raise Fault(f"{p.symbol} cannot be zero within [{p.lower:g}, {p.upper:g}], so the effect cannot be absent")
    rng = np.random.default_rng(9)
    for _ in range(20):
        column = s.column(rng)
        column[s.linear_places] = 0.0
        torque = s.torque(column)
        if abs(torque) > 1e-12:
            raise Fault(
                f"with all linear parameters zero the effect still adds {torque:.3g} ({s.written(column)}); a part of "
                "torque() has no amplitude: multiply it by one"
            )


def check_discrete_step(s: Subject) -> None:
    """Where states have a discrete step, a short one agrees with the rates, in either direction."""
    import casadi

    e = s.model.expression()
    if not e.discrete_step:
        raise SkipTest("no state has a discrete step: the rates are integrated")
    given = casadi.vertcat(*e.signals.values(), e.parameters, e.states, e.width)
    following = casadi.vertcat(*(e.discrete_step[i] for i in range(e.states.numel())))
    ends = {**e.signals, "velocity": e.signals["velocity"] + e.step * e.signals["acceleration"]}
    step = casadi.substitute(following, casadi.vertcat(*e.later.values()), casadi.vertcat(*ends.values()))
    by_states = casadi.jacobian(e.torque, e.states)
    change = casadi.substitute(e.torque, e.states, step) - e.torque
    both = casadi.Function("discrete_step", [given, e.step], [change / e.step, casadi.mtimes(by_states, e.rates)])
    decay = casadi.Function("decay", [given], [casadi.norm_inf(casadi.vec(casadi.jacobian(e.rates, e.states)))])
    rng = np.random.default_rng(10)
    for direction in (1, -1) * 20:
        column = s.column(rng, velocity=direction * float(rng.uniform(0.1, 2)))
        fast = max(float(np.max(np.abs(s.values(column)[1:]))), float(decay(column)))
        stepped, rate = (float(value) for value in both(column, 1e-6 / max(fast, 1.0)))
        if not abs(stepped - rate) <= 1e-3 * abs(rate) + 1e-6 * max(fast, 1.0):
            raise Fault(
                f"over a short discrete_step() the torque changes by {stepped:.4g} a second, rates() by {rate:.4g} "
                f"({s.written(column)}); write the same law in both: the step's length is h, signals at its end later"
            )


def check_beginning(s: Subject) -> None:
    """First states that are to be found from the torque: one linear parameter, and all linear in the states."""
    import casadi

    if not s.term.beginning_unknown:
        raise SkipTest("no first state is to be found from the torque")
    e, linear = s.model.expression(), sum(s.model.linear)
    if not s.term.states or linear != 1:
        raise Fault(
            f"beginning_unknown needs states and one linear parameter, found {len(s.term.states)} and {linear}: the "
            "states are found in units of that one torque; leave beginning_unknown out"
        )
    both = casadi.vertcat(e.torque, e.rates, *e.discrete_step.values())
    if casadi.depends_on(casadi.jacobian(both, e.states), e.states):
        raise Fault(
            "beginning_unknown needs torque(), rates() and discrete_step() linear in the states: what a beginning "
            "leaves is added to them; leave beginning_unknown out"
        )


def check_needs(s: Subject) -> None:
    """A law is built on the velocity, and nobody uses what an estimator cannot give."""
    import casadi

    e = s.model.expression()
    slope = casadi.jacobian(e.torque, e.signals["acceleration"])
    if casadi.depends_on(slope, e.signals["acceleration"]):
        raise Fault("the torque is not linear in s.acceleration, so the equation of motion cannot be solved for it")
    if not s.touched and not s.term.states and not isinstance(s.term, Effect):
        raise Fault(f"the torque uses no signal; use one of {', '.join('s.' + name for name in SIGNALS)}")


def check_compiled(s: Subject) -> None:
    """The compiled loop and the evaluation on arrays agree to rounding, samples at rest included."""
    import casadi

    from fricmodels.kernels import ArrayFunction, Scan

    rng = np.random.default_rng(7)
    count = 200
    rows = np.array([s.column(rng) for _ in range(count)])
    rows[::10, VELOCITY_PLACE] = 0.0
    clock, column = casadi.SX.sym("clock"), casadi.SX.sym("column", rows.shape[1])
    outputs = casadi.vertcat(s.torque_and_rates(column), casadi.vec(s.slopes(column)))
    step = casadi.Function("term", [clock, column, casadi.SX(0, 1)], [clock + 1, outputs])
    try:
        _, compiled, _ = Scan(step)([0.0], rows, [])
        _, arrays = ArrayFunction(step)(0.0, *rows.T)
    except (FricmodelsError, KeyError, ValueError, TypeError) as error:
        raise Fault(f"the expression cannot be compiled: {type(error).__name__}: {error}") from None
    difference = np.abs(compiled - arrays.T) / (1 + np.abs(arrays.T))
    if not np.max(difference) < 1e-10:
        worst = int(np.unravel_index(np.nanargmax(difference), difference.shape)[0])
        raise Fault(
            f"compiled and on arrays the results differ by {np.nanmax(difference):.2g} ({s.written(rows[worst])}); "
            "it loses digits where large numbers cancel: write it another way"
        )
