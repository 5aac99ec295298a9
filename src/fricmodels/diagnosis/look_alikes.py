"""Which experiment would tell effects apart that explain the same data.

The effects themselves declare it, for those that are often taken for each other. Of any other two it follows from what
they go with: where the one uses a signal that the other does not, the signal must change while the motion stays.
"""

from __future__ import annotations

from itertools import combinations

from fricmodels import plugins
from fricmodels.model import Model
from fricmodels.recording import OTHER, RATE, RUN
from fricmodels.results.experiments import (
    ANOTHER_DAY,
    ANOTHER_PLACE,
    BOTH_DIRECTIONS,
    MORE_RUNS,
    ONE_AT_A_TIME,
    OTHER_LOADS,
    OUT_OF_STEP,
    SEVERAL_FREQUENCIES,
    SLOW_REVERSALS,
    SMALL_REVERSALS,
    THERMOMETER,
    WIDER_SPEED,
)

_MEMORY = "what went before"
_CHANGED = {
    OTHER: OUT_OF_STEP,
    RUN: MORE_RUNS,
    "time": ANOTHER_DAY,
    "temperature": THERMOMETER,
    "load_torque": OTHER_LOADS,
    "position": ANOTHER_PLACE,
    _MEMORY: SLOW_REVERSALS,
    "motor_torque_rate": SEVERAL_FREQUENCIES,
    "motor_torque": SEVERAL_FREQUENCIES,
    "acceleration": SEVERAL_FREQUENCIES,
}
"""What one of two effects goes with → the experiment that changes it; what is surest to tell them first."""
_IN_BOTH = {OTHER: ONE_AT_A_TIME, "position": BOTH_DIRECTIONS, _MEMORY: SMALL_REVERSALS}
"""What both go with → the experiment that shows its form."""


def experiment(first: str, second: str) -> str:
    """Return the experiment that would separate two effects, in words."""
    return declared(first, second) or _by_signals(*sorted((first, second)))


def declared(first: str, second: str) -> str:
    """Return the experiment that either of two effects declares; empty where neither does."""
    effects = plugins.load().effects
    one, other = sorted(name.partition("(")[0] for name in (first, second))
    return effects[one].separated_from.get(other) or effects[other].separated_from.get(one, "")


def separated_by(members: list[str]) -> str:
    """Return the experiments that would separate the members of a class, at most two; empty for a class of one."""
    texts = dict.fromkeys(experiment(first, second) for first, second in combinations(members, 2))
    return "; ".join([*texts][:2])


def _by_signals(first: str, second: str) -> str:
    one, other = _goes_with(first), _goes_with(second)
    for signal, text in _CHANGED.items():
        if (signal in one) != (signal in other):
            return text
    return next((text for signal, text in _IN_BOTH.items() if signal in one), WIDER_SPEED)


def _goes_with(name: str) -> frozenset[str]:
    """Return the signals that an effect cannot do without, and whether it remembers."""
    kind, _, argument = name.partition("(")
    model = Model.only(plugins.load().effects[kind].named(argument.removesuffix(")")))
    needed = {OTHER if signal.removeprefix(RATE).startswith(OTHER) else signal for signal in model.required}
    return frozenset(needed | ({_MEMORY} if model.states else set()))
