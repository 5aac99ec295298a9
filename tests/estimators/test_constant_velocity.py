"""The constant-velocity method: plateaus, the modified method, and recordings that have neither."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from estimators.constant_velocity import ConstantVelocity, clustered_least_squares, made_by_noise
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.recording import Recording

LAW = {"K_v1": 0.2, "K_v2": 0.15, "K_c1": 1.0, "K_c2": 0.8}
INERTIA = 0.05


def moves(speeds: list[float], noise: float = 0.0, seed: int = 0, ramp: float = 0.2, hold: float = 0.5) -> Recording:
    """Trapezoidal speed moves: up to each speed, hold it, back to rest."""
    corners, values, now = [0.0], [0.0], 0.0
    for speed in speeds:
        for duration, value in ((ramp, speed), (hold, speed), (ramp, 0.0), (0.1, 0.0)):
            now += duration
            corners.append(now)
            values.append(value)
    time = np.arange(0.0, now, 0.002)
    velocity = np.interp(time, corners, values)
    acceleration = np.gradient(velocity, time)
    friction = np.where(velocity > 0, LAW["K_v1"] * velocity + LAW["K_c1"], LAW["K_v2"] * velocity - LAW["K_c2"])
    torque = INERTIA * acceleration + np.where(velocity == 0, 0.0, friction)
    noisy = torque + noise * np.random.default_rng(seed).standard_normal(len(time))
    channels = {"time": time, "torque": noisy, "velocity": velocity}
    return Recording("moves", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


SPEEDS = [2.0, -2.0, 5.0, -5.0, 9.0, -9.0, 14.0, -14.0]


@pytest.mark.parametrize("inertia", [INERTIA, None], ids=["inertia given", "inertia estimated"])
def test_plateaus_give_the_law(inertia: float | None) -> None:
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), inertia)
    fit = ConstantVelocity().fit(drive, moves(SPEEDS, noise=0.02))
    assert fit.status is Status.OK
    assert "plateaus" in fit.message
    for key, value in LAW.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.02)
    assert fit.parameters["J"] == pytest.approx(INERTIA, rel=0.05)


def test_standard_errors_cover_the_errors() -> None:
    drive = Drive(Model.parse("coulomb-viscous"), INERTIA)
    speeds = [*SPEEDS, 3.0, -3.0, 7.0, -7.0, 11.0, -11.0]
    symmetric = [moves(speeds, 0.3, seed) for seed in range(20)]
    fits = [ConstantVelocity().fit(drive, made) for made in symmetric]
    assert all(fit.standard_errors["K_c"] > 0 for fit in fits)
    scatter = np.std([fit.parameters["K_c"] for fit in fits], ddof=1)
    assert np.mean([fit.standard_errors["K_c"] for fit in fits]) > 0.5 * scatter


def test_a_swept_sine_is_judged_at_its_peaks(paper: SimpleNamespace) -> None:
    """The modified method needs peaks of different speeds: amplitudes that differ from run to run."""
    runs = [paper.recording(amplitude=a) for a in (0.014, 0.018, 0.022, 0.026, 0.03)]
    channels = {name: np.concatenate([r.channels[name] for r in runs]) for name in runs[0].channels}
    made = Recording("sweep", Motion.ROTARY, channels, np.repeat(np.arange(len(runs)), [len(r) for r in runs]))
    fit = ConstantVelocity().fit(paper.drive(), made)
    assert fit.status is Status.OK
    assert "near-zero acceleration" in fit.message
    for key, value in paper.true.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.1)


def test_one_sine_cannot_separate_the_coefficients(paper: SimpleNamespace) -> None:
    fit = ConstantVelocity().fit(paper.drive(), paper.recording(cycles=30).select(np.arange(4000, 6000)))
    assert fit.status is Status.FAILED or fit.not_identified
    assert fit.parameters["J"] == paper.inertia


def test_speeds_that_differ_by_noise_alone_have_no_interval(paper: SimpleNamespace) -> None:
    """The peaks of one sine: what seems to be a slope is made by noise, and no scatter shows how far it is off."""
    fit = ConstantVelocity().fit(paper.drive(), paper.recording(noise=2.0))
    assert fit.status is Status.FAILED or set(fit.no_interval) == set(paper.true)
    assert not fit.standard_errors


def test_how_much_of_a_column_noise_makes() -> None:
    rng = np.random.default_rng(2)
    speed, noise = rng.uniform(1.0, 5.0, 4000), 0.5 * rng.standard_normal(4000)
    columns, changed = np.stack([speed + noise, np.ones(4000)]), np.stack([noise, np.zeros(4000)])
    assert made_by_noise(columns, changed)[0] == pytest.approx(0.25 / (16 / 12 + 0.25), rel=0.1)


def test_too_few_plateaus_fail_with_the_number() -> None:
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), INERTIA)
    fit = ConstantVelocity().fit(drive, moves([5.0, -5.0]))
    assert fit.status is Status.FAILED
    assert "needed" in fit.message or "separate" in fit.message


def test_memory_terms_are_refused(paper: SimpleNamespace) -> None:
    with pytest.raises(EstimationError, match="internal states"):
        ConstantVelocity().fit(paper.drive("coulomb-viscous+presliding"), paper.recording())


def test_clusters_count_as_one_observation_each() -> None:
    rng = np.random.default_rng(1)
    cluster = np.repeat(np.arange(40), 25)
    speed = np.repeat(rng.uniform(1, 5, 40), 25)
    error = np.repeat(rng.standard_normal(40), 25)
    columns = np.stack([speed, np.ones_like(speed)])
    _, covariance, _ = clustered_least_squares(columns, 2 * speed + 1 + error, cluster)
    means = np.stack([speed[::25], np.ones(40)])
    expected = np.linalg.inv(means @ means.T)
    np.testing.assert_allclose(np.diag(covariance), np.diag(expected), rtol=0.6)
