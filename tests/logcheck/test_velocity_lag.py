"""By how much a velocity comes after the position, where a drive derives it from the counts that it logs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from fricmodels.dimension import Motion
from fricmodels.logcheck import findings
from fricmodels.logcheck.rates import velocity_lag
from fricmodels.recording import Recording
from fricmodels.weakform.prepared import surest_velocity

INTERVAL, SAMPLES = 2e-3, 12_000


def logged(counts: int, smoothing: float, late: int = 0, seed: int = 0) -> Recording:
    """Return a slow motion seen by an encoder: its velocity is the low-passed difference of the counts.

    Args:
        counts: a turn.
        smoothing: α of v += α (Δq/Δt − v); the velocity is (1 − α)/α + 1/2 samples late.
        late: further samples.
        seed: of the motion.
    """
    rng = np.random.default_rng(seed)
    time = INTERVAL * np.arange(SAMPLES)
    waves = zip((0.1, 0.23, 0.41, 0.6), rng.uniform(0.0, 6.0, 4), strict=True)
    position = 0.4 * np.sum([np.sin(2 * np.pi * f * time + phase) for f, phase in waves], axis=0)
    seen = np.round(position * counts / (2 * np.pi)) * 2 * np.pi / counts
    velocity = lfilter([smoothing], [1.0, smoothing - 1.0], np.diff(seen, prepend=seen[0]) / INTERVAL)
    velocity = np.r_[np.zeros(late), velocity[: SAMPLES - late]]
    torque = np.sign(velocity) + 0.1 * rng.standard_normal(SAMPLES)
    channels = {"time": time, "torque": torque, "velocity": velocity, "position": seen}
    return Recording("encoder", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


@pytest.mark.parametrize("counts", [2**13, 2**15, 2**17, 2**24])
@pytest.mark.parametrize("smoothing", [0.9, 0.5])
def test_the_lag_is_that_of_the_filter_however_coarse_the_counts(counts: int, smoothing: float) -> None:
    true = (1.0 - smoothing) / smoothing + 0.5
    recording = logged(counts, smoothing)
    found = velocity_lag(recording)
    assert found is not None
    assert found.late / INTERVAL == pytest.approx(true, abs=max(4.0 * found.error / INTERVAL, 0.05))
    assert found.error < 0.4 * INTERVAL
    late = {finding.kind for finding in findings(recording)} & {"velocity-lag"}
    assert late == ({"velocity-lag"} if found.is_certain else set())
    assert true > 0.6 or not found.is_certain


@pytest.mark.parametrize("counts", [2**13, 2**17, 2**24])
def test_a_backward_difference_is_not_late(counts: int) -> None:
    """Half a sample is what a difference costs."""
    found = velocity_lag(logged(counts, 1.0))
    assert found is not None
    assert not found.is_certain


@pytest.mark.parametrize("counts", [2**17, 2**24])
def test_a_filter_that_costs_less_than_a_sample_is_named_and_the_position_taken(counts: int) -> None:
    recording = logged(counts, 0.7)
    found = velocity_lag(recording)
    assert found is not None
    assert found.late / INTERVAL == pytest.approx(0.93, abs=0.05)
    assert found.is_certain
    assert "velocity" in surest_velocity(recording).derived


@pytest.mark.parametrize("counts", [2**13, 2**17])
def test_a_velocity_that_is_four_samples_late_is_named(counts: int) -> None:
    recording = logged(counts, 0.9, late=4)
    found = velocity_lag(recording)
    assert found is not None
    assert found.is_certain
    assert found.late / INTERVAL == pytest.approx(4.6, abs=0.5)
