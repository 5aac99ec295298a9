"""What the simulated drive's sensors make of its motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from fricmodels.arrays import Array
from fricmodels.documents import NotNegative


class Sensors(BaseModel):
    """Noise, quantisation, sampling faults, and which channels are recorded."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    velocity_noise_percent: NotNegative = 0.0
    """White noise on the velocity, in % of its RMS value."""
    torque_noise_percent: NotNegative = 0.0
    """White noise on the recorded torque, in % of its RMS value."""
    temperature_noise: NotNegative = 0.0
    """White noise on the temperature [K]."""
    encoder_step: NotNegative = 0.0
    """Quantum of the recorded position [rad or m]; 0 for a perfect encoder."""
    velocity: Literal["measured", "none"] = "measured"
    """With ``none`` the log has positions only."""
    position: bool = True
    temperature: bool | None = None
    """Record the temperature; by default where the drive warms."""
    noisy_feedback: bool = False
    """The controller sees the velocity noise too (scaled to the velocity that it asks for)."""
    jitter_percent: Annotated[float, Field(ge=0, lt=100)] = 0.0
    """Uneven sampling: instants spread evenly over this share of the interval; the stamps are true."""
    dropout_percent: Annotated[float, Field(ge=0, lt=90)] = 0.0
    """Share of samples lost, in bursts of about ``dropout_length`` samples."""
    dropout_length: Annotated[int, Field(ge=1)] = 5


@dataclass(frozen=True)
class History:
    """One run between and at the samples: motion at every sub-step, torque, load and temperature at every sample."""

    interval: float
    position: Array
    velocity: Array
    torque: Array
    load: Array
    temperature: Array
    hold: bool

    def moving(self, quantity: Array, time: Array) -> Array:
        """Return a finely stepped quantity at any times of the run, by linear interpolation."""
        step = self.interval * len(self.torque) / len(quantity)
        return _interpolate(quantity, time / step)

    def sampled(self, quantity: Array, time: Array) -> Array:
        """Return a quantity known at the samples at any times of the run, by linear interpolation."""
        return _interpolate(quantity, time / self.interval)

    def driving(self, time: Array) -> Array:
        """Return the torque in effect at any times of the run."""
        index = time / self.interval
        if self.hold:
            whole = np.floor(index + 1e-9).astype(np.int64)
            return np.asarray(self.torque[np.clip(whole, 0, len(self.torque) - 1)])
        return _interpolate(self.torque, index)


def _interpolate(values: Array, index: Array) -> Array:
    index = np.clip(index, 0.0, len(values) - 1.0)
    low = np.minimum(np.round(index, 9).astype(np.int64), max(len(values) - 2, 0))
    high = np.minimum(low + 1, len(values) - 1)
    part = np.round(index - low, 9)
    return np.asarray(values[low] + part * (values[high] - values[low]))


def instants(n: int, interval: float, sensors: Sensors, rng: np.random.Generator) -> Array:
    """Return the sampling instants of a run, from 0 on: jittered, and with bursts lost."""
    time = np.arange(n) * interval
    if sensors.jitter_percent > 0:
        time = time + interval * sensors.jitter_percent / 100 * rng.uniform(0.0, 1.0, n)
    if sensors.dropout_percent > 0:
        bursts = rng.random(n) < sensors.dropout_percent / 100 / sensors.dropout_length
        lost = np.convolve(bursts, np.ones(sensors.dropout_length), mode="full")[:n] > 0
        lost[0] = False
        time = time[~lost]
    return np.asarray(time)


def noisy(values: Array, percent: float, rng: np.random.Generator) -> Array:
    """Return the values with white noise of a percentage of their RMS value."""
    if percent == 0:
        return values
    return np.asarray(values + percent / 100 * np.sqrt(np.mean(values**2)) * rng.standard_normal(len(values)))


def quantised(values: Array, step: float) -> Array:
    """Return the values as an encoder counts them."""
    return np.asarray(np.floor(values / step) * step) if step > 0 else values
