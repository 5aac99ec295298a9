"""Whether an effect may be a function of a channel that predicts a residual."""

from __future__ import annotations

from fricmodels.recording import OTHER, Recording
from fricmodels.term import Effect
from fricmodels.weakform.problem import WeakFormProblem

_TORQUES = frozenset({"motor_torque", "load_torque"})
"""A load is in the motor torque as well: what goes with one of them goes with the other."""
_COURSES = frozenset({"temperature", "time"})
"""A temperature has a course in time, and a sensor follows it late."""
_SIGNALS = {
    "position": frozenset({"position"}),
    "acceleration": frozenset({"acceleration"}),
    "temperature": _COURSES,
    "time": _COURSES,
    "motor torque": _TORQUES,
    "load torque": _TORQUES,
}
"""Channel in words → signals of effects that are functions of it. Every effect is one of the speed, or has its sign."""


def may_be_of(problem: WeakFormProblem, effect: Effect, channel: str) -> bool:
    """Whether an effect may be a function of a channel in words, ``"position, along the motion"``.

    Its equation tells. One with memory may be one of anything, and so may one that shifts the torque in time. Nothing
    speaks against a history, the speed, and several channels together.
    """
    wanted = _signals(problem.recording, channel)
    if not wanted or any(p.delay for p in effect.parameters):
        return True
    model = problem.alone(effect).model
    return bool(model.states or wanted & {*model.needs, *effect.channels})


def _signals(recording: Recording, channel: str) -> frozenset[str]:
    """Return the signals that a channel in words stands for; none of a history, of the speed, or of several."""
    name = channel.partition(",")[0]
    further = {known.removeprefix(OTHER).replace("_", " "): known for known in recording.channels}
    return _SIGNALS.get(name, frozenset({further[name]} if further.get(name, "").startswith(OTHER) else ()))
