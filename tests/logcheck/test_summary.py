from __future__ import annotations

import json

import numpy as np
import pytest

from fricmodels.cli import main
from fricmodels.dimension import Motion
from fricmodels.logcheck import summary
from fricmodels.logcheck.limits import saturation
from fricmodels.recording import Recording


def recording(time, motion=Motion.ROTARY, run=None, **channels):
    run = np.zeros(len(time), dtype=np.int64) if run is None else run
    torque = channels.pop("torque", np.sin(np.arange(len(time)) / 7.0))
    return Recording("r", motion, {"time": time, "torque": torque, **channels}, run)


def test_sampling_of_several_runs_with_gaps_and_lost_samples():
    rng = np.random.default_rng(0)
    grid = np.concatenate([np.arange(0, 5, 0.01), np.arange(8, 10, 0.01)])
    one = np.delete(grid, rng.choice(np.arange(1, 400), 20, replace=False))
    time = np.r_[one, np.arange(0, 3, 0.01)]
    time = time + rng.normal(0, 2e-4, len(time))
    run = np.r_[np.zeros(len(one), dtype=np.int64), np.ones(300, dtype=np.int64)]
    found = summary(recording(time, run=run, velocity=np.sin(3 * time)))
    assert (found.runs, found.gaps) == (2, 1)
    assert found.rate == pytest.approx(100, rel=0.02)
    assert found.jitter == pytest.approx(np.sqrt(2) * 0.02, rel=0.1)
    assert found.gap_time == pytest.approx(3.01, abs=0.01)
    assert found.duration == pytest.approx(4.99 + 1.99 + 2.99, abs=0.05)


def lossy(time, lost):
    time = np.delete(time, lost)
    return recording(time, velocity=np.sin(3 * time), position=-np.cos(3 * time) / 3)


def test_samples_that_are_missing_are_counted():
    """Single ones from an even clock are no gap, and were passed over: "gaps none, evenly sampled"."""
    lost = np.random.default_rng(0).choice(np.arange(10, 14990), 150, replace=False)
    found = summary(lossy(np.arange(15000) * 2e-3, lost))
    rows = dict(found.rows())
    assert found.missing == found.to_json()["missing_samples"] == 150
    assert rows["missing"] == "150 samples (1 %)"
    assert rows["rate"] == "500 Hz, evenly sampled but for what is missing"
    assert [one.kind for one in found.findings if one.kind == "missing-samples"] == ["missing-samples"]


def test_nothing_is_missing_where_stamps_wander_or_come_late():
    even = np.arange(15000) * 2e-3
    assert summary(lossy(even, [])).missing == 0
    late = even.copy()
    late[5000] += 1.9e-3
    assert summary(lossy(late, [])).missing == 0
    wander = np.cumsum(np.random.default_rng(0).exponential(2e-3, 15000))
    assert summary(lossy(wander, [])).missing == 0


def test_seconds_since_1970_are_even_stamps():
    """Floats are 0.24 µs apart there: the median interval was 499.977 Hz, with a jitter."""
    time = np.arange(3000) * 2e-3
    found = summary(recording(1714557600.0 + time, velocity=np.sin(3 * time)))
    assert dict(found.rows())["rate"] == "500 Hz, evenly sampled"
    wander = 1714557600.0 + time + np.random.default_rng(0).normal(0, 2e-5, 3000)
    assert summary(recording(wander, velocity=np.sin(3 * time))).jitter == pytest.approx(0.01 * np.sqrt(2), rel=0.1)


def test_noise_at_rest_is_no_reversal():
    """A drive that moves to and fro with rests between, and a tachometer that is noisy there."""
    time = np.arange(0, 24, 2e-3)
    moves = np.where(np.sin(0.5 * np.pi * time) > 0.0, np.sin(0.5 * np.pi * time), 0.0)
    velocity = 2.0 * moves * np.where(np.floor(time / 4) % 2 == 0, 1.0, -1.0)
    noisy = velocity + 0.02 * np.random.default_rng(1).standard_normal(len(time))
    assert summary(recording(time, velocity=noisy)).reversals == 5


