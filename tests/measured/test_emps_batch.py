"""The published reference of the EMPS axis, reproduced: filtered derivatives, decimated (IDIM-LS), and weak form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from estimators.batch import Batch
from estimators.batch.derivative_form import derivative_equations
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.signals import Preparation

FOLDER = Path(__file__).parents[2].parent / "shared" / "data" / "emps"
REFERENCE = {"M": 95.1089, "K_v": 203.5034, "K_c": 20.3935, "torque-offset.tau_0": -3.1648}
ASYMMETRIC = {"M": 95.1540, "K_v1": 166.7061, "K_c1": 20.1440, "K_v2": 240.4236, "K_c2": 20.6277}
RECIPE = Preparation(method="butterworth", cutoff=100.0, decimate=10)

pytestmark = [
    pytest.mark.measured,
    pytest.mark.skipif(not FOLDER.exists(), reason="the folder of real measurements is not beside the project"),
]


def emps(name: str) -> Recording:
    columns = {"time": "t", "torque": "force_N", "position": "pos_m"}
    return read(FOLDER / f"{name}.csv", columns=columns, motion=Motion.LINEAR)


def axis(name: str) -> Drive:
    return Drive(Model.parse(name), motion=Motion.LINEAR)


@pytest.mark.parametrize("settings", [{}, {"form": "derivative"}])
def test_symmetric_law_with_offset(settings: dict[str, str]) -> None:
    fit = Batch(settings).fit(axis("coulomb-viscous+torque-offset"), emps("emps_id"))
    for key, value in REFERENCE.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.02)
    assert fit.provenance["relative_error"] <= 0.0408


def test_asymmetric_law() -> None:
    fit = Batch({"form": "derivative"}).fit(axis("asymmetric-coulomb-viscous"), emps("emps_id"))
    for key, value in ASYMMETRIC.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.02)
    assert fit.provenance["relative_error"] <= 0.0311


def test_cross_test_on_pulses() -> None:
    drive = axis("coulomb-viscous+torque-offset")
    fit = Batch({"form": "derivative"}).fit(drive, emps("emps_id"))
    equations, _ = derivative_equations(drive, emps("emps_pulses"), RECIPE)
    assert equations.acceleration is not None
    predicted = fit.parameters["M"] * equations.acceleration
    for row, values in zip(equations.separable.fixed, equations.fixed, strict=True):
        if row < len(equations.separable.linear):
            predicted = predicted + fit.parameters[drive.model.parameters[equations.separable.linear[row]].key] * values
    error = np.linalg.norm(predicted - equations.driving) / np.linalg.norm(equations.driving)
    assert error <= 0.0598
