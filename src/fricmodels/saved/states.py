"""A model beside a loop: what it remembers between two samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.memory import MemoryStep
from fricmodels.model import Model
from fricmodels.simulation import advanced
from fricmodels.stick_slip import pushing_signals


@dataclass(frozen=True)
class Along:
    """What a model remembers of a measured motion: its internal states, and the signals of the last sample."""

    states: tuple[float, ...]
    signals: Mapping[str, float]


@dataclass(frozen=True)
class Moving:
    """A drive at one instant.

    Attributes:
        velocity: [rad/s or m/s]. position: [rad or m]. time: [s].
        states: internal states of the model, in its order.
    """

    velocity: float = 0.0
    position: float = 0.0
    time: float = 0.0
    states: tuple[float, ...] = ()


def along(
    model: Model,
    memory: MemoryStep,
    torque: Callable[..., Any],
    parameters: Array,
    before: Along | None,
    interval: float,
    signals: Mapping[str, float],
) -> tuple[float, Along]:
    """Return the torque at a sample, and the memory there; see :meth:`fricmodels.FittedModel.follow`."""
    present = {name: float(value) for name, value in signals.items()}
    for name in memory.needs:
        if name not in present and name in model.required:
            raise InputError(f"'{model.name}' needs the signal '{name}' at every sample; give it as {name}=…")
        present.setdefault(name, 0.0)
    if before is None or not model.states:
        states = memory.first(present, parameters)
    elif not interval > 0:
        raise InputError(f"the interval since the last sample must be positive, got {interval}")
    else:
        states = memory(before.states, before.signals, present, interval, parameters)
    value = torque(states=states, channels={name: v for name, v in present.items() if name in model.signals})
    return float(value), Along(states, present)


def begun(model: Model, velocity: float, position: float, time: float) -> Moving:
    """Return a drive whose internal states are as declared."""
    states = tuple(float(state.initial) for state in model.states)
    return Moving(float(velocity), float(position), float(time), states)


def moved(
    drive: Drive,
    values: Mapping[str, float],
    width: float,
    before: Moving,
    torque: float,
    interval: float,
    signals: Mapping[str, float],
) -> Moving:
    """Return the drive an interval later; see :meth:`fricmodels.FittedModel.step`."""
    if not interval > 0:
        raise InputError(f"the interval must be positive, got {interval}")
    held = {"motor_torque": float(torque), "load_torque": 0.0, "motor_torque_rate": 0.0, **signals}
    for name in pushing_signals(drive):
        if name not in held and name != "time":
            raise InputError(f"'{drive.model.name}' needs '{name}' at every step; give it as {name}=…")
    wrong = next((name for name, value in held.items() if not math.isfinite(value)), None)
    if wrong is not None:
        raise InputError(f"the {wrong.replace('_', ' ')} is no finite number, got {held[wrong]}")
    begin, end = {**held, "time": before.time}, {**held, "time": before.time + interval}
    state = (before.velocity, before.position, *before.states)
    velocity, position, *states = advanced(drive, values, state, begin, end, interval, width)
    return Moving(velocity, position, before.time + interval, tuple(states))
