"""The extended Kalman filter: filterpy and its twin, recovery, calibrated standard errors."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from estimators.ekf import ExtendedKalman
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.recording import Recording

LAWS = [
    "coulomb-viscous",
    "asymmetric-coulomb-viscous",
    "exponential-stick-slip",
    "asymmetric-exponential-stick-slip",
    "square-root",
    "two-thirds-power",
]


@pytest.mark.parametrize("model", LAWS)
@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_the_twin_equals_filterpy(paper: SimpleNamespace, model: str, noise: float) -> None:
    made = paper.recording(noise, 3, cycles=2)
    drive = paper.drive(model)
    one, two = (ExtendedKalman({"engine": engine}).fit(drive, made) for engine in ("filterpy", "compiled"))
    for column in one.history:
        reference = one.history[column].to_numpy()
        np.testing.assert_allclose(two.history[column], reference, rtol=0, atol=1e-9 * np.max(np.abs(reference)))
    np.testing.assert_allclose(two.covariance, one.covariance, rtol=1e-9, atol=1e-9 * np.nanmax(one.covariance))


def test_the_twin_equals_filterpy_with_sub_steps_inertia_and_runs(paper: SimpleNamespace) -> None:
    made = paper.recording(0.02, 1, cycles=3)
    run = (np.arange(len(made)) >= 250).astype(np.int64)
    made = Recording("two runs", made.motion, made.channels, run)
    drive = paper.drive(inertia=None)
    one, two = (
        ExtendedKalman({"engine": engine, "substeps": 3}).fit(drive, made) for engine in ("filterpy", "compiled")
    )
    for key, value in one.parameters.items():
        assert two.parameters[key] == pytest.approx(value, rel=1e-9)


def test_a_noiseless_drive_is_recovered(paper: SimpleNamespace) -> None:
    fit = ExtendedKalman().fit(paper.drive(inertia=None), paper.recording())
    assert fit.parameters["J"] == pytest.approx(paper.inertia, rel=5e-3)
    for key, value in paper.true.items():
        assert fit.parameters[key] == pytest.approx(value, rel=5e-3)


def test_standard_errors_cover_the_errors(paper: SimpleNamespace) -> None:
    ratios = []
    for seed in range(20):
        fit = ExtendedKalman().fit(paper.drive(), paper.recording(0.05, seed))
        ratios.append([(fit.parameters[key] - paper.true[key]) / fit.standard_errors[key] for key in paper.true])
    assert 0.6 < np.sqrt(np.mean(np.square(ratios))) < 1.5


def test_the_noise_is_found(paper: SimpleNamespace) -> None:
    made = paper.recording(0.05)
    true = 0.05 * np.sqrt(np.mean(paper.recording().velocity ** 2))
    noise = ExtendedKalman().fit(paper.drive(), made).provenance["noise"]
    assert noise["velocity"] == pytest.approx(true, rel=0.2)


def test_a_wrong_law_widens_the_standard_errors(paper: SimpleNamespace) -> None:
    settings = {"model_noise": 0.0, "velocity_noise": 0.8}
    right = ExtendedKalman(settings).fit(paper.drive(), paper.recording(0.01))
    wrong = ExtendedKalman(settings).fit(paper.drive("coulomb-viscous"), paper.recording(0.01))
    assert wrong.standard_errors["K_c"] > 3 * right.standard_errors["K_c1"]


def test_a_drive_that_hardly_moves_identifies_only_coulomb_friction(paper: SimpleNamespace) -> None:
    made = paper.recording(amplitude=0.0102)
    noisy = made.velocity + np.random.default_rng(0).standard_normal(len(made))
    fit = ExtendedKalman().fit(paper.drive("coulomb-viscous"), made.with_channels(velocity=noisy))
    assert "K_c" not in fit.not_identified


@pytest.mark.parametrize("model", LAWS)
def test_a_sticking_drive_stays_finite(paper: SimpleNamespace, model: str) -> None:
    fit = ExtendedKalman().fit(paper.drive(model), paper.recording(amplitude=0.012))
    assert fit.status is Status.OK
    assert np.all(np.isfinite(fit.history.to_numpy()))


def test_a_term_with_memory_and_a_position_is_carried() -> None:
    """Gravity and presliding on a joint, made with one's own fine steps."""
    inertia, viscous, coulomb, reach, weight = 0.02, 0.05, 0.4, 0.02, 0.6
    step, parts, count = 2e-3, 40, 4000
    position = velocity = deflection = 0.0
    rows = []
    for i in range(count):
        torque = 2.0 * np.sin(2 * np.pi * 0.7 * i * step) + 0.8 * np.sin(2 * np.pi * 1.9 * i * step)
        rows.append((i * step, torque, velocity, position))
        for _ in range(parts):
            h = step / parts
            friction = viscous * velocity + coulomb * deflection + weight * np.sin(position)
            velocity += h * (torque - friction) / inertia
            deflection += h * (velocity - abs(velocity) * deflection) / reach
            position += h * velocity
    time, torque, speed, angle = np.array(rows).T
    channels = {"time": time, "torque": torque, "velocity": speed, "position": angle}
    made = Recording("joint", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))
    drive = Drive(Model.parse("coulomb-viscous+gravity+presliding"), inertia)
    fit = ExtendedKalman({"torque": "held"}).fit(drive, made)
    assert fit.status is Status.OK
    assert fit.parameters["K_v"] == pytest.approx(viscous, rel=0.1)
    assert fit.parameters["K_c"] == pytest.approx(coulomb, rel=0.1)
