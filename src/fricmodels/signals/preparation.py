"""Gives every recording a velocity and an acceleration."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, PositiveInt

from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals.butterworth import butterworth, central_difference
from fricmodels.signals.lanczos import best_half_width, lanczos_derivative
from fricmodels.signals.segments import stretches


class Preparation(BaseModel):
    """How velocity and acceleration are found.

    Attributes:
        method: ``lanczos``, local least squares (any sampling); or ``butterworth``, zero-phase low-pass filter
            and central differences (even sampling), the usual recipe for robots.
        half_width: of the Lanczos differentiator, in samples; found from the noise if not given.
        smooth_velocity: whether a measured velocity is replaced by its smoothed one.
        cutoff: of the Butterworth filter [Hz].
        order: of the Butterworth filter, which is run forth and back.
        decimate: keep every so many-th sample after all filtering; torque is then low-pass filtered before
            (8th-order Chebyshev type I, zero phase), as the other channels are.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    method: Literal["lanczos", "butterworth"] = "lanczos"
    half_width: PositiveInt | None = None
    smooth_velocity: bool = False
    cutoff: PositiveFloat = 100.0
    order: PositiveInt = 4
    decimate: PositiveInt = Field(default=1)


def prepare(recording: Recording, preparation: Preparation | None = None) -> Recording:
    """Return the recording with ``velocity`` and ``acceleration``, measured or derived.

    What was measured stays as it is. Nothing is smeared over runs or gaps in time.

    Raises:
        InputError: when neither velocity nor position is there, or the sampling does not allow the filter.
    """
    settings = preparation or Preparation()
    if "velocity" not in recording and "position" not in recording:
        raise InputError(f"recording '{recording.name}' has neither velocity nor position")
    result = _lanczos(recording, settings) if settings.method == "lanczos" else _butterworth(recording, settings)
    return _decimate(result, settings.decimate) if settings.decimate > 1 else result


def _lanczos(recording: Recording, settings: Preparation) -> Recording:
    result = recording
    if "velocity" not in result:
        _, velocity = lanczos_derivative(result.time, result["position"], settings.half_width, result.run)
        result = result.with_channels(velocity=velocity)
    needed = "acceleration" not in result
    if needed or settings.smooth_velocity:
        width = settings.half_width or best_half_width(result.time, result.velocity, result.run)
        smooth, acceleration = lanczos_derivative(result.time, result.velocity, width, result.run)
        if settings.smooth_velocity and "velocity" not in result.derived:
            result = result.with_channels(velocity=smooth)
        if needed:
            result = result.with_channels(acceleration=acceleration)
    return result


def _butterworth(recording: Recording, settings: Preparation) -> Recording:
    time, run = recording.time, recording.run
    result = recording
    if "velocity" not in result:
        position = butterworth(time, result["position"], settings.cutoff, settings.order, run)
        result = result.with_channels(position=position, velocity=central_difference(time, position, run))
    elif settings.smooth_velocity or "acceleration" not in result:
        smooth = butterworth(time, result.velocity, settings.cutoff, settings.order, run)
        acceleration = central_difference(time, smooth, run)
        if settings.smooth_velocity:
            result = result.with_channels(velocity=smooth)
        if "acceleration" not in result:
            result = result.with_channels(acceleration=acceleration)
    if "acceleration" not in result:
        result = result.with_channels(acceleration=central_difference(time, result.velocity, run))
    return result


def _decimate(recording: Recording, factor: int) -> Recording:
    """Keep every factor-th sample of each stretch, after a zero-phase anti-aliasing filter."""
    from scipy.signal import decimate

    parts = [part for part in stretches(recording.time, recording.run) if part.stop - part.start > 30 * factor]
    if not parts:
        raise InputError(f"recording '{recording.name}' is too short to keep every {factor}th sample only")
    kept = np.concatenate([np.arange(part.start, part.stop, factor) for part in parts])
    channels = {
        name: values[kept] if name == "time" else np.concatenate([decimate(values[part], factor) for part in parts])
        for name, values in recording.channels.items()
    }
    return recording.select(kept).with_channels(
        derived=False, **{name: v for name, v in channels.items() if name not in recording.derived}
    ).with_channels(**{name: v for name, v in channels.items() if name in recording.derived})  # fmt: skip
