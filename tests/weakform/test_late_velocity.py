"""A velocity that comes later than the position moves: the drive's filter, or its bus, is not the drive."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter
from tests.conftest import INERTIA, LAW, Made

from fricmodels.drive import Drive
from fricmodels.logcheck.rates import is_late
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready

Array = NDArray[np.float64]
TRUE = {"J": INERTIA, **LAW}


def shifted(velocity: Array, samples: int) -> Array:
    """Return a velocity that comes so many samples later."""
    return np.r_[np.full(samples, velocity[0]), velocity[:-samples]]


def low_passed(velocity: Array, samples: float) -> Array:
    """Return a velocity behind a low-pass filter of first order whose time constant is so many samples."""
    share = 1 - np.exp(-1 / samples)
    return np.asarray(lfilter([share], [1.0, share - 1.0], velocity, zi=[(1 - share) * velocity[0]])[0])


def with_velocity(recording: Recording, velocity: Array) -> Recording:
    return replace(recording, channels={**recording.channels, "velocity": velocity})


@pytest.mark.parametrize("late", [shifted, low_passed])
def test_the_position_is_taken_for_a_velocity_that_is_late(made: Made, late: Callable[[Array, int], Array]) -> None:
    """The parameters are those of the true motion, for which the late velocity gives wrong ones."""
    good = made()
    bad = with_velocity(good, late(good.velocity, 6))
    assert is_late(bad)
    assert not is_late(good)
    taken = ready(bad)
    assert np.std((taken.velocity - good.velocity)[20:-20]) < 0.02 * np.std((bad.velocity - good.velocity)[20:-20])
    drive = Drive(Model.parse("coulomb-viscous"))
    found = estimate(drive, ready(bad))[1].parameters
    for key, value in found.items():
        assert value == pytest.approx(TRUE[key], rel=0.01), key
    without = replace(bad, channels={name: values for name, values in bad.channels.items() if name != "position"})
    assert estimate(drive, ready(without))[1].parameters["K_c"] != pytest.approx(TRUE["K_c"], rel=0.01)


def test_a_velocity_ahead_of_its_position_stays(made: Made) -> None:
    """Then it is the position that is late, and would say when the drive moved no better."""
    good = made()
    early = with_velocity(good, shifted(good.velocity[::-1], 6)[::-1])
    assert not is_late(early)
    np.testing.assert_array_equal(ready(early).velocity, early.velocity)


def test_a_coarse_position_does_not_take_the_place_of_a_velocity_that_is_little_late(made: Made) -> None:
    good = made()
    step = 0.5
    coarse = {"position": step * np.round(good["position"] / step), "velocity": shifted(good.velocity, 2)}
    recording = replace(good, channels={**good.channels, **coarse})
    np.testing.assert_array_equal(ready(recording).velocity, coarse["velocity"])


def test_a_velocity_of_the_other_side_of_a_gear_stays(made: Made) -> None:
    good = made()
    geared = with_velocity(good, 3.0 * shifted(good.velocity, 6))
    assert not is_late(geared)
    np.testing.assert_array_equal(ready(geared).velocity, geared.velocity)


def test_so_it_is_for_one_that_is_late_by_less_than_a_sample(made: Made) -> None:
    """Beside a spring the viscous torque would be too small by the stiffness times the lag, 0.4 samples."""
    good = made("coulomb-viscous+stiffness", {"stiffness.k": 60.0})
    velocity = 0.6 * good.velocity + 0.4 * shifted(good.velocity, 1)
    bad = with_velocity(good, velocity)
    assert is_late(bad)
    fit = estimate(Drive(Model.parse("coulomb-viscous+stiffness"), INERTIA), ready(bad))[1]
    assert fit.parameters["K_v"] == pytest.approx(LAW["K_v"], abs=3.0 * fit.standard_errors["K_v"])
