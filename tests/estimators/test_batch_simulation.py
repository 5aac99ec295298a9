"""The simulation-error fit: known truths, long records, failure as a status."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.batch import Batch
from fricmodels.drive import Drive
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate

TRUE = {"K_v1": 1.0e-4, "K_v2": 6.6e-5, "K_c1": 1.0e-2, "K_c2": 6.6e-3}
OMEGA = 39.54


def drive(inertia: float | None = 4.87e-6) -> Drive:
    return Drive(Model.parse("asymmetric-coulomb-viscous"), inertia)


def paper(cycles: int, noise: float = 0.0) -> Recording:
    time = 2 * np.pi / OMEGA / 200 * np.arange(200 * cycles)
    return simulate(drive(), TRUE, time, 0.03 * np.sin(OMEGA * time), substeps=10, noise=noise, seed=2)


def test_truth_is_found_without_noise(capfd: pytest.CaptureFixture[str]) -> None:
    fit = Batch({"objective": "simulation"}).fit(drive(), paper(5))
    assert fit.status is Status.OK
    for key, value in TRUE.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.0098)
    assert capfd.readouterr().out == ""


def test_noisy_truth_is_within_the_standard_errors() -> None:
    fit = Batch({"objective": "simulation"}).fit(drive(), paper(5, noise=5.0))
    for key, value in TRUE.items():
        assert abs(fit.parameters[key] - value) < 3.5 * fit.standard_errors[key]


def test_long_record_is_represented_by_pieces() -> None:
    fit = Batch({"objective": "simulation", "samples": 800}).fit(drive(), paper(10))
    assert "8 pieces of 100 samples" in fit.message
    assert fit.parameters["K_c1"] == pytest.approx(TRUE["K_c1"], rel=0.05)


def test_running_out_of_time_is_a_status() -> None:
    fit = Batch({"objective": "simulation", "max_seconds": 0.01}).fit(drive(), paper(5, noise=20.0))
    assert fit.status is Status.FAILED
    assert "IPOPT" in fit.message
