"""An effect of the time itself is told from friction that wanders."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.walk import p_beside_a_walk
from fricmodels.weakform.regression import Regression

Array = NDArray[np.float64]

ROWS = 400
"""Independent rows of a drive that moves to and fro."""
SIDE = np.sign(np.sin(np.arange(ROWS) * 0.7))
PLACE = np.linspace(0.0, 1.0, ROWS)
COSINES = np.cos(np.pi * np.arange(1, 37)[:, None] * PLACE)
WAVES = np.vstack([np.ones((1, ROWS)), SIDE * COSINES, COSINES])
LINE = SIDE * (PLACE - 0.5)
BASE = np.vstack([SIDE, np.sin(np.arange(ROWS) * 0.31)])


def left(friction: Array, seed: int, noise: float = 0.3) -> Regression:
    rng = np.random.default_rng(seed)
    return Regression(BASE, SIDE * friction + noise * rng.standard_normal(ROWS), float(ROWS))


def walk(seed: int) -> Array:
    """Return a random walk, over a record about as far as one."""
    return np.asarray(np.cumsum(np.random.default_rng([seed, 7]).standard_normal(ROWS)) / np.sqrt(ROWS))


def jump(place: float) -> Array:
    return np.where(place < PLACE, 1.0, 0.0)


def test_a_line_is_there_where_nothing_walks() -> None:
    assert p_beside_a_walk(left(0.5 * PLACE, 0), WAVES, LINE[None]) < 1e-6


@pytest.mark.long
def test_of_noise_alone_the_size_holds() -> None:
    found = np.array([p_beside_a_walk(left(0.0 * PLACE, seed), WAVES, LINE[None]) for seed in range(400)])
    assert np.mean(found < 0.05) < 0.08  # 0.05 and three standard errors
    assert np.mean(found < 0.01) < 0.03


def test_a_walk_is_no_line() -> None:
    """A least-squares test finds a line in nearly every walk."""
    lines = [left(walk(seed), seed) for seed in range(200)]
    found = np.array([p_beside_a_walk(one, WAVES, LINE[None]) for one in lines])
    plain = np.array([one.test(LINE[None]).p_value for one in lines])
    assert np.mean(found < 0.01) < 0.08
    assert np.mean(plain < 0.01) > 5 * np.mean(found < 0.01)


@pytest.mark.long
@pytest.mark.parametrize("side", [SIDE, np.ones(ROWS)])
def test_a_walk_is_no_jump_where_it_goes_farthest(side: Array) -> None:
    """Of friction, and of the zero of the torque: a jump has a part of each."""
    wrong = 0
    for seed in range(60):
        one = left(SIDE * side * walk(seed), seed)
        places = np.linspace(0.1, 0.9, 20)
        columns = [np.vstack([SIDE * jump(place), jump(place)]) for place in places]
        wrong += min(len(places) * p_beside_a_walk(one, WAVES, each) for each in columns) < 0.01
    assert wrong <= 4


@pytest.mark.parametrize("size", [2.0, 3.0])
def test_a_jump_far_larger_than_the_walk_is_there(size: float) -> None:
    found = [
        p_beside_a_walk(left(0.3 * walk(s) + size * jump(0.4), s), WAVES, SIDE[None] * jump(0.4)) for s in range(9)
    ]
    assert max(found) < 1e-4


def test_it_does_not_depend_on_units_direction_or_the_order_of_columns() -> None:
    friction, columns = walk(3) + PLACE, np.vstack([LINE, SIDE * PLACE**2])
    here = p_beside_a_walk(left(friction, 3), WAVES, columns)
    one = left(friction, 3)
    larger = Regression(1e3 * BASE, -1e6 * one.target, float(ROWS))
    assert p_beside_a_walk(larger, -5.0 * WAVES, -1e-3 * columns[::-1]) == pytest.approx(here, rel=1e-6)


def test_too_few_waves_say_nothing_and_columns_of_the_model_are_no_effect() -> None:
    one = left(PLACE, 0)
    assert p_beside_a_walk(one, WAVES[[0, 1, 37]], LINE[None]) == 0.0
    assert p_beside_a_walk(one, WAVES, BASE[:1]) == 1.0


def strokes(seed: int) -> tuple[Array, Array, Array]:
    """Return the position of a drive that jogs eight times to either side, its model, and waves along its friction."""
    rng = np.random.default_rng([seed, 3])
    begins = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 1.0, 7)), [1.0]])
    places = np.cumsum(np.concatenate([[0.0], rng.choice([-1.0, 1.0], 8) * rng.uniform(0.3, 1.0, 8)]))
    position = np.interp(PLACE, begins, places)
    velocity = np.gradient(position)
    side = np.sign(velocity)
    waves = np.vstack([np.ones((1, ROWS)), side * COSINES, COSINES])
    return (position - position.mean()) / position.std(), np.vstack([side, velocity / velocity.std()]), waves


@pytest.mark.parametrize("of_friction", [True, False])
def test_a_walk_is_no_spring_where_strokes_are_few(of_friction: bool) -> None:
    found, plain = [], []
    for seed in range(100):
        position, model, waves = strokes(seed)
        noise = 0.3 * np.random.default_rng(seed).standard_normal(ROWS)
        one = Regression(model, walk(seed) * (model[0] if of_friction else 1.0) + noise, float(ROWS))
        found.append(p_beside_a_walk(one, waves, position[None], evidence=POLICY.walk_evidence))
        plain.append(one.test(position[None]).p_value)
    assert np.mean(np.array(found) < 0.01) < 0.06
    assert np.mean(np.array(plain) < 0.01) > 0.15


def test_a_spring_larger_than_the_walk_is_there() -> None:
    for seed in range(12):
        position, model, waves = strokes(seed)
        noise = 0.3 * np.random.default_rng(seed).standard_normal(ROWS)
        one = Regression(model, position + 0.3 * walk(seed) * model[0] + noise, float(ROWS))
        assert p_beside_a_walk(one, waves, position[None], evidence=POLICY.walk_evidence) < 1e-6


def test_coloured_noise_hides_no_offset() -> None:
    """It comes back to where it was many times over a record, which a walk does not."""
    for seed in range(12):
        rng, (_, model, waves) = np.random.default_rng(seed), strokes(seed)
        noise = np.zeros(ROWS)
        for i in range(1, ROWS):
            noise[i] = 0.9 * noise[i - 1] + 0.2 * rng.standard_normal()
        one = Regression(model, 0.8 + noise, float(ROWS))
        assert p_beside_a_walk(one, waves, np.ones((1, ROWS)), evidence=POLICY.walk_evidence) < 0.01


def test_what_nothing_walks_beside_is_not_asked() -> None:
    position, model, waves = strokes(0)
    hidden = [
        p_beside_a_walk(Regression(model, 0.3 * np.random.default_rng(seed).standard_normal(ROWS), float(ROWS)),
                        waves, position[None], evidence=POLICY.walk_evidence)
        for seed in range(40)
    ]  # fmt: skip
    assert np.mean(np.array(hidden) == 0.0) > 0.75, "nine in ten, as a walk is seen at 5 % of either kind"
