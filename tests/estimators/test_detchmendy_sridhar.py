"""The paper's filter: its equations, its published accuracy, sticking, invariances, standard errors."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from estimators.detchmendy_sridhar import DetchmendySridhar, detchmendy_sridhar_step
from fricmodels.dimension import Motion, Scales
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.filtering.covariance import pack, unpack
from fricmodels.filtering.normalisation import normalised_space
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.recording import Recording

TABLE_1 = {0.0: (1.175, 1.96), 0.05: (1.4275, 2.26), 0.10: (1.6475, 2.68), 0.20: (2.04, 3.45)}
"""Noise as printed → mean and largest of the four coefficient errors [%]."""


def errors(fit, true):
    return np.array([100 * abs(fit.parameters[key] / true[key] - 1) for key in true])


@pytest.mark.parametrize("curvature", [0.0, 0.2], ids=["linear h", "nonlinear h"])
def test_small_steps_tend_to_equations_12_and_14(paper: SimpleNamespace, curvature: float) -> None:
    drive = paper.drive("exponential-stick-slip")
    space = normalised_space(drive)
    space = replace(space, output=space.x[0] + curvature * space.x[0] ** 3)
    n, q, w = space.x.numel(), 0.8, 0.6
    x0 = np.array([1.5, 0.4, 1.3, 0.9, 0.7])
    p0 = 2.0 * np.eye(n) + 0.5
    observed, torque, end = 1.9, 2.5, 0.25
    known = space.values(Drive(drive.model, 1.0), Scales(), 1e-3)

    g = casadi.Function("g", [space.x, space.u, space.known], [space.rate, casadi.jacobian(space.rate, space.x)])

    def right(_: float, memory: np.ndarray) -> np.ndarray:
        x, p = memory[:n], unpack(memory[n:], n)
        rate, a = (np.array(part) for part in g(x, [torque, 0.0], known))
        v, h = x[0], np.zeros(n)
        h[0] = 1 + 3 * curvature * v**2
        residual = observed - v - curvature * v**3
        bracket = -q * np.outer(h, h)
        bracket[0, 0] += q * residual * 6 * curvature * v
        dx = rate[:, 0] + 2 * p @ h * q * residual
        dp = a @ p + p @ a.T + 2 * p @ bracket @ p + w * np.eye(n)
        return np.concatenate([dx, pack(dp)])

    exact = solve_ivp(right, (0, end), np.concatenate([x0, pack(p0)]), rtol=1e-10, atol=1e-12).y[:, -1]
    step = detchmendy_sridhar_step(space, drive)
    bounds = [*[-1e300] * (n - 1), *[1e300] * (n - 1)]
    distance = []
    for count in (400, 800):
        memory = np.concatenate([x0, pack(p0)])
        for _ in range(count):
            dr = end / count
            memory = np.array(step(memory, [dr, dr, observed, torque, 0.0], [*known, q, *[w] * n, *bounds])[0])[:, 0]
        distance.append(np.max(np.abs(memory - exact)))
    assert distance[1] < 0.01
    assert distance[1] / distance[0] == pytest.approx(0.5, abs=0.1), "first order in the step"


def test_noiseless_errors_are_at_or_below_table_1(paper: SimpleNamespace) -> None:
    found = errors(DetchmendySridhar().fit(paper.drive(), paper.recording()), paper.true)
    assert found.mean() <= TABLE_1[0.0][0]
    assert found.max() <= TABLE_1[0.0][1]


@pytest.mark.long
@pytest.mark.parametrize("printed", [0.05, 0.10, 0.20])
def test_noisy_errors_are_at_or_below_table_1(paper: SimpleNamespace, printed: float) -> None:
    """With the noise read as peak to peak (six standard deviations) over the velocity's amplitude."""
    deviation = printed * np.sqrt(2) / 6
    estimator = DetchmendySridhar()
    found = np.array(
        [errors(estimator.fit(paper.drive(), paper.recording(deviation, seed)), paper.true) for seed in range(20)]
    )
    assert np.median(found.mean(axis=1)) <= TABLE_1[printed][0]
    assert np.median(found.max(axis=1)) <= TABLE_1[printed][1]


