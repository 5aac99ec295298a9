import json

import numpy as np
import pytest

from fricmodels.description import describe, reversals, saturation
from fricmodels.dimension import Motion
from fricmodels.recording import Recording


def recording(time, motion=Motion.ROTARY, run=None, **channels):
    run = np.zeros(len(time), dtype=np.int64) if run is None else run
    torque = channels.pop("torque", np.sin(np.arange(len(time)) / 7.0))
    return Recording("r", motion, {"time": time, "torque": torque, **channels}, run)


def test_sampling_of_several_runs_with_gaps_and_lost_samples():
    rng = np.random.default_rng(0)
    grid = np.concatenate([np.arange(0, 5, 0.01), np.arange(8, 10, 0.01)])
    lost = rng.choice(np.arange(1, 400), 20, replace=False)
    one = np.delete(grid, lost)
    time = np.r_[one, np.arange(0, 3, 0.01)]
    time = time + rng.normal(0, 2e-4, len(time))
    run = np.r_[np.zeros(len(one), dtype=np.int64), np.ones(300, dtype=np.int64)]
    found = describe(recording(time, run=run, velocity=np.sin(3 * time)))
    assert (found.runs, found.gaps) == (2, 1)
    assert found.rate == pytest.approx(100, rel=0.02)
    assert found.jitter == pytest.approx(np.sqrt(2) * 0.02, rel=0.1)
    assert found.lost_samples == pytest.approx(20 + 300, abs=2)
    assert found.gap_time == pytest.approx(3.01, abs=0.01)
    assert found.duration == pytest.approx(4.99 + 1.99 + 2.99, abs=0.05)


def test_coverage_and_quality():
    time = np.arange(0, 20, 2e-3)
    rng = np.random.default_rng(0)
    velocity = 3 * np.sin(2 * time) + 0.01 * rng.standard_normal(len(time))
    position = 0.01 * np.round(-1.5 * np.cos(2 * time) / 0.01)
    found = describe(recording(time, velocity=velocity, position=position))
    assert found.reversals == 12
    assert found.velocity_noise == pytest.approx(0.01, rel=0.1)
    assert found.velocity_step is None
    assert found.position_step == pytest.approx(0.01)
    assert found.turns == pytest.approx(3.0 / (2 * np.pi), rel=0.01)
    np.testing.assert_allclose(found.speed_range, [-3, 3], atol=0.05)
    assert found.rest < 0.01
    assert found.derived == ()


def test_position_only_on_a_linear_axis():
    time = np.arange(0, 10, 1e-3)
    position = 0.2 * np.sin(2 * time) + 1e-7 * np.random.default_rng(0).standard_normal(len(time))
    found = describe(recording(time, Motion.LINEAR, position=position))
    np.testing.assert_allclose(found.speed_range, [-0.4, 0.4], atol=2e-3)
    assert found.turns is None
    assert found.position_range == pytest.approx(0.4, rel=1e-3)
    assert found.reversals == 6


def test_rest_is_reported():
    time = np.arange(0, 10, 2e-3)
    velocity = np.maximum(np.sin(2 * time), 0.0) + 1e-3 * np.random.default_rng(0).standard_normal(len(time))
    assert describe(recording(time, velocity=velocity)).rest == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("limit", [0.3, 0.8])
@pytest.mark.parametrize("step", [0.0, 0.01])
def test_saturation(limit, step):
    torque = np.sin(np.arange(20_000) / 71.0) + 0.002 * np.random.default_rng(0).standard_normal(20_000)
    if step:
        torque = step * np.round(torque / step)
    assert saturation(torque) == 0.0
    clipped = np.clip(torque, -limit, limit)
    truth = np.mean(np.abs(torque) >= limit - 1e-12)
    assert saturation(clipped) == pytest.approx(truth, rel=0.01)
    assert saturation(-3.0 * clipped) == pytest.approx(truth, rel=0.01)


def test_saturation_on_one_side():
    torque = np.minimum(np.sin(np.arange(5000) / 71.0), 0.5)
    assert saturation(torque) == pytest.approx(1 / 3, abs=0.01)


def test_reversals_need_certain_directions_and_one_run():
    velocity = np.array([1.0, 0.1, -0.1, 0.1, 1.0, 0.0, -1.0, 1.0])
    run = np.array([0, 0, 0, 0, 0, 0, 0, 1])
    assert reversals(velocity, 0.5, run) == 1
    assert reversals(velocity, 0.05, run) == 3


def test_rows_and_json():
    time = np.arange(0, 5, 1e-2)
    found = describe(recording(time, velocity=np.sin(time), position=-np.cos(time)))
    assert json.loads(json.dumps(found.to_json()))["motion"] == "rotary"
    labels = [label for label, _ in found.rows()]
    assert len(labels) == len(set(labels))
    assert "turns" in dict(found.rows())["position range"]
