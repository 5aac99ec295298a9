"""What sampling hides of a torque error: when a drive turned, whether it stopped, and a shift within a sample."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import filtered_torque_error
from fricmodels.score.sampling import about_reversals, without_shift

INERTIA = 0.5
TRUE = {"J": INERTIA, "K_c": 2.0, "K_v": 0.3}
DRIVE = Drive(Model.of("coulomb-viscous"), None, Motion.ROTARY)
RATE = 100.0


def swinging(late: float = 0.0, more: float = 0.0) -> Recording:
    """Return a drive whose torque was taken some samples late, with a torque of position more; without any noise."""
    time = np.arange(int(20 * RATE)) / RATE

    def torque(at: Array) -> Array:
        velocity = 3.0 * np.sin(5.0 * at + 0.3)
        return INERTIA * 15.0 * np.cos(5.0 * at + 0.3) + 2.0 * np.sign(velocity) + 0.3 * velocity

    velocity = 3.0 * np.sin(5.0 * time + 0.3)
    position = -0.6 * np.cos(5.0 * time + 0.3)
    channels = {
        "time": time,
        "velocity": velocity,
        "position": position,
        "torque": torque(time - late / RATE) + more * np.cos(4.0 * position),
    }
    return Recording("swinging", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def percent(recording: Recording, *, beyond_sampling: bool) -> float:
    error = filtered_torque_error(DRIVE, TRUE, recording, 1, beyond_sampling=beyond_sampling)
    return 100 * float(np.sqrt(np.mean(error**2) / np.mean(recording.torque**2)))


def test_an_instant_of_reversal_and_a_shift_within_a_sample_are_hidden_by_sampling() -> None:
    late = swinging(late=0.4)
    assert percent(late, beyond_sampling=False) > 3.0
    assert percent(late, beyond_sampling=True) < 1.0  # where a window reaches over a reversal


def test_a_shift_of_several_samples_is_not() -> None:
    late = swinging(late=4.0)
    assert percent(late, beyond_sampling=True) > 0.7 * percent(late, beyond_sampling=False)


@pytest.mark.parametrize("late", [0.0, 0.4])
def test_a_torque_that_is_missing_stays(late: float) -> None:
    missing = swinging(late=late, more=1.0)
    whole = 100 * float(np.sqrt(np.mean(np.cos(4.0 * missing["position"]) ** 2) / np.mean(missing.torque**2)))
    assert percent(missing, beyond_sampling=True) > 0.85 * whole


def test_a_reversal_half_a_sample_off_lies_within_what_is_allowed() -> None:
    """By hand: a drive that turns at 3/4 of an interval may have turned at 1/4 of it, or of the next one."""
    velocity = np.array([2.0, 1.5, -0.5, -2.5, -4.5])
    share = np.array([0.5, 0.75, 0.5, 0.5])
    less, more = about_reversals(velocity, share, np.full(5, -1.0), np.full(5, 1.0))
    assert less == pytest.approx([0.0, -1.0, 0.0, 0.0])  # forward for half an interval less: 2 K_c / 2
    assert more == pytest.approx([0.0, 0.5, 0.5, 0.0])


def test_a_shift_is_bounded() -> None:
    rate = np.sin(np.arange(100.0))
    left, shift = without_shift(3.0 * rate, rate, 1.0)
    assert shift == 1.0
    assert left == pytest.approx(2.0 * rate)
    assert without_shift(rate, np.zeros(100), 1.0)[1] == 0.0
