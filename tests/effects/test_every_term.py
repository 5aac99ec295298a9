"""What holds for every law and every effect, whatever its physics.

Change of units, finite derivatives at rest, derivatives against finite differences, the smooth limit, superposition in
the linear parameters, and the three ways of evaluation against each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fricmodels import plugins
from fricmodels.dimension import DIMENSIONLESS, TIME, VELOCITY, Dimension, Scales
from fricmodels.kernels import ArrayFunction, Scan
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.term import SIGNALS, Term

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Evaluated:
    """A term as CasADi functions of one column: signals, parameters, states, width of rest."""

    model: Model
    torque_and_rates: Any
    by_velocity_and_parameters: Any
    dimensions: tuple[Dimension, ...]


@lru_cache(maxsize=128)
def evaluated(name: str, *, smooth: bool = False) -> Evaluated:
    model = modelled(name)
    e = model.expression(smooth=smooth)
    column = casadi.vertcat(*e.signals.values(), e.parameters, e.states, e.width)
    slopes = casadi.jacobian(e.torque, casadi.vertcat(e.signals["velocity"], e.parameters)).T
    dimensions = [
        *(SIGNALS.get(name, DIMENSIONLESS) for name in model.signals),
        *(p.declared.dimension for p in model.parameters),
    ]
    dimensions += [*(state.dimension for state in model.states), VELOCITY]
    return Evaluated(
        model,
        casadi.Function("f", [column], [casadi.vertcat(e.torque, e.rates)]),
        casadi.Function("g", [column], [casadi.densify(slopes)]),
        tuple(dimensions),
    )


def modelled(name: str) -> Model:
    registered = plugins.load()
    if name in registered.laws:
        return Model(registered.laws[name]())
    return Model.only(registered.effects[name]())


def first_signals(term: Term) -> list[str]:
    """The signals that come before the parameters in a column of a term."""
    return [*SIGNALS, *term.channels]


def column(term: Term, rng: np.random.Generator, *, velocity: float | None = None, width: float = 1e-6) -> Array:
    """Return random signals, parameters and states, then the width of rest."""
    names = first_signals(term)
    signals = dict(zip(names, rng.uniform(-2, 2, len(names)), strict=True))
    signals["time"] = float(rng.uniform(0, 2))
    if velocity is not None:
        signals["velocity"] = velocity
    parameters = [drawn(p, rng) for p in term.parameters]
    states = rng.uniform(0.1, 1, len(term.states)) * 10 ** rng.uniform(-5, 0)
    return np.array([*signals.values(), *parameters, *states, width])


def drawn(parameter: Parameter, rng: np.random.Generator) -> float:
    """Return a value within a parameter's bounds, of the size of its initial value."""
    size = abs(parameter.initial) or 1.0
    value = size * float(10 ** rng.uniform(-1, 1)) * (1 if parameter.lower >= 0 else float(rng.choice([-1, 1])))
    return float(np.clip(value, parameter.lower, parameter.upper))


# ---- change of units --------------------------------------------------------------------------------------------

powers_of_two = st.integers(-60, 60).map(lambda exponent: 2.0**exponent)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@example(seed=118233, sizes=(1.0, 2.0**-43, 2.0**60, 1.0), at_rest=False, smooth=False)  # a speed to the tenth power
@given(
    seed=st.integers(0, 2**32 - 1),
    sizes=st.tuples(powers_of_two, powers_of_two, powers_of_two, powers_of_two),
    at_rest=st.booleans(),
    smooth=st.booleans(),
)
def test_the_torque_equation_holds_in_any_units(
    term: Term, seed: int, sizes: tuple[float, float, float, float], at_rest: bool, smooth: bool
) -> None:
    """Powers of two as sizes, so that scaled comparisons (t ≥ t_0, ω ≥ 0) are the same to the last bit."""
    force, displacement, time, temperature = sizes
    if term.angular:
        displacement = 1.0  # a turn is a turn: its angle is in rad by nature
    scales = Scales(force, displacement, time, temperature)
    e = evaluated(term.name, smooth=smooth)
    x = column(term, np.random.default_rng(seed), velocity=0.0 if at_rest else None)
    normalised = x / np.array([scales.of(d) for d in e.dimensions])
    in_si, scaled = (np.array(e.torque_and_rates(values)).ravel() for values in (x, normalised))
    back = np.array([scales.force, *(scales.of(state.dimension * TIME**-1) for state in e.model.states)])
    np.testing.assert_allclose(scaled * back, in_si, rtol=1e-9, atol=1e-9 * float(np.max(np.abs(in_si), initial=1e-9)))


# ---- at rest ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("smooth", [False, True])
def test_torque_and_derivatives_at_rest_are_finite(term: Term, smooth: bool) -> None:
    rng = np.random.default_rng(1)
    e = evaluated(term.name, smooth=smooth)
    for velocity in (0.0, -0.0, 1e-300, -1e-300, 1e-9):
        x = column(term, rng, velocity=velocity)
        assert np.all(np.isfinite(np.array(e.torque_and_rates(x))))
        assert np.all(np.isfinite(np.array(e.by_velocity_and_parameters(x))))


# ---- derivatives ------------------------------------------------------------------------------------------------


