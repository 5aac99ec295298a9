"""The unscented filter: its exam, the linear limit, known truths beside the extended filter, divergence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fricmodels_ukf import UnscentedKalman

from estimators.ekf import ExtendedKalman
from fricmodels import Law, Parameter
from fricmodels.drive import Drive
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.testing import EstimatorExam
from fricmodels.tournament import load_config, run

INERTIA, FREQUENCY = 4.87e-6, 39.54
TRUE = {"K_v1": 1.0e-4, "K_v2": 6.6e-5, "K_c1": 1.0e-2, "K_c2": 6.6e-3}
"""Elhami and Brookfield (1997)."""


class TestExam(EstimatorExam):
    """The exam of estimators."""

    estimator = UnscentedKalman

    # A filter that steps in Python takes long: shorter recordings are below, fewer in test_standard_errors_….
    @pytest.mark.long
    def test_coverage(self) -> None:
        """Of forty recordings."""
        super().test_coverage()

    @pytest.mark.long
    def test_terms_with_memory(self) -> None:
        """Over the whole recording."""
        super().test_terms_with_memory()

    @pytest.mark.long
    def test_failure_is_reported(self) -> None:
        """Of whole recordings."""
        super().test_failure_is_reported()


class ShortExam(EstimatorExam):
    """The exam on the first two cycles."""

    estimator = UnscentedKalman

    def recording(self, noise_percent: float = 0.0, seed: int = 0) -> Recording:
        """Return 400 samples."""
        return super().recording(noise_percent, seed).select(np.arange(400))


@pytest.mark.parametrize("check", ["test_terms_with_memory", "test_failure_is_reported"])
def test_exam_of_a_short_recording(check: str) -> None:
    """The checks that take long, quickly."""
    getattr(ShortExam(), check)()


def paper(noise: float = 0.0, seed: int = 0, amplitude: float = 0.028, cycles: int = 10) -> Recording:
    """Return the paper's drive, 200 samples a cycle; ``noise`` in % of the RMS velocity."""
    time = 2 * np.pi / FREQUENCY / 200 * np.arange(200 * cycles)
    torque = amplitude * np.sin(FREQUENCY * time)
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), INERTIA)
    return simulate(drive, TRUE, time, torque, substeps=5, noise=noise, seed=seed)


class Constant(Law):
    """A torque that nothing changes, which makes the drive linear."""

    name = "constant"
    formula = "τ_F = c"
    c = Parameter("c", unit="N m", meaning="torque")

    def torque(self, s: Any, p: Any) -> Any:
        """Return c."""
        return p.c


@pytest.mark.parametrize("settings", [{}, {"alpha": 0.1}, {"kappa": 2.0, "beta": 0.0}])
def test_on_a_linear_drive_it_is_the_kalman_filter(settings: Mapping[str, float]) -> None:
    """There the extended filter is the Kalman filter, and both agree to rounding at every sample."""
    drive = Drive(Model(Constant()), 0.02)
    time = 1e-2 * np.arange(600)
    made = simulate(drive, {"c": 0.3}, time, 0.3 + np.sin(3 * time), substeps=2, noise=3.0, seed=1)
    given = {"velocity_noise": 1.0, "model_noise": 0.05, "substeps": 2}
    one = ExtendedKalman(given).fit(drive, made)
    two = UnscentedKalman({**given, **settings}).fit(drive, made)
    for column in one.history:
        reference = one.history[column].to_numpy()
        np.testing.assert_allclose(two.history[column], reference, rtol=0, atol=1e-9 * np.max(np.abs(reference)))
    np.testing.assert_allclose(two.covariance, one.covariance, rtol=1e-8)
    assert one.parameters["c"] == pytest.approx(0.3, abs=4 * one.standard_errors["c"])


@pytest.mark.long
def test_table_1_of_the_paper_beside_the_extended_filter() -> None:
    """No level of noise makes it worse than twice the published errors of the coefficients."""
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), INERTIA)
    for noise, published in ((0.0, 1.96), (10 / 6, 2.68)):
        errors = []
        for seed in range(3 if noise else 1):
            made = paper(noise, seed)
            pair = [estimator().fit(drive, made) for estimator in (ExtendedKalman, UnscentedKalman)]
            errors.append([[100 * abs(fit.parameters[key] / TRUE[key] - 1) for key in TRUE] for fit in pair])
        extended, unscented = np.median(errors, axis=0)
        assert max(unscented) < published
        assert np.mean(unscented) < np.mean(extended) + 0.5


@pytest.mark.long
def test_standard_errors_cover_the_errors() -> None:
    """Of four coefficients in four recordings."""
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), INERTIA)
    ratios = []
    for seed in range(4):
        fit = UnscentedKalman().fit(drive, paper(5.0, seed))
        ratios.append([(fit.parameters[key] - TRUE[key]) / fit.standard_errors[key] for key in TRUE])
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.5


def test_inertia_sub_steps_and_runs() -> None:
    """All at once."""
    made = paper(1.0, cycles=4)
    made = Recording("two runs", made.motion, made.channels, (np.arange(len(made)) >= 350).astype(np.int64))
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), None)
    fit = UnscentedKalman({"substeps": 3}).fit(drive, made)
    assert fit.status is Status.OK
    assert fit.parameters["J"] == pytest.approx(INERTIA, rel=0.05)
    for key, value in TRUE.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.1)


def test_a_drive_that_mostly_sticks_stays_finite() -> None:
    """Its velocity has no variance while every sigma point sticks."""
    drive = Drive(Model.parse("coulomb-viscous"), INERTIA)
    fit = UnscentedKalman().fit(drive, paper(amplitude=0.0102))
    assert fit.status is Status.OK
    assert np.all(np.isfinite(fit.history.to_numpy()))


def test_divergence_names_the_sample() -> None:
    """A velocity beyond all others ends the filter where it stands."""
    made = paper(1.0)
    spoilt = made.velocity.copy()
    spoilt[1000] = 1e150
    drive = Drive(Model.parse("coulomb-viscous"), INERTIA)
    fit = UnscentedKalman({"substeps": 1}).fit(drive, made.with_channels(velocity=spoilt))
    assert fit.status is Status.DIVERGED
    assert "at sample 100" in fit.message
    assert np.all(np.isnan([fit.parameters["K_v"], fit.parameters["K_c"]]))
    assert len(fit.history) in (1001, 1002, 1003)


@pytest.mark.long
def test_the_tournament_beside_this_project(tmp_path: Path) -> None:
    """Both filters end well at every level of noise, with the same torque error."""
    file = Path(__file__).parents[1] / "tournament.yaml"
    short = tmp_path / "tournament.yaml"
    short.write_text(file.read_text(encoding="utf-8").replace("seeds: 9", "seeds: 1"))
    board = run(load_config(short), tmp_path / "out", executor="serial")
    assert [row["status"] for row in board.rows] == ["ok"] * 8, [row["message"] for row in board.rows]
    errors = {(row["estimator"], row["tags"]["noise_percent"]): row["rms_torque_error_percent"] for row in board.rows}
    for (estimator, level), error in errors.items():
        assert error == pytest.approx(errors["ekf", level], rel=0.1), estimator
