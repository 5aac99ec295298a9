"""Zero-phase Butterworth filter and central differences, for even sampling: the usual recipe for robots.

Source: A. Janot, M. Gautier, M. Brunot, "Data Set and Reference Models of EMPS", 2019.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.errors import InputError
from fricmodels.signals.segments import Runs, stretches


def butterworth(time: Array, values: Array, cutoff: float, order: int = 4, runs: Runs | None = None) -> Array:
    """Filter forth and back with a Butterworth low-pass of ``cutoff`` [Hz]; stretches shorter than its tail stay.

    Raises:
        InputError: when the sampling is uneven, or too slow for the cut-off.
    """
    from scipy.signal import butter, filtfilt

    result = np.array(values, dtype=float)
    for part in stretches(time, runs):
        count = part.stop - part.start
        if count <= 3 * (order + 1):
            continue
        step = np.diff(time[part])
        if np.ptp(step) > 0.2 * np.median(step):
            raise InputError("a Butterworth filter needs even sampling; resample, or use the method 'lanczos'")
        rate = (count - 1) / (time[part.stop - 1] - time[part.start])
        if cutoff >= 0.5 * rate:
            raise InputError(f"the cut-off of {cutoff:g} Hz must be below half the sampling rate of {rate:g} Hz")
        b, a = butter(order, 2.0 * cutoff / rate)
        result[part] = filtfilt(b, a, result[part])
    return result


def settled(time: Array, cutoff: float, order: int, runs: Runs | None = None) -> Mask:
    """Return where the filter has settled: its slowest pole has fallen to 1 % since either border of the stretch.

    Second derivatives nearer to a border are worthless.
    """
    slowest = 2.0 * np.pi * cutoff * np.sin(np.pi / (2 * order))
    tail = np.log(100.0) / slowest
    result = np.zeros(len(time), dtype=bool)
    for part in stretches(time, runs):
        result[part] = (time[part] - time[part.start] >= tail) & (time[part.stop - 1] - time[part] >= tail)
    return result


def central_difference(time: Array, values: Array, runs: Runs | None = None) -> Array:
    """Differentiate by the parabola through three neighbours, one-sided at the borders of a stretch."""
    result = np.zeros(len(values))
    for part in stretches(time, runs):
        if part.stop - part.start >= 2:
            order: Literal[1, 2] = 2 if part.stop - part.start >= 3 else 1
            result[part] = np.gradient(values[part], time[part], edge_order=order)
    return result


def decimate(values: Array, factor: int) -> Array:
    """Keep every factor-th sample, after a zero-phase low-pass at four fifths of the new band (8th-order Chebyshev).

    Constants keep their value: the ripple of 0.05 dB that the filter has there is taken out.
    """
    from scipy.signal import cheby1, sosfiltfilt

    ripple = 0.05
    sections = cheby1(8, ripple, 0.8 / factor, output="sos")
    gain = 10.0 ** (-2.0 * ripple / 20.0)
    return np.asarray(sosfiltfilt(sections, values)[::factor] / gain)
