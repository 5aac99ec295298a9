"""Effects with internal states: the batch estimator finds what a simulation of the same model was given."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.batch import Batch
from fricmodels.drive import Drive
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.simulation import simulate

INERTIA = 4.5
LAW = {"K_v": 1.7, "K_c": 6.5}
EFFECTS = {
    "presliding": {"F_1": 6.0, "F_2": 6.0, "D": 5.0, "x_s": 0.08},
    "backlash": {"J_l": 2.0, "w": 0.03, "a": 1.5, "omega_v": 3.0, "F": 3.0, "b": 0.2},
    "frictional-lag": {"F_s": 4.0, "K": 1.0, "omega_s": 0.4, "T": 0.1},
    "rising-stiction": {"F": 6.0, "T": 1.0, "x_s": 0.1},
    "joint-compliance": {"J_l": 2.0, "omega_n": 9.0, "zeta": 0.05},
}


@pytest.mark.parametrize("noise", [0.0, 0.1])
@pytest.mark.parametrize("effect", EFFECTS)
def test_effect_with_memory(effect: str, noise: float) -> None:
    time = 2e-3 * np.arange(10_000)
    torque = 20 * np.sin(2.1 * time) + 12 * np.sin(0.9 * time + 1) + 6 * np.sin(7.3 * time)
    if effect == "rising-stiction":
        torque *= np.sin(2 * np.pi * time / 8) ** 2 + 0.1
    truth = {**LAW, **{f"{effect}.{symbol}": value for symbol, value in EFFECTS[effect].items()}}
    drive = Drive(Model.parse(f"coulomb-viscous+{effect}"), INERTIA)
    load = 4 * np.sin(1.3 * time) if effect == "backlash" else None
    recording = simulate(drive, truth, time, torque, load_torque=load, substeps=4, noise=noise, with_position=True)
    plain = Batch().fit(Drive(Model.parse("coulomb-viscous"), INERTIA), recording)
    fit = Batch().fit(drive, recording)
    assert fit.status is Status.OK
    assert not fit.not_identified
    found = np.array([fit.parameters[key] / value for key, value in truth.items()])
    coasting = {f"backlash.{symbol}" for symbol in ("a", "omega_v", "F", "b")}  # seen only while the load is left alone
    within = np.array([0.25 if key in coasting else 0.08 for key in truth])
    assert np.all(np.abs(found - 1.0) < within), dict(zip(truth, found, strict=True))
    if not noise:
        most = 0.35 if effect == "backlash" else 0.2  # a blow falls between two samples
        assert fit.provenance["relative_error"] < most * plain.provenance["relative_error"]
