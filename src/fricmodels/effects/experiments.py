"""Experiments that tell several effects apart, in words: see :attr:`fricmodels.term.Effect.separated_from`."""

from __future__ import annotations

SEVERAL_FREQUENCIES = "several frequencies: repeat the motion faster and slower"
SLOW_REVERSALS = "slow reversals at several accelerations, and rests of different lengths"
SMALL_REVERSALS = "small reversals recorded with a fine position sensor, at several accelerations"
WIDER_RANGE = "a wider position range: where the drive turns, a full turn or more"
BOTH_DIRECTIONS = "pass the same positions in both directions and with different torques"
ANOTHER_LOAD = "another load: losses under load change with it, and a constant torque does not"
NEW_RECORD = "a new record of the same motion: a jump is at one instant only"
WARM_START = "a run that begins warm, or cools again, so that the temperature does not go with the time"
OUT_OF_STEP = "a recording in which the joints move out of step, or one of them alone"
MORE_RUNS = "more runs, in another order"
