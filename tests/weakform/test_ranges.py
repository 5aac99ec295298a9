"""Bounds of parameters that the recorded motion sets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.conftest import INERTIA, Made

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.effects.drift import Drift
from fricmodels.effects.frictional_lag import FrictionalLag
from fricmodels.effects.joint_compliance import JointCompliance
from fricmodels.effects.position_friction import PositionFriction
from fricmodels.effects.presliding import Presliding
from fricmodels.effects.stribeck import Stribeck
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.candidate import within_recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.ranges import slow_angular_frequency, turning, within_motion


def swinging(frequency: float, noise: float = 0.0) -> Recording:
    """Return a drive that goes back and forth at a frequency [Hz], for twenty seconds."""
    time = np.arange(4000) / 200.0
    velocity = np.sin(2 * np.pi * frequency * time) + noise * np.random.default_rng(1).standard_normal(len(time))
    channels = {"time": time, "torque": np.sign(velocity), "velocity": velocity}
    return Recording("swinging", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("frequency", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_the_frequency_of_one_sine_is_its_own(frequency: float, noise: float) -> None:
    assert slow_angular_frequency(swinging(frequency, noise)) == pytest.approx(2 * np.pi * frequency, rel=0.1)


def test_a_resonance_lies_above_the_motion() -> None:
    """A link that swings three times as far as the motor goes back and forth, and farther, is not carried along."""
    bounded = within_motion(swinging(2.0), JointCompliance.omega_n)
    assert bounded.lower == pytest.approx(4 * np.pi * np.sqrt(1.5), rel=0.05)
    assert 1 / abs(1 - (4 * np.pi / bounded.lower) ** 2) == pytest.approx(3.0, rel=0.3)
    assert bounded.upper == pytest.approx(np.pi / (2 * swinging(2.0).interval)), "four samples a period"
    assert within_motion(swinging(2.0), JointCompliance.zeta) == JointCompliance.zeta


def test_a_sweep_may_pass_a_resonance() -> None:
    """Its slow part tells that the link follows; how fast it becomes later says nothing of the link."""
    still = swinging(1.0)
    phase = 2 * np.pi * (0.3 * still.time + 0.5 * 0.6 * still.time**2)  # up to 12.3 Hz
    sweep = replace(still, channels={**still.channels, "velocity": np.sin(phase)})
    tenth = 2 * np.pi * (0.3 + 0.1 * 12.0)
    assert slow_angular_frequency(sweep) == pytest.approx(tenth, rel=0.25)
    assert within_motion(sweep, JointCompliance.omega_n).lower < 2 * np.pi * 4.0


def test_a_rest_is_no_part_of_a_stroke() -> None:
    """Strokes of a second with rests of three: slow samples at both ends of a stroke are."""
    time = np.arange(8000) / 200.0
    phase = time % 4.0
    velocity = np.where(phase < 1.0, np.sin(np.pi * phase), 0.0) * np.where((time // 4.0) % 2 == 0, 1.0, -1.0)
    velocity += 0.02 * np.random.default_rng(2).standard_normal(len(time))
    channels = {"time": time, "torque": np.sign(velocity), "velocity": velocity}
    moves = Recording("moves", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    assert slow_angular_frequency(moves) == pytest.approx(np.pi, rel=0.15)


def test_a_stroke_that_is_cut_is_as_long_as_it_was() -> None:
    """Parts of a record that are kept back for the test cut its strokes into pieces."""
    whole = swinging(0.3).remembering()
    kept = (np.arange(len(whole)) // 100) % 3 > 0  # half seconds of strokes of 1.7 s are left out
    assert slow_angular_frequency(whole.select(kept)) == pytest.approx(2 * np.pi * 0.3, rel=0.1)
    apart = replace(whole.select(kept), origin=None, run=np.cumsum(np.diff(kept.astype(int), prepend=0) == 1)[kept])
    assert slow_angular_frequency(apart) > 1.3 * 2 * np.pi * 0.3


def test_a_drive_that_does_not_turn_back_sets_no_lower_bound() -> None:
    still = swinging(1.0)
    forward = replace(still, channels={**still.channels, "velocity": 2.0 + still.velocity})
    assert slow_angular_frequency(forward) == 0.0
    assert within_motion(forward, JointCompliance.omega_n).lower == JointCompliance.omega_n.lower


def test_a_drift_that_is_sought_lasts_for_a_tenth_of_the_record(made: Made) -> None:
    """Friction that falls within the first stroke and then stays is how the record began."""
    recording = ready(made())
    problem, _ = estimate(Drive(Model.parse("coulomb-viscous"), INERTIA), recording)
    assert within_recording(problem, Drift.T).lower == pytest.approx(0.1 * float(np.ptp(recording.time)))
    assert within_motion(recording, FrictionalLag.T).lower == pytest.approx(2 * recording.interval)


@pytest.mark.parametrize("frequency", [0.5, 2.0])
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_sine_turns_with_its_greatest_acceleration(frequency: float, noise: float) -> None:
    assert turning(swinging(frequency, noise)) == pytest.approx(2 * np.pi * frequency, rel=0.15)


def test_a_slower_turn_is_what_tells_of_low_speeds() -> None:
    """Fast and slow reversals, with rests and slow stretches between, which pass no speed."""
    time = np.arange(4000) / 200.0
    velocity = np.interp(time, [0, 5, 5.1, 10, 12, 14, 16, 20], [1, 1, -1, -1, 0, 0, 1, 1])
    channels = {"time": time, "torque": velocity, "velocity": velocity}
    recording = Recording("turns", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    assert turning(recording) == pytest.approx(0.5, rel=0.2)


def test_friction_differs_below_no_speed_that_is_passed_between_two_samples() -> None:
    """The drive is slower than that speed for two samples at least as it turns; in any unit of the velocity."""
    recording = swinging(2.0)
    least = 4 * np.pi / 200.0
    for parameter in (Stribeck.omega_s, FrictionalLag.omega_s):
        assert within_motion(recording, parameter).lower == pytest.approx(least, rel=0.1)
    scaled = recording.with_channels(velocity=1e3 * recording.velocity)
    assert within_motion(scaled, Stribeck.omega_s).lower == pytest.approx(1e3 * least, rel=0.1)
    steady = recording.with_channels(velocity=2.0 + recording.velocity)
    assert within_motion(steady, Stribeck.omega_s).lower == Stribeck.omega_s.lower
    part = replace(Stribeck.omega_s, lower=-np.inf)  # such as the speed at 0 °C of one that rises with temperature
    assert within_motion(recording, part) is part


def test_no_contact_bends_over_less_than_the_drive_goes_in_two_samples() -> None:
    """From standstill it goes ½ a (2 Δt)² in two samples; in any unit of the length, and a place has no such bound."""
    recording = swinging(2.0)
    least = 0.5 * 4 * np.pi * (2 / 200.0) ** 2
    assert within_motion(recording, Presliding.x_s).lower == pytest.approx(least, rel=0.1)
    scaled = recording.with_channels(velocity=1e3 * recording.velocity)
    assert within_motion(scaled, Presliding.x_s).lower == pytest.approx(1e3 * least, rel=0.1)
    steady = recording.with_channels(velocity=2.0 + recording.velocity)
    assert within_motion(steady, Presliding.x_s).lower == Presliding.x_s.lower
    assert within_motion(recording, PositionFriction.k) is PositionFriction.k


@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_no_contact_bends_within_the_counts_that_tell_the_motion(size: float) -> None:
    """Where the drive turned is known to a count on either side; a velocity of its own does not depend on them."""
    recording, step = swinging(2.0), 0.01 * size
    recording = recording.with_channels(velocity=size * recording.velocity)
    counted = recording.with_channels(position=step * np.rint(np.cumsum(recording.velocity) / 200.0 / step))
    derived = replace(counted, derived_over=4)
    assert within_motion(derived, Presliding.x_s).lower == pytest.approx(2 * step, rel=1e-6)
    assert within_motion(counted, Presliding.x_s).lower == within_motion(recording, Presliding.x_s).lower
