"""Intervals by the distance to an unbiased fit: the half width, what it covers, and what has none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from fricmodels.drive import Drive
from fricmodels.estimator import Estimator, Solution
from fricmodels.interval import half_width
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate

TRUE = {"K_v": 1.0e-4, "K_c": 1.0e-2}
DRIVE = Drive(Model.parse("coulomb-viscous"), 4.87e-6)


def recording(seed: int, samples: int = 2000, noise: float = 2.0) -> Recording:
    time = 2 * np.pi / 39.54 / 200 * np.arange(samples)
    return simulate(DRIVE, TRUE, time, 0.03 * np.sin(39.54 * time), substeps=5, noise=noise, seed=seed)


class Off(Estimator):
    """Says the truth, but for the Coulomb friction, and a viscous one that is no number where it is asked to."""

    name = "off"
    coulomb = 1.0
    viscous = 1.0

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        return Solution({"K_v": self.viscous * TRUE["K_v"], "K_c": self.coulomb * TRUE["K_c"]})


@pytest.mark.parametrize("distance", [0.0, -0.3, 1.0, 5.0, 7.99, 8.01, -300.0])
def test_the_half_width_holds_95_percent(distance: float) -> None:
    spread = 0.2
    w = half_width(distance * spread, spread)
    assert ndtr((w - distance * spread) / spread) - ndtr((-w - distance * spread) / spread) == pytest.approx(0.95)
    assert w == half_width(-distance * spread, spread)


@pytest.mark.parametrize("coulomb", [1.0, 1.02, 0.5])
def test_an_estimate_that_is_off_has_an_interval_that_holds_the_truth(coulomb: float) -> None:
    """However far it is off; and a distance that is all bias is not made larger by half."""
    estimator = Off()
    estimator.coulomb = coulomb
    fits = [estimator.fit(DRIVE, recording(seed)) for seed in range(12)]
    off = abs(coulomb - 1) * TRUE["K_c"]
    covered = np.mean([off <= 1.96 * fit.standard_errors["K_c"] for fit in fits])
    assert covered >= 0.7, "0.95 less the binomial error of 12 recordings"
    if coulomb == 0.5:
        assert all(1.96 * fit.standard_errors["K_c"] == pytest.approx(off, rel=0.05) for fit in fits)


@pytest.mark.parametrize(("coulomb", "far"), [(1.0, False), (1.02, False), (1.2, True), (0.5, True)])
def test_what_is_certainly_far_from_least_squares_is_said_not_to_have_converged(coulomb: float, far: bool) -> None:
    estimator = Off()
    estimator.coulomb = coulomb
    fit = estimator.fit(DRIVE, recording(0))
    assert ("K_c" in fit.not_identified) is far
    if far:
        reason = fit.not_identified["K_c"]
        assert reason.startswith("not converged, or biased: least squares of the same equation give ")
        assert float(reason.split()[-1]) == pytest.approx(TRUE["K_c"], rel=0.01)
    assert "K_v" not in fit.not_identified


def test_the_covariance_is_one_of_its_standard_errors() -> None:
    fit = Off().fit(DRIVE, recording(0))
    assert np.sqrt(np.diag(fit.covariance)) == pytest.approx([fit.standard_errors[key] for key in fit.estimated])
    assert np.all(np.linalg.eigvalsh(fit.covariance / np.outer(*[np.sqrt(np.diag(fit.covariance))] * 2)) > 0)
    assert fit.identified


def test_what_cannot_be_checked_has_no_interval_and_a_reason() -> None:
    estimator = Off()
    estimator.viscous = float("nan")
    fit = estimator.fit(DRIVE, recording(0))
    assert set(fit.standard_errors) == {"K_c"}
    assert set(fit.no_interval) == {"K_v"}
    short = Off().fit(DRIVE, recording(0, samples=25))
    assert not short.standard_errors
    assert all("moves too little" in reason for reason in short.no_interval.values())


def test_what_nothing_determines_has_no_interval_of_zero() -> None:
    class Silent(Off):
        def solve(self, drive: Drive, recording: Recording, seed: int = 0) -> Solution:
            values = dict.fromkeys(drive.keys, 1.0)
            return Solution(values, np.diag([0.25, 0.0]), not_identified={"K_c": "it changes nothing"})

    fit = Silent().fit(DRIVE, recording(0))
    assert fit.standard_errors == {"K_v": 0.5}
    assert fit.no_interval == {"K_c": "it changes nothing"}


def test_names_time_and_provenance_are_the_base_class_s() -> None:
    made = recording(0)
    fit = Off().fit(DRIVE, made)
    assert (fit.model, fit.estimator, fit.dataset) == ("coulomb-viscous", "off", made.name)
    assert fit.parameters["J"] == DRIVE.inertia
    assert fit.provenance["recording"] == made.checksum
    assert fit.seconds > 0
