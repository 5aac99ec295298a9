"""The equation of motion as a linear regression: smoothed signals, windows in weak form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.recording import Recording

Array = NDArray[np.float64]

RESTING = 0.01
"""Speed below which a sample counts as standing still, as a fraction of the peak speed."""
_BLOCK = 20_000
_CUBIC = 5


@dataclass(frozen=True)
class Design:
    """Regressors and right-hand side of ``τ_m − τ_L − fixed part = Σ a_i θ_i``, in units that make all of order 1.

    Attributes:
        drive: whose equation it is.
        keys: parameters that are estimated.
        fixed: values in SI of those that are not.
        window, smoothing: samples of the bump, and of the local cubic that smooths the velocity.
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

    @property
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
        columns, offset = self._columns(middle)
        slow = np.abs(velocity) < RESTING * self.peak
        standing = np.concatenate([slow[1:] & slow[:-1], [False]])
        values = np.concatenate([columns, [middle.torque - middle.load_torque - offset, velocity, standing]])
        for start in range(0, len(middle) - self.window + 1, _BLOCK):
            stop = min(start + _BLOCK, len(middle) - self.window + 1)
            part = slice(start, stop + self.window - 1)
            rows[self.length - 1 + start : self.length - 1 + stop] = self._weak(
                middle.time[part], run.velocity[inner][part], values[:, part]
            )
        return rows

    def _columns(self, middle: Recording) -> tuple[Array, Array]:
        """Return the regressors of the estimated model parameters and what the fixed ones contribute."""
        nonlinear = [
            self.fixed[p.key]
            for p, linear in zip(self.drive.model.parameters, self.drive.model.linear, strict=True)
            if not linear
        ]
        return self.drive.regressors(middle, nonlinear)

    def _weak(self, time: Array, velocity: Array, values: Array) -> Array:
        times = sliding_window_view(time, self.window)
        duration = times[:, -1:] - times[:, :1]
        s = 2 * (times - times[:, :1]) / duration - 1
        steps = np.diff(times, axis=1)
        measure = np.zeros_like(s)
        measure[:, :-1] += 0.5 * steps
        measure[:, 1:] += 0.5 * steps
        shape = (1 - s**2) ** 3
        bump = shape * measure
        total = bump.sum(axis=1)
        slope = -12 * s * (1 - s**2) ** 2 / duration * measure
        inertial = -np.einsum("ij,ij->i", slope, sliding_window_view(velocity, self.window)) / total
        sided = shape * sided_measure(sliding_window_view(values[-2], self.window), steps, measure)
        mean = [np.einsum("ij,ij->i", sided, sliding_window_view(row, self.window)) / total for row in values[:-3]]
        right = np.einsum("ij,ij->i", bump, sliding_window_view(values[-3], self.window)) / total
        still = sliding_window_view(values[-1], self.window)[:, :-1].any(axis=1)
        regressors = mean
        key = self.drive.inertia_key
        if key in self.keys:
            regressors = [inertial, *regressors]
        else:
            right = right - self.fixed[key] * inertial
        scaled = [row * size / self.torque for row, size in zip(regressors, self.size, strict=True)]
        return np.stack([*scaled, right / self.torque, 1.0 - still], axis=1)


def sided_measure(velocity: Array, steps: Array, measure: Array) -> Array:
    """Return weights of the trapezium rule in which each sample counts for its own side of a reversal.

    Where the velocity changes its sign between two samples, the interval is divided at the crossing instead of in the
    middle, so that the Coulomb torque is integrated with the right sign.
    """
    before, after = velocity[:, :-1], velocity[:, 1:]
    crossing = (before < 0) != (after < 0)
    fall = np.where(crossing, np.abs(before) + np.abs(after), 1.0)
    shift = np.where(crossing & (fall > 0), steps * (np.abs(before) / np.where(fall > 0, fall, 1.0) - 0.5), 0.0)
    sided = measure.copy()
    sided[:, :-1] += shift
    sided[:, 1:] -= shift
    return sided


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


def cubic(samples: int) -> tuple[Array, Array]:
    """Return the weights by which the local cubic gives a velocity, and its change from sample to sample."""
    half = span(samples) // 2
    index = np.arange(-half, half + 1, dtype=float)
    fit = np.linalg.pinv(np.stack([np.ones_like(index), index, index**2, index**3], axis=1))
    return fit[0] if samples >= _CUBIC else (index == 0).astype(float), fit[1]


def span(samples: int) -> int:
    """Return how many samples the local cubic spans."""
    return max(_CUBIC, samples | 1)
