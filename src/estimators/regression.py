"""The equation of motion as a linear regression: smoothed signals, windows in weak form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from fricmodels.arrays import Array
from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.filtering.windowed import RESTING
from fricmodels.recording import Recording

_CUBIC = 5


@dataclass(frozen=True)
class Design:
    """Regressors and right-hand side of ``τ_m − τ_L − fixed part = Σ a_i θ_i``, in units that make all of order 1.

    Attributes:
        drive: whose equation it is.
        keys: parameters that are estimated.
        fixed: values in SI of those that are not.
        window, smoothing: samples of the test function, and of the local cubic that smooths the velocity.
        peak, torque, omega: sizes of speed, torque and frequency, for scaling.
    """

    drive: Drive
    keys: tuple[str, ...]
    fixed: Mapping[str, float]
    window: int
    smoothing: int
    peak: float
    torque: float
    omega: float

    @property
    def length(self) -> int:
        """Samples from the oldest that a window uses to the newest."""
        return self.window + span(self.smoothing) - 1

    @cached_property
    def size(self) -> Array:
        """SI size of one unit of each estimated parameter."""
        natural = Scales(force=self.torque, displacement=self.peak / self.omega, time=1 / self.omega)
        sizes = dict(zip(self.drive.keys, self.drive.parameter_scales(natural), strict=True))
        return np.array([sizes[key] for key in self.keys])

    def windows(self, run: Recording) -> Array:
        """Return a row ``[a…, z, use]`` for the window that ends at each sample of one run, shape (N, n + 2).

        ``use`` is 0 before the first whole window and where the window contains standstill: two samples in a row
        slower than a hundredth of the peak speed.
        """
        count, n, half = len(run), len(self.keys), span(self.smoothing) // 2
        rows = np.zeros((count, n + 2))
        if count < self.length:
            return rows
        inner = np.arange(half, count - half)
        velocity, acceleration = smooth(run.time, run.velocity, self.smoothing)
        middle = run.select(inner).with_channels(velocity=velocity, acceleration=acceleration)
        columns, offset = self.drive.regressors(middle, self.nonlinear)
        values = np.concatenate([columns, [middle.driving_torque - offset, velocity]])
        rows[self.length - 1 :] = self.rows(middle.time, run.velocity[inner], values)
        return rows

    def rows(self, time: Array, velocity: Array, values: Array) -> Array:
        """Return the row of each window; see :func:`estimators.window_rows.weak_rows`."""
        from estimators.window_rows import weak_rows

        found: Array = weak_rows(
            np.ascontiguousarray(time),
            np.ascontiguousarray(velocity),
            values,
            self.window,
            self.resting,
            self.inertia,
            self.size,
            self.torque,
        )
        return found

    @cached_property
    def resting(self) -> float:
        """Speed of rest [rad/s or m/s]."""
        return RESTING * self.peak

    @cached_property
    def inertia(self) -> float:
        """The inertia that is known, or not a number."""
        return float(self.fixed.get(self.drive.inertia_key, np.nan))

    @cached_property
    def nonlinear(self) -> tuple[float, ...]:
        """Values of the model parameters that are held."""
        return tuple(self.drive.model.nonlinear_of(self.fixed))


def smooth(time: Array, velocity: Array, samples: int) -> tuple[Array, Array]:
    """Return velocity and acceleration by a local cubic of an odd number of samples, at the samples that have all.

    The cubic is fitted in sample numbers; its slope is divided by the mean interval. Of fewer than five samples, which
    a cubic needs, there is one: the velocity stays as it was measured.
    """
    half = span(samples) // 2
    level, slope = cubic(samples)
    windows = sliding_window_view(velocity, len(level))
    interval = (time[2 * half :] - time[: len(time) - 2 * half]) / (2 * half)
    value = windows @ level if samples >= _CUBIC else velocity[half : len(velocity) - half]
    return value, windows @ slope / interval


@lru_cache(maxsize=64)
def cubic(samples: int) -> tuple[Array, Array]:
    """Return the weights by which the local cubic gives a velocity, and its change from sample to sample."""
    half = span(samples) // 2
    index = np.arange(-half, half + 1, dtype=float)
    fit = np.linalg.pinv(np.stack([np.ones_like(index), index, index**2, index**3], axis=1))
    return fit[0] if samples >= _CUBIC else (index == 0).astype(float), fit[1]


def span(samples: int) -> int:
    """Return how many samples the local cubic spans."""
    return max(_CUBIC, samples | 1)