@pytest.mark.parametrize(("slip", "rate"), [((0.005, 0.003), 0.5), ((0.007, 0.005), 0.1), ((0.01, 0.0066), 1.0)])
def test_the_full_law_explains_the_torque_to_the_papers_1_6_percent(paper, slip, rate) -> None:
    made = paper.recording(slip=slip, rate=(rate, rate))
    true = {**paper.true, "C_1": slip[0], "C_2": slip[1], "B_1": rate, "B_2": rate}
    drive = paper.drive("asymmetric-exponential-stick-slip")
    fit = DetchmendySridhar().fit(drive, made)
    last = made.select(made.time >= 8 * 2 * np.pi / paper.omega)
    error = drive.friction(last, fit.parameters) - drive.friction(last, true)
    assert np.sqrt(np.mean(error**2)) / paper.amplitude <= 0.016


def test_large_initial_covariances_do_not_overflow(paper: SimpleNamespace) -> None:
    fit = DetchmendySridhar({"initial_variance": 1e8}).fit(paper.drive(), paper.recording())
    assert fit.status is Status.OK
    assert errors(fit, paper.true).max() < 2.0


def test_standstill_does_not_bias_coulomb_friction(paper: SimpleNamespace) -> None:
    made = paper.recording(amplitude=0.014)
    assert np.mean(made.velocity == 0) > 0.15
    fit = DetchmendySridhar().fit(paper.drive(), made)
    off = {key for key, value in paper.true.items() if abs(fit.parameters[key] / value - 1.0) > 0.1}
    assert off.isdisjoint({"K_c1", "K_c2"})
    assert {key for key, reason in fit.not_identified.items() if reason.startswith("not converged")} == off
    assert set(fit.not_identified) == off
    assert fit.parameters["K_c1"] == pytest.approx(paper.true["K_c1"], rel=0.03)
    assert fit.parameters["K_c2"] == pytest.approx(paper.true["K_c2"], rel=0.03)


def test_at_low_amplitude_viscous_friction_is_said_not_to_be_identified(paper: SimpleNamespace) -> None:
    """Fig. 10 of the paper: at little more than the stick torque only K_c is identifiable."""
    made = paper.recording(amplitude=0.0112)
    assert np.mean(made.velocity == 0) > 0.25
    fit = DetchmendySridhar().fit(paper.drive(), made)
    assert set(fit.not_identified) == {"K_v1"}
    assert not fit.identified
    assert fit.parameters["K_c1"] == pytest.approx(paper.true["K_c1"], rel=0.1)


@pytest.mark.parametrize("model", ["square-root", "two-thirds-power", "exponential-stick-slip"])
def test_every_law_stays_finite_on_a_drive_that_sticks(paper: SimpleNamespace, model: str) -> None:
    fit = DetchmendySridhar().fit(paper.drive(model), paper.recording(amplitude=0.012))
    assert fit.status is Status.OK
    assert np.all(np.isfinite(fit.history.to_numpy()))


def test_a_diverging_run_says_at_which_sample(paper: SimpleNamespace) -> None:
    made = paper.recording()
    velocity = made.velocity.copy()
    velocity[500] = 1e150
    fit = DetchmendySridhar({"bounds": False}).fit(paper.drive(), made.with_channels(velocity=velocity))
    assert fit.status is Status.DIVERGED
    assert "at sample 50" in fit.message
    assert np.isnan(fit.parameters["K_v1"])
    assert len(fit.history) in (500, 501, 502)


