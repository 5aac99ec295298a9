"""Effects with internal states: the batch estimator finds what a simulation of the same model was given."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.batch import Batch
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.fit import Status
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate

INERTIA = 4.5
LAW = {"K_v": 1.7, "K_c": 6.5}
EFFECTS = {
    "presliding": {"F_1": 6.0, "F_2": 6.0, "D": 5.0, "x_s": 0.08},
    "backlash": {"J_l": 2.0, "w": 0.03, "a": 1.5, "omega_v": 3.0, "F": 3.0, "b": 0.2},
    "frictional-lag": {"F_s": 4.0, "K": 1.0, "omega_s": 0.4, "T": 0.1, "r": 0.5},
    "rising-stiction": {"F": 6.0, "T": 1.0, "x_s": 0.1},
    "joint-compliance": {"J_l": 2.0, "omega_n": 9.0, "zeta": 0.05},
}


LONGER = [("backlash", 0.0), ("backlash", 0.1), ("frictional-lag", 0.1), ("joint-compliance", 0.1)]
"""An effect and a noise."""


@pytest.mark.parametrize(
    ("effect", "noise"),
    [
        pytest.param(effect, noise, marks=pytest.mark.long if (effect, noise) in LONGER else ())
        for noise in (0.0, 0.1)
        for effect in EFFECTS
    ],
)
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
        assert fit.provenance["relative_error"] < 0.2 * plain.provenance["relative_error"]


@pytest.mark.long
@pytest.mark.parametrize("r", [0.0, 1.0])
def test_a_lag_of_exactly_so_long_is_found(r: float) -> None:
    """A pure delay, or a lag of the first order: simulated by itself, where the model's rates only approximate it."""
    step, substeps, delay, inertia = 2e-3, 4, 0.15, INERTIA
    values = LAW | {f"frictional-lag.{key}": value for key, value in EFFECTS["frictional-lag"].items()}
    values["frictional-lag.T"] = delay
    fine, late = step / substeps, round(delay / step * substeps)
    time = step * np.arange(10_000)
    instants = fine * np.arange(substeps * len(time))
    torque = 20 * np.sin(2.1 * instants) + 12 * np.sin(0.9 * instants + 1) + 6 * np.sin(7.3 * instants)
    speed, followed = [0.0] * len(instants), 0.0
    falling, viscous, scale = (values[f"frictional-lag.{key}"] for key in ("F_s", "K", "omega_s"))
    for i, driving in enumerate(torque[:-1].tolist()):
        now, then = abs(speed[i]), abs(speed[max(i - late, 0)])
        if r == 1.0:
            followed += (1 - np.exp(-fine / delay)) * (now - followed)
            then = followed
        dry = LAW["K_c"] + falling * np.exp(-then / scale) + viscous * (then - now)
        free = (speed[i] + fine / inertia * driving) / (1 + fine / inertia * LAW["K_v"])
        speed[i + 1] = float(np.sign(free) * max(abs(free) - fine / inertia * dry, 0.0))  # dry friction only brakes
    velocity = np.array(speed[::substeps])
    channels = {"time": time, "torque": torque[::substeps], "velocity": velocity}
    recording = Recording("lag", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    plain = Batch().fit(Drive(Model.parse("coulomb-viscous"), inertia), recording)
    fit = Batch().fit(Drive(Model.parse("coulomb-viscous+frictional-lag"), inertia), recording)
    for key, value in (values | {"frictional-lag.r": r}).items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.08, abs=0.05), key
    assert fit.provenance["relative_error"] < 0.1 * plain.provenance["relative_error"]


@pytest.mark.long
def test_a_gap_is_found_in_a_fast_recording() -> None:
    """Through test functions of a few milliseconds the error has many minima, far from the truth."""
    time = 1e-3 * np.arange(20_000)
    torque = 20 * np.sin(2.1 * time) + 12 * np.sin(0.9 * time + 1) + 6 * np.sin(7.3 * time)
    truth = {**LAW, **{f"backlash.{symbol}": value for symbol, value in EFFECTS["backlash"].items()}}
    drive = Drive(Model.parse("coulomb-viscous+backlash"), INERTIA)
    load = 4 * np.sin(1.3 * time)
    recording = simulate(drive, truth, time, torque, load_torque=load, substeps=4, noise=0.1, with_position=True)
    fit = Batch().fit(drive, recording)
    np.testing.assert_allclose([fit.parameters[key] for key in truth], list(truth.values()), rtol=0.08)


def test_an_effect_with_memory_beside_a_periodic_one() -> None:
    """A wave number has no place in a search by ratios; it comes from the spectrum of what the others leave."""
    time = 2e-3 * np.arange(10_000)
    torque = 20 * np.sin(2.1 * time) + 12 * np.sin(0.9 * time + 1) + 6 * np.sin(7.3 * time)
    truth = LAW | {"presliding.F_1": 5.0, "presliding.F_2": 6.0, "presliding.D": 0.0, "presliding.x_s": 0.08}
    wave = {"cogging.a": 2.0, "cogging.b": -1.0, "cogging.a_2": 0.0, "cogging.b_2": 0.0, "cogging.k": 7.3}
    drive = Drive(Model.parse("coulomb-viscous+presliding+cogging"), INERTIA)
    recording = simulate(drive, truth | wave, time, torque, substeps=4, noise=0.1, with_position=True)
    fit = Batch().fit(drive, recording)
    assert fit.parameters["cogging.k"] == pytest.approx(7.3, rel=2e-3)
    for key in ("K_v", "K_c", "presliding.F_1", "presliding.F_2", "presliding.x_s", "cogging.a", "cogging.b"):
        assert fit.parameters[key] == pytest.approx((truth | wave)[key], rel=0.1), key
