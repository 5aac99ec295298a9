"""Drives that coast: known truths in closed form, what errors are told in percent of, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from estimators.batch import Batch
from fricmodels import read, sums
from fricmodels.diagnosis import compare, improve
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError, InputError
from fricmodels.logcheck import findings
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals.coasting import coasting
from fricmodels.simulation import simulate

J, K_V, K_C = 0.012, 0.0009, 0.15
STEP, NOISE = 2e-3, 0.05


def velocity_after(start: float, time: np.ndarray) -> np.ndarray:
    """ω(t) of J dω/dt = −K_v ω − K_c sgn ω, until it stands still."""
    falling = (abs(start) + K_C / K_V) * np.exp(-K_V * time / J) - K_C / K_V
    return np.sign(start) * np.maximum(falling, 0.0)


def spindle(seed: int = 0, size: float = 1.0, starts: tuple[float, ...] = (300.0, -250.0, 150.0, -120.0)) -> Recording:
    """Return runs of a spindle that coasts; a size of s is a drive with s times all torques and inertias."""
    rng = np.random.default_rng(seed)
    time = STEP * np.arange(4000)
    runs = np.repeat(np.arange(1, len(starts) + 1), len(time))
    velocity = np.concatenate([velocity_after(start, time) for start in starts])
    channels = {
        "time": np.tile(time, len(starts)),
        "torque": np.zeros(len(velocity)),
        "velocity": velocity + NOISE * rng.standard_normal(len(velocity)),
    }
    return Recording("spindle", Motion.ROTARY, channels, runs.astype(np.int64))


@pytest.mark.long
def test_friction_of_a_spindle_that_coasts_is_found() -> None:
    comparison = compare(spindle(), "coulomb-viscous", J)
    found = comparison.estimate
    for key, true in {"K_v": K_V, "K_c": K_C}.items():
        assert abs(found.parameters[key] - true) < 3.0 * found.standard_errors[key]
        assert found.standard_errors[key] < 0.05 * true
    assert comparison.errors.held_out_percent < 1.2 * comparison.noise_floor_percent
    assert improve(spindle(), "coulomb-viscous", J).first.verdict == "adequate"


def test_errors_are_in_percent_of_the_torque_of_the_inertia() -> None:
    recording = coasting(spindle(), J)
    moving = np.concatenate([velocity_after(start, STEP * np.arange(4000)) for start in (300.0, 250.0, 150.0, 120.0)])
    friction = np.where(moving > 0.0, K_C + K_V * moving, 0.0)
    assert recording.rms_torque == pytest.approx(float(np.sqrt(np.mean(friction**2))), rel=0.02)
    comparison = compare(spindle(), "coulomb-viscous", J)
    headline = comparison.errors.headline
    assert headline.percent == pytest.approx(100.0 * headline.SI / recording.rms_torque, rel=1e-12)


def test_the_estimator_gives_what_a_comparison_gives() -> None:
    recording = spindle(1)
    found = compare(recording, "coulomb-viscous", J)
    fit = Batch().fit(Drive(Model.parse("coulomb-viscous"), J), replace(found.train, origin=None))
    assert fit.parameters["K_c"] == pytest.approx(found.estimate.parameters["K_c"], rel=0.02)
    whole = Batch().fit(Drive(Model.parse("coulomb-viscous"), J), recording)
    assert whole.parameters["K_c"] == pytest.approx(K_C, rel=0.02)


def test_a_drive_of_another_size_has_the_same_errors() -> None:
    small, large = compare(spindle(2), "coulomb-viscous", J), compare(spindle(2), "coulomb-viscous", 1000.0 * J)
    assert large.estimate.parameters["K_c"] == pytest.approx(1000.0 * small.estimate.parameters["K_c"], rel=1e-6)
    assert large.errors.held_out_percent == pytest.approx(small.errors.held_out_percent, rel=1e-6)


@pytest.mark.long
def test_drag_is_named() -> None:
    model = Model.parse("coulomb-viscous+nonlinear-viscous")
    true = {"K_v": K_V, "K_c": K_C, "nonlinear-viscous.a": 0.0, "nonlinear-viscous.b": 2e-6, "J": J}
    time, rng = STEP * np.arange(4000), np.random.default_rng(3)
    runs = [
        simulate(Drive(model, J), true, time, np.zeros(4000), initial_velocity=start).velocity
        for start in (300.0, -250.0, 150.0, -120.0)
    ]
    recording = spindle()
    velocity = np.concatenate(runs)
    recording = recording.with_channels(derived=False, velocity=velocity + NOISE * rng.standard_normal(len(velocity)))
    ladder = improve(recording, "coulomb-viscous", J)
    assert ladder.first.findings[0].names == ("nonlinear-viscous",)
    last = ladder.rungs[-1].comparison.estimate
    assert last.parameters["nonlinear-viscous.b"] == pytest.approx(2e-6, rel=0.1)


def test_a_run_that_coasts_beside_driven_ones_has_errors_in_percent_of_the_torque_of_all() -> None:
    time, rng = STEP * np.arange(4000), np.random.default_rng(4)
    torque = 0.9 * np.sin(2 * np.pi * 0.4 * time) + 0.5 * np.sin(2 * np.pi * 1.1 * time)
    true = {"K_v": K_V, "K_c": K_C, "J": J}
    driven = simulate(Drive(Model.parse("coulomb-viscous"), J), true, time, torque).velocity
    both = spindle(starts=(1.0, 300.0, -200.0))
    velocity = np.concatenate([driven, velocity_after(300.0, time), velocity_after(-200.0, time)])
    channels = {
        "torque": np.concatenate([torque, np.zeros(8000)]),
        "velocity": velocity + NOISE * rng.standard_normal(len(velocity)),
    }
    recording = coasting(both.with_channels(derived=False, **channels), None)
    parts = [run.rms_torque for run in recording.runs()]
    assert parts[1] == parts[2] == pytest.approx(recording.rms_torque)
    assert parts[0] == pytest.approx(float(np.sqrt(np.mean(torque**2))))
    comparison = compare(both.with_channels(derived=False, **channels), "coulomb-viscous")
    assert np.isfinite(comparison.errors.held_out_percent)
    assert comparison.estimate.parameters["J"] == pytest.approx(J, rel=0.02)


def test_without_an_inertia_the_way_out_is_said() -> None:
    with pytest.raises(InputError, match=r"torque is zero throughout; map the column .* or give --inertia"):
        compare(spindle(), "coulomb-viscous")
    with pytest.raises(EstimationError, match="give --inertia"):
        Batch().fit(Drive(Model.parse("coulomb-viscous")), spindle())


def test_a_drive_that_does_not_slow_down_was_driven() -> None:
    recording = spindle(starts=(300.0,))
    driven = recording.with_channels(derived=False, velocity=20.0 * np.sin(7.0 * recording.time))
    with pytest.raises(InputError, match="yet the drive does not slow down; map the column"):
        compare(driven, "coulomb-viscous", J)
    assert {finding.kind for finding in findings(driven)} >= {"constant-channel"}


def test_the_look_at_the_log_says_that_it_coasts() -> None:
    found = {finding.kind: finding for finding in findings(spindle(), J)}
    assert "in percent of the inertia's RMS torque" in found["coasting"].text
    assert "constant-channel" not in found
    assert not any(finding.severity == "stop" for finding in found.values())


def test_of_a_coast_one_way_another_coast_is_asked_for() -> None:
    (little,) = (one for one in findings(spindle(starts=(300.0, 250.0)), J) if one.kind == "little-motion")
    assert little.remedy == "let it coast the other way as well, if it can turn so"


def test_a_log_without_a_torque_is_told_how_to_say_that_it_coasts(tmp_path: Path) -> None:
    path = tmp_path / "down.csv"
    pd.DataFrame({"time_s": STEP * np.arange(9), "velocity_rad_s": np.arange(9.0)}).to_csv(path, index=False)
    with pytest.raises(InputError, match="or add one of zeros if the drive coasts without a torque"):
        read(path)


def test_sums_give_the_friction_of_a_spindle_that_coasts(tmp_path: Path) -> None:
    recording = spindle(5)
    path = tmp_path / "spindle.csv"
    columns = {"time_s": "time", "torque_Nm": "torque", "velocity_rad_s": "velocity"}
    table = pd.DataFrame({name: recording[channel] for name, channel in columns.items()} | {"run": recording.run})
    table.to_csv(path, index=False)
    total = sums.of_file(path, sums.plan_for(sums.pilot(path), "coulomb-viscous", J))
    found = sums.solved(total, J)
    for key, true in {"K_v": K_V, "K_c": K_C}.items():
        assert abs(found.parameters[key] - true) < max(3.0 * found.standard_errors[key], 0.02 * true)
    assert 0.0 < found.residual_percent < 5.0
    with pytest.raises(InputError, match="give --inertia"):
        sums.solved(total)
    with pytest.raises(InputError, match="give --inertia"):
        sums.plan_for(recording, "coulomb-viscous")