def test_a_steady_part_of_the_speed_excites_nothing():
    time = np.arange(0, 20, 2e-3)
    velocity = 5.0 + np.sin(12.0 * time)
    assert summary(recording(time, velocity=velocity)).band == pytest.approx(12.0 / (2 * np.pi), rel=0.1)


def test_channels_and_motion():
    time = np.arange(0, 20, 2e-3)
    velocity = 3 * np.sin(2 * time) + 0.01 * np.random.default_rng(0).standard_normal(len(time))
    position = 0.01 * np.round(-1.5 * np.cos(2 * time) / 0.01)
    found = summary(recording(time, velocity=velocity, position=position))
    assert found.reversals == 12
    assert found.forward == pytest.approx(0.5, abs=0.05)
    assert found.band == pytest.approx(1 / np.pi, rel=0.3)
    assert found.channels["velocity"].noise == pytest.approx(0.01, rel=0.1)
    assert found.channels["position"].resolution == pytest.approx(0.01)
    assert found.channels["position"].unit == "rad"
    assert found.travel == pytest.approx(3.0, rel=0.01)
    assert found.rest < 0.02
    assert not found.feedback


@pytest.mark.parametrize("samples", [600, 20_000])
def test_a_short_log_has_a_noise_too(samples):
    time = 2e-3 * np.arange(samples)
    velocity = np.sin(2 * time) + 0.03 * np.random.default_rng(0).standard_normal(samples)
    assert summary(recording(time, velocity=velocity)).channels["velocity"].noise == pytest.approx(0.03, rel=0.2)


def test_random_sampling_makes_no_noise():
    """Intervals of 1 to 20 ms, the mean 5: by their number a motion is rough, and by their time it is smooth."""
    rng = np.random.default_rng(0)
    time = 1e-3 * np.sort(rng.choice(60_000, 12_000, replace=False))
    position = 0.4 * np.sin(2 * time) + 2e-6 * rng.standard_normal(len(time))
    found = summary(recording(time, position=position, torque=np.cos(2 * time)))
    assert found.channels["position"].noise == pytest.approx(2e-6, rel=0.1)


def test_a_torque_that_is_switched_is_an_exact_command():
    time = np.arange(0, 20, 2e-3)
    torque = 4.0 * np.sign(np.sin(3 * time))
    found = summary(recording(time, velocity=np.cos(3 * time), torque=torque))
    assert found.channels["torque"].noise == 0.0
    kinds = {one.kind for one in found.findings if one.channel == "torque"}
    assert "switched" in kinds
    assert not kinds & {"quantisation", "saturation"}


def test_friction_that_turns_with_a_slow_motion_is_no_noise():
    time = 0.01 * np.arange(900.0)
    velocity = 3.0 * np.sin(0.5 * np.pi * time) + 0.03 * np.random.default_rng(1).standard_normal(900)
    torque = 0.2 * np.sign(np.sin(0.5 * np.pi * time)) + 0.01 * np.random.default_rng(2).standard_normal(900)
    assert summary(recording(time, velocity=velocity, torque=torque)).channels["torque"].noise < 0.02


def test_a_controller_that_hears_the_noise_is_a_closed_loop():
    time = np.arange(0, 20, 2e-3)
    noise = 0.02 * np.random.default_rng(0).standard_normal(len(time))
    velocity = np.sin(2 * time)
    torque = np.cos(2 * time) - 2.0 * np.r_[0.0, noise[:-1]]
    assert summary(recording(time, velocity=velocity + noise, torque=torque)).feedback


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("seed", range(3))
def test_corners_of_a_motion_are_no_answer_to_noise(seed: int, noise: float) -> None:
    """Torque and velocity have their kinks together; the noise of each was added when all was over."""
    rng, time = np.random.default_rng(seed), 2e-3 * np.arange(10_000)
    rate = np.repeat(rng.choice([-8.0, 0.0, 8.0], 100), 100)
    velocity = np.cumsum(rate) * 2e-3
    torque = 0.2 * rate + 0.3 * np.sign(velocity)
    measured = velocity + 0.005 * rng.standard_normal(10_000)
    found = summary(recording(time, velocity=measured, torque=torque + noise * rng.standard_normal(10_000)))
    assert not found.feedback
    heard = torque - 0.5 * np.r_[0.0, (measured - velocity)[:-1]] + 0.001 * rng.standard_normal(10_000)
    assert summary(recording(time, velocity=measured, torque=heard)).feedback


