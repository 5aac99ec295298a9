"""A velocity that is a difference of counts: its sum is the position, and all is as if that had been recorded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels import compare, diagnose
from fricmodels.dimension import Motion
from fricmodels.logcheck.summary import summary
from fricmodels.recording import Recording
from fricmodels.signals.counted import step_of_counts, with_counted_position
from fricmodels.sums import of_file, plan_for, solved

Array = NDArray[np.float64]
Benchmarks = Callable[[str], ModuleType]
INERTIA, VISCOUS, COULOMB, STRIBECK, SPEED = 1e-3, 3e-3, 0.05, 0.03, 0.3


def recorded(width: ModuleType, *, rate: int = 1000, bits: int = 12, seed: int = 1, stribeck: float = 0.0) -> Recording:
    """Return counts at a rate, with the torque that moved the drive, its mean over each sample."""
    velocity = width.steps(seed, 8.0)
    friction = COULOMB + stribeck * np.exp(-np.abs(velocity) / SPEED)
    torque = INERTIA * np.gradient(velocity) * width.FINE + VISCOUS * velocity + friction * np.sign(velocity)
    every = width.FINE // rate
    time, position, _ = width.read_off(velocity, rate, bits, 0.0, seed)
    mean = np.convolve(torque, np.full(every, 1.0 / every), "same")[::every]
    noise = 5e-4 * np.random.default_rng(seed).standard_normal(len(time))
    channels = {"time": time, "position": position, "torque": mean + noise}
    return Recording("counts", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def differences(recording: Recording, *, central: bool = False) -> Recording:
    """Return the recording with differences of its counts in the place of them."""
    position, interval = recording["position"], recording.interval
    change = np.gradient(position) if central else np.diff(position, prepend=position[0])
    channels = {name: values for name, values in recording.channels.items() if name != "position"}
    return replace(recording, channels={**channels, "velocity": change / interval})


@pytest.mark.parametrize(("rate", "bits"), [(1000, 12), (1000, 14), (4000, 14), (4000, 16), (2000, 12)])
@pytest.mark.parametrize("central", [False, True])
def test_it_is_told_and_summed(from_benchmarks: Benchmarks, rate: int, bits: int, central: bool) -> None:
    counts = recorded(from_benchmarks("derivative_width"), rate=rate, bits=bits)
    told = with_counted_position(differences(counts, central=central))
    position = counts["position"]
    expected = 0.5 * (position + np.append(position[1:], position[-1])) if central else position
    np.testing.assert_allclose(told["position"] - told["position"][-1], expected - expected[-1], atol=1e-9)


@pytest.mark.parametrize("noise", [0.0, 0.2, 0.4, 1.0])
@pytest.mark.parametrize(("rate", "fastest"), [(1000, 1.0), (1000, 8.0), (200, 60.0), (4000, 8.0)])
def test_a_velocity_that_was_rounded_is_none(
    from_benchmarks: Benchmarks, rate: int, fastest: float, noise: float
) -> None:
    """Its errors add up, the more so with noise in it; without any it keeps one value for long."""
    width = from_benchmarks("derivative_width")
    true = width.steps(2, fastest)[:: width.FINE // rate]
    for step in (2.0 * np.pi / 2**12 * rate, fastest / 2000.0):
        rounded = step * np.round(true / step + noise * np.random.default_rng(0).standard_normal(len(true)))
        channels = {"time": np.arange(len(true)) / rate, "velocity": rounded, "torque": rounded}
        assert not step_of_counts(Recording("r", Motion.ROTARY, channels, np.zeros(len(true), dtype=np.int64)))


def test_a_position_that_was_recorded_stays(from_benchmarks: Benchmarks) -> None:
    counts = recorded(from_benchmarks("derivative_width"))
    both = counts.with_channels(derived=False, velocity=differences(counts).velocity)
    assert with_counted_position(both) is both


@pytest.mark.long
def test_a_fit_is_that_of_the_positions(from_benchmarks: Benchmarks) -> None:
    """Of velocities in eleven steps F_s was 0 and an error of 25 % was left, with nothing hidden "unknown"."""
    counts = recorded(from_benchmarks("derivative_width"), stribeck=STRIBECK)
    one, other = (compare(each, "coulomb-viscous+stribeck", INERTIA) for each in (counts, differences(counts)))
    for key, value in one.estimate.parameters.items():
        assert other.estimate.parameters[key] == pytest.approx(value, rel=1e-6)
    assert other.estimate.parameters["stribeck.F_s"] == pytest.approx(STRIBECK, rel=0.02)
    plain = differences(recorded(from_benchmarks("derivative_width")))
    assert diagnose(plain, "coulomb-viscous", INERTIA).verdict == "adequate"
    found = diagnose(differences(counts), "coulomb-viscous", INERTIA).findings
    assert [finding.names for finding in found] == [("stribeck",)]


def test_so_are_sums_over_a_file(from_benchmarks: Benchmarks, tmp_path: Path) -> None:
    counts = recorded(from_benchmarks("derivative_width"))
    values = []
    for name, recording in (("position", counts), ("velocity", differences(counts))):
        file = tmp_path / f"{name}.csv"
        columns = np.column_stack([recording.time, recording[name], recording.torque])
        np.savetxt(file, columns, delimiter=",", header=f"t,{name},torque", comments="", fmt="%.9g")
        moved = f"{name}={name}:{'rad' if name == 'position' else 'rad/s'}"
        plan = plan_for(recording, "coulomb-viscous", INERTIA)
        values.append(solved(of_file(file, plan, columns=("time=t:s", moved, "torque=torque:N*m")), INERTIA).parameters)
    for key, value in values[0].items():
        assert values[1][key] == pytest.approx(value, rel=1e-4)


def test_the_log_check_says_so(from_benchmarks: Benchmarks) -> None:
    found = summary(differences(recorded(from_benchmarks("derivative_width"))))
    assert [finding.kind for finding in found.findings] == ["counted-velocity"]
    assert found.rest < 0.25