def test_derivatives_agree_with_finite_differences(term: Term) -> None:
    rng = np.random.default_rng(3)
    e = evaluated(term.name)
    places = [list(SIGNALS).index("velocity"), *(len(first_signals(term)) + np.arange(len(term.parameters)))]
    for _ in range(10):
        x = column(term, rng)
        exact = np.array(e.by_velocity_and_parameters(x)).ravel()
        for slope, place in zip(exact, places, strict=True):
            step = 1e-6 * max(abs(x[place]), 1e-3)
            ends = []
            for moved in (x[place] - step, x[place] + step):
                there = x.copy()
                there[place] = moved
                ends.append(float(e.torque_and_rates(there)[0]))
            size = max(abs(slope), max(map(abs, ends)))
            assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(slope, rel=1e-4, abs=1e-4 * size + 1e-9)


def test_the_smooth_torque_becomes_the_sharp_one_away_from_rest(term: Term) -> None:
    rng = np.random.default_rng(4)
    sharp, smooth = evaluated(term.name), evaluated(term.name, smooth=True)
    for _ in range(10):
        x = column(term, rng, velocity=float(rng.choice([-1, 1]) * rng.uniform(0.05, 2)), width=1e-4)
        expected = np.array(sharp.torque_and_rates(x))
        np.testing.assert_allclose(np.array(smooth.torque_and_rates(x)), expected, rtol=1e-9, atol=1e-12)


# ---- linear parameters ------------------------------------------------------------------------------------------


def test_parameters_called_linear_obey_superposition(term: Term) -> None:
    rng = np.random.default_rng(5)
    e = evaluated(term.name)
    linear = np.array(e.model.linear)
    first = len(first_signals(term))
    places = first + np.flatnonzero(linear)
    for _ in range(10):
        x = column(term, rng)

        def at(theta: Array, x: Array = x) -> Array:
            there = x.copy()
            there[places] = theta
            return np.array(e.torque_and_rates(there)).ravel()

        a, b = rng.normal(size=(2, len(places)))
        nothing = at(np.zeros(len(places)))
        both = at(2 * a - 3 * b) - nothing
        alone = 2 * (at(a) - nothing) - 3 * (at(b) - nothing)
        np.testing.assert_allclose(both, alone, rtol=1e-9, atol=1e-9 * float(np.max(np.abs(both), initial=1.0)))


def test_no_parameter_is_called_nonlinear_without_need(term: Term) -> None:
    """Each such parameter breaks superposition with the linear ones, or changes the rate of a state."""
    rng = np.random.default_rng(6)
    e = evaluated(term.name)
    linear = np.flatnonzero(e.model.linear)
    for i in np.flatnonzero(~np.array(e.model.linear)):
        places = len(first_signals(term)) + np.array([*linear, i])
        breaks = False
        for _ in range(50):
            x = column(term, rng)
            ends = []
            for factor in (0.5, 1.0, 1.5):
                there = x.copy()
                there[places] *= factor
                ends.append(np.array(e.torque_and_rates(there)).ravel())
            bend = ends[2] - 2 * ends[1] + ends[0]
            if np.any(np.abs(bend) > 1e-9 * (1 + np.abs(ends[1]))) or np.any(ends[2][1:] != ends[0][1:]):
                breaks = True
                break
        assert breaks, term.parameters[i].symbol


# ---- three ways of evaluation -----------------------------------------------------------------------------------


def test_arrays_casadi_and_compiled_loop_agree_for_every_term() -> None:
    """One compiled loop for all terms: each term's torque, rates and slopes, beside NumPy's and CasADi's own."""
    registered = plugins.load()
    names = [*registered.laws, *registered.effects]
    rng = np.random.default_rng(7)
    count = 300
    signals = casadi.SX.sym("signals", len(SIGNALS) + 1)
    rows = rng.uniform(-2, 2, (count, len(SIGNALS) + 1))
    rows[:, list(SIGNALS).index("velocity")][::10] = 0.0
    rows[:, -1] = 1e-6
    constants: list[Any] = []
    values: list[float] = []
    outputs: list[Any] = []
    for name in names:
        model = modelled(name)
        own = casadi.SX.sym(name, len(model.terms[-1].channels) + len(model.parameters) + len(model.states))
        both = casadi.vertcat(signals[:-1], own, signals[-1])
        e = evaluated(name)
        outputs += [e.torque_and_rates(both), e.by_velocity_and_parameters(both)]
        constants.append(own)
        drawn_values = column(model.terms[-1], rng)[len(SIGNALS) : -1]
        values += drawn_values.tolist()
    fixed, total = casadi.vertcat(*constants), casadi.vertcat(*outputs)
    clock = casadi.SX.sym("clock")
    step = casadi.Function("all", [clock, signals, fixed], [clock + 1, total])
    last, compiled, done = Scan(step)([0.0], rows, values)
    assert (last[0], done) == (count, count)
    _, arrays = ArrayFunction(step)(0.0, *rows.T, *values)
    _, own_machine = step.map(count)(0.0, rows.T, np.array(values))
    size = 1 + np.abs(arrays.T)
    assert np.max(np.abs(compiled - arrays.T) / size) < 1e-12
    assert np.max(np.abs(np.array(own_machine).T - arrays.T) / size) < 1e-12
