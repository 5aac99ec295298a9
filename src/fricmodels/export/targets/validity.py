"""The range in which a fitted model is valid: a motion through all of it, and what is not determined there."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.recording import CHANNELS, OTHER, Recording
from fricmodels.results.words import COMBINED, CONTAINS_ZERO, NORMAL_95, is_combined
from fricmodels.saved import FittedModel

_SAMPLES = 4000
_SMALL = 0.01
"""Share of the friction torque by which all that a parameter may be changes it at least, if it is not determined."""


def motion_over(model: FittedModel) -> Recording:
    """Return a motion that goes through the ranges that a model is valid in, evenly, each channel at its own pace.

    Where the model remembers its way and does not look at the clock, the drive goes as far between two reversals as it
    did in the recording: a contact that bends over a millimetre is not bent all the time.
    """
    time = np.linspace(*model.ranges.get("time", (0.0, 40.0)), _SAMPLES)
    passed = 40.0 * np.arange(_SAMPLES) / _SAMPLES
    channels: dict[str, Array] = {"time": time}
    reversals, paces = 0.0, iter(np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0]))
    wanted = {*CHANNELS, *(n for n in model.document.units)} | {n for n in model.document.range if n.startswith(OTHER)}
    for name in sorted(wanted - {"time", "current", "torque_rate"}):
        low, high = model.ranges.get(name, (-1.0, 1.0))
        phase = passed * next(paces) / 2.0
        channels[name] = low + (high - low) * np.abs(2 * (phase % 1.0) - 1)
        if name == "velocity":
            reversals = 2 * float(phase[-1])
    low, high = model.ranges.get("position", (0.0, 0.0))
    way, speed = high - low, float(np.mean(np.abs(channels["velocity"])))
    if model.model.states and "time" not in model.needs and way > 0 and speed > 0:
        channels["time"] = np.linspace(0.0, reversals * way / speed, _SAMPLES)
    run = np.full(_SAMPLES, next(iter(model.document.runs), 0), dtype=np.int64)
    return Recording("range of validity", Motion(model.motion), channels, run, units=dict(model.document.units))


def friction_over(drive: Drive, values: Mapping[str, float], motion: Recording) -> Array:
    """Return the friction torque over a motion, shape (N,); what does not go with the inertia needs none."""
    return drive.friction(motion, {**values, drive.inertia_key: values.get(drive.inertia_key, 0.0)})


def doubtful(model: FittedModel) -> dict[str, str]:
    """Return key → reason of the parameters that the recording did not determine.

    Not of those whose interval holds zero, but is so small that all of it changes the friction torque by less than a
    hundredth: that they are small is known.
    """
    drive = Drive(model.model, model.inertia, model.motion)
    return _that_matter(drive, model.parameters, model.standard_errors, model.not_identified, motion_over(model))


def _that_matter(
    drive: Drive,
    values: Mapping[str, float],
    spread: Mapping[str, float],
    reasons: Mapping[str, str],
    motion: Recording,
) -> dict[str, str]:
    """Return the reasons but those of an interval that holds zero and hardly changes the friction over a motion."""
    before, found = friction_over(drive, values, motion), {}
    for key, why in reasons.items():
        if CONTAINS_ZERO in why and key in spread and key != drive.inertia_key:
            moved = {**values, key: values[key] + NORMAL_95 * spread[key]}
            if rms(friction_over(drive, moved, motion) - before) < _SMALL * rms(before):
                continue
        found[key] = why
    return found


def combined_within(reason: str, keys: Collection[str]) -> bool:
    """Whether a parameter is determined but for a combination with some others: their torque together is known then."""
    others = reason.removeprefix(COMBINED).partition(";")[0].split(",")
    return is_combined(reason) and all(other.strip() in keys for other in others)
