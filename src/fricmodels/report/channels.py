"""Over which channel an effect is seen best."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.model import Model
from fricmodels.recording import OTHER, Recording, channel_of
from fricmodels.report.figures.against import SINCE_REVERSAL, TORQUE_RATE
from fricmodels.report.figures.residuals import changing

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.results.diagnosis import Remaining
    from fricmodels.term import Effect


def shown_over(comparison: Comparison, effect: Effect, parameters: Mapping[str, Any]) -> tuple[str, float | None]:
    """Return the channel over which an effect shows, and its period in it, if it has one."""
    model = Model.only(effect)
    periodic = next((p.symbol for p in effect.parameters if p.periodic), None)
    number_of_waves = parameters.get(periodic) if periodic else (1.0 if effect.angular else None)
    period = 2 * np.pi / abs(number_of_waves) if number_of_waves else None
    if model.states:
        return SINCE_REVERSAL, None
    mapped = changing(comparison)
    channels = [channel_of(signal) for signal in sorted(model.needs - {"velocity"})]
    for channel in channels:
        if channel in mapped:
            return channel, period
    return next((channel for channel in channels if channel in ("torque", TORQUE_RATE)), "velocity"), None


_PREDICTED_BY = {
    "rate of the motor torque": TORQUE_RATE,
    "motor torque shortly before": TORQUE_RATE,
    "motor torque": "torque",
    "load torque": "load_torque",
    "position": "position",
    "acceleration": "acceleration",
    "temperature": "temperature",
    "distance since the last reversal": SINCE_REVERSAL,
    "time since the last reversal": SINCE_REVERSAL,
    "time since motion began": "velocity",
    "time": "time",
}
"""What predicts an error, by how it begins → the channel over which that shows."""


def channel_of_rest(rest: Remaining, recording: Recording) -> str:
    """Return the channel over which to show what remains: that of its place, or the one that predicts it."""
    if rest.place is not None:
        return "velocity" if rest.place.channel == "speed" else rest.place.channel
    further = {name.removeprefix(OTHER).replace("_", " "): name for name in recording.further}
    known = {**_PREDICTED_BY, **further}
    return next((channel for begin, channel in known.items() if rest.channel.startswith(begin)), "velocity")
