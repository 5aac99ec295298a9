"""Between which strokes of a drive a jump can be told."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.ranges import between_strokes

Made = Callable[..., Recording]


def test_a_jump_is_sought_where_a_stroke_of_one_direction_lies_on_either_side(made: Made) -> None:
    """Within the first or last stroke an offset does as much; where that leaves nothing, within the record."""
    recording = made("coulomb-viscous", {})
    first, last = between_strokes(recording)
    reversals = recording.time[1:][np.diff(np.sign(recording.velocity)) != 0]
    assert (first, last) == pytest.approx((reversals[0], reversals[-1]), abs=3 * recording.interval)
    channels = {"time": recording.time, "torque": recording.torque, "velocity": np.abs(recording.velocity) + 1.0}
    forward = Recording("forward", recording.motion, channels, recording.run)
    assert between_strokes(forward) == (recording.time[0], recording.time[-1])


def _strokes(*strokes: tuple[float, float, float], noise: float = 0.0) -> Recording:
    """Return 20 s of a motion in strokes, each from its beginning to its end [s] at a peak velocity."""
    time, rng = np.arange(4000) / 200.0, np.random.default_rng(0)
    velocity = noise * rng.standard_normal(len(time))
    for begin, end, peak in strokes:
        velocity += peak * np.sin(np.pi * np.clip((time - begin) / (end - begin), 0.0, 1.0)) ** 2
    channels = {"time": time, "torque": velocity, "velocity": velocity}
    return Recording("strokes", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def test_a_jump_may_lie_after_the_last_reversal_between_strokes_of_one_direction() -> None:
    """Forward once, then backward again and again with rests: each backward stroke tells whether it has jumped."""
    recording = _strokes((0.5, 2.0, 1.0), (3.0, 5.0, -1.0), (7.0, 9.0, -1.0), (12.0, 15.0, -1.0), (17.0, 19.0, -1.0))
    assert between_strokes(recording) == pytest.approx((5.0, 17.0), abs=0.2)


def test_pieces_into_which_noise_breaks_a_slow_motion_are_no_strokes() -> None:
    """A creep as slow as its noise, and then three strokes: forward to 8 s, backward to 15 s, and forward again."""
    recording = _strokes((0.0, 4.0, 0.01), (4.0, 8.0, 1.0), (9.0, 15.0, -1.0), (16.0, 19.0, 1.0), noise=0.005)
    assert between_strokes(recording) == pytest.approx((8.0, 16.0), abs=0.2)


def test_no_jump_can_be_told_where_each_direction_has_one_stroke() -> None:
    """An offset and another friction do as much then; a drive that only goes one way tells a jump of its friction."""
    first, last = between_strokes(_strokes((1.0, 9.0, 1.0), (10.0, 19.0, -1.0)))
    assert first > last
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 0.5), _strokes((1.0, 9.0, 1.0), (10.0, 19.0, -1.0)))
    assert "step-change" in candidate_tests(problem, found.parameters, only=["step-change"]).untested
