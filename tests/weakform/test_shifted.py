"""The shift in time that every recording may have: bounded, and for each candidate anew."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.effects.sensor_delay import SensorDelay
from fricmodels.effects.torque_offset import TorqueOffset
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.term import Effect
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.shifted import ShiftedRegression, regression_of

Array = NDArray[np.float64]

ROWS = 2000
SAMPLE = 0.01
UNLIMITED = np.full(1, np.inf)


def rows(seed: int = 0) -> tuple[Array, Array, Array]:
    """Return a base, the direction of a shift, and a candidate that resembles it."""
    rng = np.random.default_rng(seed)
    base, direction, other = rng.standard_normal((3, ROWS))
    return base[None], direction, 0.8 * direction + 0.6 * other


def shifted(target: Array, seed: int = 0) -> ShiftedRegression:
    base, direction, _ = rows(seed)
    return ShiftedRegression(Regression(base, target, 200), direction, SAMPLE)


@pytest.mark.parametrize("share", [-0.9, 0.0, 0.5])
def test_a_shift_within_a_sample_is_free(share: float) -> None:
    base, direction, _ = rows()
    regression = shifted(2 * base[0] + share * SAMPLE * direction)
    np.testing.assert_allclose(regression.residual, 0, atol=1e-12)


@pytest.mark.parametrize("samples", [-4.0, 3.0])
def test_a_larger_shift_is_held_at_one_sample(samples: float) -> None:
    base, direction, _ = rows()
    regression = shifted(2 * base[0] + samples * SAMPLE * direction)
    left = (samples - np.sign(samples)) * SAMPLE * Regression(base, direction, 200).residual
    np.testing.assert_allclose(regression.residual, left, atol=1e-12)


def test_what_a_candidate_explains_is_not_taken_for_a_shift() -> None:
    """The base model alone asks for a shift of many samples; with the candidate it is half of one."""
    base, direction, column = rows()
    regression = shifted(2 * base[0] + 0.5 * SAMPLE * direction + 0.3 * column)
    gained, theta = regression.explained(column[None], -UNLIMITED, UNLIMITED)
    assert theta == pytest.approx([0.3])
    assert gained == pytest.approx(float(regression.residual @ regression.residual))
    evidence = regression.test(column[None])
    assert evidence.coefficients == pytest.approx([0.3])
    assert evidence.explained == pytest.approx(1.0)
    assert evidence.gain == pytest.approx(1.0)


def test_a_shift_that_is_a_delay_is_left_for_the_candidate() -> None:
    base, direction, _ = rows()
    regression = shifted(base[0] + 5 * SAMPLE * direction)
    _, theta = regression.explained(direction[None], -UNLIMITED, UNLIMITED)
    assert theta == pytest.approx([4 * SAMPLE])


def test_units_of_torque_and_time_change_nothing() -> None:
    base, direction, column = rows(1)
    rng = np.random.default_rng(2)
    target = base[0] + 0.2 * column + 0.1 * rng.standard_normal(ROWS)
    one = ShiftedRegression(Regression(base, target, 200), direction, SAMPLE).test(column[None])
    other = ShiftedRegression(Regression(1e3 * base, 1e3 * target, 200), direction, 1e3 * SAMPLE).test(
        1e3 * column[None]
    )
    assert other.coefficients == pytest.approx(one.coefficients)
    assert other.p_value == pytest.approx(one.p_value)
    assert other.gain == pytest.approx(one.gain)


def test_a_column_that_is_not_finite_explains_nothing_and_disturbs_no_other() -> None:
    base, _, column = rows()
    regression = shifted(2 * base[0] + 0.3 * column)
    broken = np.where(np.arange(ROWS) % 2, np.inf, -np.inf)
    gained, theta = regression.explained(np.stack([broken, column]), *np.array([[-np.inf] * 2, [np.inf] * 2]))
    alone, expected = regression.explained(column[None], -UNLIMITED, UNLIMITED)
    assert gained == pytest.approx(alone)
    assert theta == pytest.approx([0, *expected])


class LateLog(SensorDelay):
    """The same delay under another name."""

    name = "late-log"


@pytest.mark.parametrize(("effect", "shifts"), [(SensorDelay, False), (LateLog, False), (TorqueOffset, True)])
def test_beside_an_effect_that_is_a_delay_there_is_no_second_shift(
    made: Callable[..., Recording], effect: type[Effect], shifts: bool
) -> None:
    """Whatever the effect is called, in the model or added to it."""
    law = Model.parse("coulomb-viscous")
    problem, found = estimate(Drive(law, 2.0), made(samples=4000))
    added = regression_of(problem, found.parameters, np.zeros((0, problem.rows)), effect())
    assert isinstance(added, ShiftedRegression) is shifts
    model = law.plus(effect())
    values = {**found.parameters, **{p.key: 0.0 for p in model.parameters if p.key not in found.parameters}}
    inside = WeakFormProblem.of(Drive(model, 2.0), problem.recording, values)
    assert isinstance(regression_of(inside, values), ShiftedRegression) is shifts


def test_half_a_sample_is_taken_out_to_the_second_order(made: Callable[..., Recording]) -> None:
    """Motion from the even samples and torque from the odd ones: without the known shift its square is left."""
    recording = made(noise=0.0, rate=120.0, samples=8000)
    late = recording.select(np.arange(0, 8000, 2)).with_channels(derived=False, torque=recording.torque[1::2])
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), late)
    assert found.shift == pytest.approx(0.5 / 60.0, rel=0.1)
    assert problem.shift == found.shift
    left = [
        float(np.sum(regression_of(replace(problem, shift=shift), found.parameters).loss))
        for shift in (0.0, found.shift)
    ]
    assert left[1] < 0.5 * left[0]
