"""Gives every recording a velocity and an acceleration."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, PositiveFloat, PositiveInt

from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals.butterworth import butterworth, central_difference, decimate, settled
from fricmodels.signals.lanczos import lanczos_value
from fricmodels.signals.noise_level import best_half_width
from fricmodels.signals.segments import stretches


class Preparation(BaseModel):
    """How velocity and acceleration are found.

    Attributes:
        method: ``lanczos``, local least squares (any sampling); or ``butterworth``, zero-phase low-pass filter
            and central differences (even sampling), the usual recipe for robots, which loses the samples at the
            borders of a stretch where the filter has not settled.
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
    decimate: PositiveInt = 1


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
    return decimated(result, settings.decimate) if settings.decimate > 1 else result


def _lanczos(recording: Recording, settings: Preparation) -> Recording:
    result = recording
    if "velocity" not in result:
        width = settings.half_width or best_half_width(result.time, result["position"], result.run)
        result = with_derived_velocity(result, width)
    needed = "acceleration" not in result
    if needed or settings.smooth_velocity:
        width = settings.half_width or best_half_width(result.time, result.velocity, result.run)
        velocity = result.velocity
        if settings.smooth_velocity and "velocity" not in result.derived:
            result = result.with_channels(velocity=lanczos_value(result.time, velocity, width, result.run))
        if needed:
            slope = lanczos_value(result.time, velocity, width, result.run, order=1)
            result = result.with_channels(acceleration=slope)
    return result


def with_derived_velocity(recording: Recording, half_width: int) -> Recording:
    """Return the recording with the velocity derived from its position over 2h + 1 samples."""
    velocity = lanczos_value(recording.time, recording["position"], half_width, recording.run, order=1)
    return replace(recording.with_channels(velocity=velocity), derived_over=half_width)


def _butterworth(recording: Recording, settings: Preparation) -> Recording:
    time, run = recording.time, recording.run
    if "velocity" in recording:
        velocity = butterworth(time, recording.velocity, settings.cutoff, settings.order, run)
    else:
        position = butterworth(time, recording["position"], settings.cutoff, settings.order, run)
        velocity = central_difference(time, position, run)
    result = recording
    if "velocity" not in recording or settings.smooth_velocity:
        result = result.with_channels(velocity=velocity)
    if "acceleration" not in recording:
        result = result.with_channels(acceleration=central_difference(time, velocity, run))
    return result.select(settled(time, settings.cutoff, settings.order, run))


def decimated(recording: Recording, factor: int) -> Recording:
    """Keep every factor-th sample of each stretch, after a zero-phase anti-aliasing filter on every channel.

    Raises:
        InputError: for a recording without a stretch that is long enough.
    """
    parts = [part for part in stretches(recording.time, recording.run) if part.stop - part.start > 30 * factor]
    if not parts:
        raise InputError(f"recording '{recording.name}' is too short to keep every {factor}th sample only")
    kept = np.concatenate([np.arange(part.start, part.stop, factor) for part in parts])
    even = {
        name: np.concatenate([decimate(values[part], factor) for part in parts])
        for name, values in recording.channels.items()
        if name != "time"
    }
    channels = {"time": recording.time[kept], **even}
    return replace(recording.select(kept), channels=channels, derived_over=-(-recording.derived_over // factor))
