"""A motor torque that jumps where the drive turns, between two samples."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.diagnosis import diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.cells import along_cubics
from fricmodels.weakform.jumps import jumps_at_reversals
from fricmodels.weakform.quadrature import Quadrature

Array = NDArray[np.float64]
INERTIA, VISCOUS, COULOMB = 0.05, 0.1, 0.4
RATE = 100.0
_FINE = 200
FREQUENCY, PHASE, SIZE = np.array([1.3, 3.7, 6.1]), np.array([0.3, 1.9, 4.4]), np.array([2.0, 1.5, 1.0])


def motion(time: Array) -> tuple[Array, Array]:
    angle = np.multiply.outer(time, FREQUENCY) + PHASE
    return np.sin(angle) @ SIZE, np.cos(angle) @ (SIZE * FREQUENCY)


def computed(sampled: str, samples: int = 3000, noise: float = 0.0) -> Recording:
    """Record a computed torque, as it is at each sample or its mean over the sampling interval; or without a jump."""
    time = np.arange(samples) / RATE
    velocity = motion(time)[0]
    inside = np.zeros(1) if sampled == "instant" else (np.arange(_FINE) + 0.5) / _FINE - 0.5
    speed, slope = motion(time[:, None] + inside / RATE)
    coulomb = 0.0 if sampled == "no jump" else COULOMB
    torque = (INERTIA * slope + VISCOUS * speed + coulomb * np.sign(speed)).mean(axis=1)
    rng = np.random.default_rng(3)
    channels = {
        "time": time,
        "torque": torque + 0.01 * noise * np.std(torque) * rng.standard_normal(samples),
        "velocity": velocity + 0.01 * noise * np.std(velocity) * rng.standard_normal(samples),
    }
    return Recording("computed", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))


def seen(recording: Recording) -> Array:
    """Return the jumps that are seen with the exact velocity."""
    velocity = motion(recording.time)[0]
    plain = Quadrature.of(recording, velocity, np.zeros(len(recording), dtype=bool))
    sides = np.sign(velocity[plain.cell + 1]) - np.sign(velocity[plain.cell])
    shares = (part / plain.half_step for part in (plain.before, plain.after))
    return jumps_at_reversals(recording.torque, plain.cell, *shares, plain.half, sides)[0] / sides


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_the_jump_is_the_coulomb_torque(noise: float) -> None:
    found = seen(computed("instant", noise=noise))
    assert np.count_nonzero(found) > 0.95 * len(found)
    assert found[found != 0.0] == pytest.approx(COULOMB, rel=0.03)


@pytest.mark.parametrize("sampled", ["mean", "no jump"])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_there_is_none_in_means_nor_in_a_torque_that_goes_on(sampled: str, noise: float) -> None:
    assert not seen(computed(sampled, noise=noise)).any()


def test_few_reversals_show_none() -> None:
    assert not seen(computed("instant", samples=250)).any()


def test_the_integral_over_a_reversal_is_exact() -> None:
    """A straight line over the cell is wrong by up to half the Coulomb torque times the cell."""
    recording = computed("instant")
    errors = {}
    for jumps in (True, False):
        velocity = motion(recording.time)[0]
        found = Quadrature.of(recording, velocity, np.zeros(len(recording), dtype=bool), None if jumps else 0.0)
        each = np.empty((1, len(recording)))
        parts = found.half, found.cell, found.before, found.after, found.bending
        along_cubics(found.recording.torque[None], *parts, each)
        impulses = each[0][found.cell]
        fine = recording.time[found.cell][:, None] + (np.arange(_FINE) + 0.5) / _FINE / RATE
        speed, slope = motion(fine)
        exact = (INERTIA * slope + VISCOUS * speed + COULOMB * np.sign(speed)).mean(axis=1) / RATE
        errors[jumps] = np.max(np.abs(impulses - exact)) * RATE / COULOMB
    assert errors[True] < 0.02
    assert errors[False] > 0.3


def test_a_drive_with_nothing_hidden_is_adequate(from_benchmarks: Callable[[str], ModuleType]) -> None:
    """Along straight lines what is left goes with the time since the last reversal, and the drive is unknown."""
    drawn = from_benchmarks("closed_form").drawn(40)
    assert diagnose(drawn.recording, "coulomb-viscous", drawn.true["J"]).verdict == "adequate"