@pytest.mark.parametrize("limit", [0.3, 0.8])
@pytest.mark.parametrize("step", [0.0, 0.01])
def test_saturation(limit, step):
    torque = np.sin(np.arange(20_000) / 71.0) + 0.002 * np.random.default_rng(0).standard_normal(20_000)
    if step:
        torque = step * np.round(torque / step)
    assert not saturation(torque)
    clipped = np.clip(torque, -limit, limit)
    truth = np.mean(np.abs(torque) >= limit - 1e-12)
    assert sum(saturation(clipped).values()) == pytest.approx(truth, rel=0.01)
    assert sum(saturation(-3.0 * clipped).values()) == pytest.approx(truth, rel=0.01)


def test_zero_at_rest_is_no_limit():
    size = np.maximum(np.sin(np.arange(5000) / 71.0), 0.0)
    assert not saturation(size)
    assert sum(saturation(size + 1.0).values()) > 0.4


def test_saturation_on_one_side_and_a_command_in_steps():
    assert saturation(np.minimum(np.sin(np.arange(5000) / 71.0), 0.5)) == {0.5: pytest.approx(1 / 3, abs=0.01)}
    assert not saturation(np.repeat(np.random.default_rng(0).choice([-1.0, -0.5, 0.5, 1.0], 100), 50))


def test_what_a_signal_stands_at_once_is_a_commanded_step():
    """Two tests of a motor on a bench in one log: a step of the voltage, and a slow ramp."""
    assert not saturation(np.r_[np.zeros(50), np.full(400, -7.0), np.linspace(0.0, 5.0, 350)])


def test_the_command_prints_and_writes(tmp_path, capsys):
    time = np.arange(0, 8, 2e-3)
    speed = np.sin(4 * time) + 0.5 * np.sin(9 * time)
    torque = -(0.1 * speed + 0.3 * np.sign(speed) + 0.02 * (4 * np.cos(4 * time) + 4.5 * np.cos(9 * time)))
    rows = np.column_stack([time, torque, 30 / np.pi * speed])
    path = tmp_path / "log.csv"
    lines = [",".join(f"{value:.9f}" for value in row) for row in rows]
    path.write_text("\n".join(["t [s],tau,Speed [rpm]", *lines]), encoding="utf-8")
    columns = ["--column", "time=t [s]", "--column", "torque=tau", "--column", "velocity=Speed [rpm]"]
    with pytest.raises(SystemExit, match="0"):
        main(["info", str(path), *columns, "--out", str(tmp_path / "out")])
    printed = capsys.readouterr().out
    assert "not usable as it is" in printed.splitlines()[0]
    assert "\nstops: torque-sign: the torque (torque=tau) has the wrong sign" in printed
    assert "--column 'torque=tau:-1 N*m'" in printed
    data = json.loads((tmp_path / "out" / "info.json").read_text(encoding="utf-8"))
    assert data["schema"] == "fricmodels/info/1"
    assert data["channels"]["velocity"]["greatest"] == pytest.approx(speed.max(), rel=1e-3)
    assert set(data["findings"][0]) == {"kind", "severity", "channel", "text", "remedy"}
    with pytest.raises(SystemExit, match="0"):
        main(["info", str(path), *columns, "--json"])
    assert json.loads(capsys.readouterr().out)["samples"] == len(time)
    diagnose = ["compare", str(path), *columns, "--model", "coulomb-viscous"]
    with pytest.raises(SystemExit, match="2"):
        main(diagnose)
    assert capsys.readouterr().err.count("\n") == 1