def test_the_reversed_drive_has_its_coefficients_exchanged(paper: SimpleNamespace) -> None:
    made = paper.recording(0.02)
    turned = made.with_channels(velocity=-made.velocity, torque=-made.torque)
    fit, other = (DetchmendySridhar().fit(paper.drive(), r).parameters for r in (made, turned))
    for one, two in (("K_v1", "K_v2"), ("K_c1", "K_c2")):
        assert other[two] == pytest.approx(fit[one], rel=1e-9)
        assert other[one] == pytest.approx(fit[two], rel=1e-9)


@settings(max_examples=8, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-2, 2), st.floats(-100, 100))
def test_units_and_start_time_do_not_matter(force, displacement, time, start) -> None:
    force, displacement, time = 10.0**force, 10.0**displacement, 10.0**time
    clock = np.arange(600) * 0.01
    velocity = 2 * np.sin(2 * np.pi * clock) + 0.3 * np.sin(9.1 * clock)
    torque = np.gradient(velocity, clock) + 1.5 * np.sign(velocity) + 0.5 * velocity
    run = np.zeros(600, dtype=np.int64)
    base = Recording("a", Motion.ROTARY, {"time": clock, "torque": torque, "velocity": velocity}, run)
    channels = {
        "time": clock * time + start,
        "torque": torque * force,
        "velocity": velocity * displacement / time,
    }
    model = Model.parse("coulomb-viscous")
    one = DetchmendySridhar().fit(Drive(model, 1.0), base).parameters
    inertia = force / displacement * time**2
    two = DetchmendySridhar().fit(Drive(model, inertia), Recording("b", Motion.ROTARY, channels, run)).parameters
    assert two["K_c"] == pytest.approx(one["K_c"] * force, rel=1e-5)
    assert two["K_v"] == pytest.approx(one["K_v"] * force * time / displacement, rel=1e-5)


@pytest.mark.parametrize(
    "cycles", [pytest.param(2, id="not converged"), pytest.param(20, id="converged", marks=pytest.mark.long)]
)
def test_intervals_hold_the_truth(paper: SimpleNamespace, cycles: int) -> None:
    """However far the filter still is from its limit; nor are they three times as wide as they need be."""
    errors, claimed = [], []
    for seed in range(20):
        fit = DetchmendySridhar().fit(paper.drive(), paper.recording(0.05, seed, cycles=cycles))
        errors.append([fit.parameters[key] - value for key, value in paper.true.items()])
        claimed.append([fit.standard_errors[key] for key in paper.true])
    covered = np.mean(np.abs(errors) <= 1.96 * np.array(claimed), axis=0)
    assert np.all(covered >= 0.8), "0.9, less the binomial error of 20 recordings"
    assert np.all(np.mean(claimed, axis=0) < 3 * np.sqrt(np.mean(np.square(errors), axis=0)))


def test_an_unknown_inertia_is_estimated(paper: SimpleNamespace) -> None:
    fit = DetchmendySridhar().fit(paper.drive(inertia=None), paper.recording(0.01))
    assert fit.estimated[0] == "J"
    assert fit.parameters["J"] == pytest.approx(paper.inertia, rel=0.02)


def test_a_given_inertia_is_reported(paper: SimpleNamespace) -> None:
    fit = DetchmendySridhar().fit(paper.drive(), paper.recording())
    assert fit.parameters["J"] == paper.inertia
    assert "J" not in fit.estimated


def test_nothing_connects_two_runs(paper: SimpleNamespace) -> None:
    made = paper.recording(0.01, cycles=12)
    half = len(made) // 2
    run = (np.arange(len(made)) >= half).astype(np.int64)
    time = np.where(run == 1, made.time - made.time[half], made.time)
    fit = DetchmendySridhar().fit(paper.drive(), replace(made, run=run).with_channels(time=time))
    assert errors(fit, paper.true).max() < 4.0


@pytest.mark.parametrize("channel", ["velocity", "torque"])
def test_nothing_to_identify_is_said(paper: SimpleNamespace, channel: str) -> None:
    made = paper.recording()
    with pytest.raises(EstimationError, match=channel):
        DetchmendySridhar().fit(paper.drive(), made.with_channels(**{channel: np.zeros(len(made))}))
