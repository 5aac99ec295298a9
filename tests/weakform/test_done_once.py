"""What a fit knows already is not found again, and what it takes from elsewhere is what it would have found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi
import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.kernels import ArrayFunction
from fricmodels.memory import Memory
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals import velocity_noise
from fricmodels.weakform.cases import fitted_as_held, with_or_without_shift
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.predicted_velocity import wandering_level
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.shift_evidence import STRONG, could_be_shifted, log_odds_of_a_shift, log_odds_of_held
from fricmodels.weakform.solve import Solved, begins_where, solve

Made = Callable[..., Recording]
EXPONENTIAL = Drive(Model.parse("exponential-stick-slip"))
HIDDEN = {"stribeck.F_s": 3.0, "stribeck.omega_s": 1.0, "stribeck.delta": 1.0}
TRUTH = {"J": 2.0, "K_v": 0.5, "K_c": 6.0, "C": 3.0, "B": 1.0}


@pytest.fixture
def problem(made: Made) -> WeakFormProblem:
    return WeakFormProblem.of(EXPONENTIAL, made("coulomb-viscous+stribeck", HIDDEN), TRUTH)


def test_a_fit_that_has_settled_is_not_repeated(problem: WeakFormProblem) -> None:
    for timing in (False, True):
        found = solve(problem, Plan(), timing=timing)
        assert found.solution.settled
        assert found.once_more(found.again, timing=timing).solution is found.solution
        anew = solve(problem, found.again, timing=timing)
        np.testing.assert_array_equal(anew.values, found.values)
        held = replace(found.again, held={"K_v": 0.5})
        assert found.once_more(held, timing=timing).solution is not found.solution


def test_rows_clear_of_some_samples_are_those_that_are_made_anew(problem: WeakFormProblem) -> None:
    found = solve(problem, Plan())  # by now the columns at some values of B are known
    samples = np.zeros(len(problem.recording), dtype=bool)
    samples[300:340] = True
    less = problem.clear_of(samples)
    anew = replace(problem, test_functions=problem.test_functions.clear_of(samples))
    assert 0 < less.rows < problem.rows
    for name in ("momentum", "driving", "target", "torque_rate", "sign_change"):
        np.testing.assert_array_equal(getattr(less, name), getattr(anew, name))
    fits = [solve(rows, found.again) for rows in (less, anew)]
    np.testing.assert_array_equal(fits[0].values, fits[1].values)


def test_rows_in_common_tell_where_others_would_begin(problem: WeakFormProblem) -> None:
    found = solve(problem, Plan())
    other = problem.clear_of(np.arange(len(problem.recording)) < 200)
    common = problem.test_functions.in_common(other.test_functions)
    np.testing.assert_array_equal(problem.target[common], other.target)
    assert begins_where(other, Plan(), found)
    elsewhere = replace(found, solution=replace(found.solution, start=np.array([17.0])))
    assert not begins_where(other, Plan(), elsewhere)


def test_no_variance_makes_a_shift_evident_that_could_not_be(problem: WeakFormProblem) -> None:
    found = solve(problem, Plan())
    interval = problem.recording.interval

    def shifted(samples: float, spread: float) -> Solved:
        theta = found.solution.theta.copy()
        theta[-1] = samples * interval
        other = replace(found, solution=replace(found.solution, theta=theta))
        place = len(theta) - 1
        variances = np.zeros((len(found.solution.jacobian),) * 2)
        variances[place, place] = (spread * interval) ** 2
        other.__dict__["spread"] = variances
        return other

    for samples in (-0.4, -0.1, 0.0, 0.05, 0.15, 0.2, 0.24, 0.5, 0.9):
        fits = [shifted(samples, spread) for spread in np.geomspace(1e-4, 10.0, 40).tolist()]
        evident = [fit for fit in fits if log_odds_of_a_shift(fit, reversals=False) > STRONG]
        assert could_be_shifted(fits[0]) or not evident
        if samples < 0.25:
            assert all(log_odds_of_held(fit, reversals=False) <= np.log(5.0) + 1e-9 for fit in fits)
            assert all(fitted_as_held(fit) is None for fit in fits)
    assert not could_be_shifted(shifted(0.0, 1.0))
    assert could_be_shifted(shifted(0.9, 1.0))


def test_only_cases_that_may_be_are_fitted(problem: WeakFormProblem) -> None:
    found = solve(problem, Plan())
    chosen = with_or_without_shift(found, found.again)
    weights = [weight for _, weight in chosen.others]
    assert all(weight > 1e-4 for weight in weights)
    assert sum(weights) < 1.0


def test_what_wanders_without_noise_is_told_from_noise(made: Made) -> None:
    rng = np.random.default_rng(0)
    noise = velocity_noise(made())
    margins = {}
    for name, series in {
        "noise": rng.standard_normal(20_000),
        "wandering": np.cumsum(rng.standard_normal(20_000)),
        "smooth": np.sin(np.arange(20_000) / 50.0),
    }.items():
        _, _, _, gain, more = wandering_level(series, noise)
        margins[name] = gain, more
    assert margins["noise"][0] < 0.1
    assert margins["wandering"] == (1.0, pytest.approx(4 / 3, rel=0.05))
    assert margins["smooth"] == (1.0, pytest.approx(4.0, rel=0.05))


def test_the_terms_of_a_model_that_remember_are_prepared_once(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is integrated alone, one after the other, for every trial of their parameters."""
    model = Model.parse("coulomb-viscous+presliding+frictional-lag+rising-stiction")
    values = {p.key: p.declared.initial for p in Drive(model).parameters}
    problem = WeakFormProblem.of(Drive(model), made(samples=2000), {**values, "J": 2.0, "K_v": 0.5, "K_c": 6.0})
    prepared: list[str] = []
    build = Memory.__init__

    def counted(self: Memory, model: Model, *rest: Any) -> None:
        prepared.append(model.name)
        build(self, model, *rest)

    monkeypatch.setattr(Memory, "__init__", counted)
    alone = [Model(model.law, [effect]) for effect in model.effects]
    for factor in (1.0, 1.1, 1.2):
        for one in alone:
            problem.states_of(one, [factor * p.declared.initial for p in one.parameters])
    assert len(prepared) == len(set(prepared)) == len(alone)


def test_of_a_function_the_first_rows_may_be_asked_for() -> None:
    x, y = casadi.SX.sym("x"), casadi.SX.sym("y")
    fall = casadi.exp(-x * y)
    function = ArrayFunction(casadi.Function("f", [x, y], [casadi.vertcat(fall, 0, -y * fall)]))
    values = np.linspace(0.0, 3.0, 100)
    given = function.given(None, values)
    whole = given(0.7)[0]
    np.testing.assert_array_equal(whole, [np.exp(-0.7 * values), np.zeros(100), -values * np.exp(-0.7 * values)])
    for first in (1, 2):
        np.testing.assert_array_equal(given(0.7, first=first)[0], whole[:first])
