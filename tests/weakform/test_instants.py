"""The instant of a jump: the fit ends at the least squares, and its interval holds the truth."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.weakform.estimate import Estimate, estimate
from fricmodels.weakform.instants import likely_instants

TRUE = {"J": 0.01, "K_v": 0.05, "K_c": 0.3, "step-change.c": 0.1, "step-change.d": 0.0}
SAMPLES, INTERVAL = 6000, 1e-3
KEY = "step-change.t_0"


def recorded(seed: int, instant: float, begin: float = 0.0, jump: float = TRUE["step-change.c"]) -> Recording:
    """Return a drive under three sines whose Coulomb torque jumps, with noise of its torque and its velocity."""
    rng = np.random.default_rng(seed)
    time = INTERVAL * np.arange(SAMPLES)
    waves = zip(rng.uniform(0.3, 2.5, 3), rng.uniform(0.0, 6.0, 3), strict=True)
    torque = np.sum([0.4 * np.sin(2 * np.pi * f * time + phase) for f, phase in waves], axis=0)
    drive = Drive(Model.parse("coulomb-viscous+step-change"), TRUE["J"])
    made = simulate(drive, {**TRUE, "step-change.c": jump, KEY: instant}, time, torque)
    channels = {
        "time": begin + time,
        "torque": torque + 0.02 * rng.standard_normal(SAMPLES),
        "velocity": made.velocity + 0.01 * rng.standard_normal(SAMPLES),
    }
    return Recording("jump", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


def fitted(recording: Recording, start: dict[str, float] | None = None) -> Estimate:
    """Return the fit of the model that has the jump."""
    return estimate(Drive(Model.parse("coulomb-viscous+step-change"), TRUE["J"]), recording, start)[1]


@pytest.mark.parametrize("seed", range(6))
def test_it_is_found_to_a_few_samples_and_its_interval_holds_it(seed: int) -> None:
    instant = 1.5 + 0.5123 * seed
    found = fitted(recorded(seed, instant))
    assert KEY not in found.not_identified
    assert abs(found.parameters[KEY] - instant) <= 1.96 * found.standard_errors[KEY]
    rests = seed in (2, 4)  # at that instant: only how long is known
    assert found.standard_errors[KEY] < (150 if rests else 10) * INTERVAL
    assert found.parameters["step-change.c"] == pytest.approx(0.1, abs=4 * found.standard_errors["step-change.c"])


@pytest.mark.long
def test_the_fit_ends_at_the_same_instant_from_wherever_it_begins() -> None:
    recording = recorded(1, 3.0)
    ends = {fitted(recording, {KEY: start}).parameters[KEY] for start in (2.6, 2.9, 3.0, 3.05, 3.4)}
    assert len(ends) == 1


def test_it_does_not_hang_on_the_clock() -> None:
    plain, late = (fitted(recorded(2, 2.0, begin)) for begin in (0.0, 1e5))
    assert late.parameters[KEY] - 1e5 == pytest.approx(plain.parameters[KEY], abs=1e-6)
    assert late.standard_errors[KEY] == pytest.approx(plain.standard_errors[KEY], rel=1e-4)


def test_without_a_jump_no_instant_is_determined() -> None:
    found = fitted(recorded(3, 3.0, jump=0.0))
    assert KEY in found.not_identified


def test_the_interval_holds_what_leaves_hardly_more() -> None:
    """What is left grows by a hundredth a sample; with ν/f = 100 the statistic passes 7.35 after seven samples."""
    recording = recorded(0, 3.0)

    def cost(instant: float) -> float:
        return 1.0 + 0.01 * round(abs(instant - 3.0005) / INTERVAL)

    assert 1.96 * likely_instants(recording, cost, 3.0005, 100.0).error == pytest.approx(7.5 * INTERVAL, rel=1e-3)
    assert 1.96 * likely_instants(recording, cost, 3.0005, 1e9).error == pytest.approx(INTERVAL, rel=1e-3)


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_an_interval_without_an_end_says_so(side: float) -> None:
    def cost(instant: float) -> float:
        return 1.0 + max(side * (instant - 3.0), 0.0)

    assert likely_instants(recorded(0, 3.0), cost, 3.0, 100.0).error == np.inf


def test_of_a_jump_before_the_last_stroke_only_the_sum_is_known() -> None:
    """A drive moves forth and back, its Coulomb torque jumps in a rest, and then it only moves back once.

    A jump of a constant torque tells it as well, and with both the instant may lie a stroke earlier, where the two
    cancel. The jump of the Coulomb torque alone is what the fit ends with, at its instant.
    """
    rng = np.random.default_rng(11)
    time = INTERVAL * np.arange(8000)
    strokes = [(0.3, 1.0), (1.5, -1.0), (2.7, 1.0), (3.9, -1.0), (5.1, 1.0), (6.6, -1.0)]
    speed = sum(side * np.clip(np.sin(np.pi * (time - begin)), 0.0, None) * (abs(time - begin - 0.5) < 0.5)
                for begin, side in strokes)  # fmt: skip
    jump = 6.3
    acceleration = np.gradient(speed, time)
    coulomb = np.sign(speed) * (TRUE["K_c"] + 0.1 * (time >= jump))
    torque = TRUE["J"] * acceleration + TRUE["K_v"] * speed + coulomb
    channels = {
        "time": time,
        "torque": torque + 0.005 * rng.standard_normal(len(time)),
        "velocity": speed + 0.003 * rng.standard_normal(len(time)),
    }
    found = fitted(Recording("last", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))
    assert found.parameters["step-change.d"] == 0.0
    assert "only a combination" in found.not_identified["step-change.c"]
    assert found.parameters["step-change.c"] == pytest.approx(0.1, abs=0.005)
    assert 6.1 <= found.parameters[KEY] <= 6.7 or KEY in found.not_identified
