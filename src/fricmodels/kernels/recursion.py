"""A recursion of first order along a series, compiled; `scipy.signal` would take longer to import than most fits."""

from __future__ import annotations

import math
from typing import Any

from numba import njit


@njit(cache=True, nogil=True)
def first_order(series: Any, gain: float, factor: float, first: float, found: Any) -> None:
    """Write ``y[k] = gain * x[k] + factor * y[k - 1]``.

    Args:
        series: x, shape (N,).
        gain, factor: of what comes in, and of what was there.
        first: y before the first sample.
        found: y, to be written, shape (N,).
    """
    last = first
    for k in range(len(series)):
        last = gain * series[k] + factor * last
        found[k] = last


@njit(cache=True, nogil=True)
def first_order_lag(series: Any, time: Any, time_constant: float, found: Any) -> None:
    r"""Write what follows x with a lag of the first order, T dy/dt = x − y, from y = x on.

    Between samples x changes linearly, for which a step of length h is exact: with a = exp(−h/T) and b = (1 − a) T/h,
    y[k + 1] = a y[k] + (b − a) x[k] + (1 − b) x[k + 1].

    Args:
        series, time: x and when it was, shape (N,).
        time_constant: T.
        found: y, to be written, shape (N,).
    """
    last = series[0]
    found[0] = last
    for k in range(len(series) - 1):
        share = (time[k + 1] - time[k]) / time_constant
        left = math.exp(-share)
        linear = (1.0 - left) / share
        last = left * last + (linear - left) * series[k] + (1.0 - linear) * series[k + 1]
        found[k + 1] = last


@njit(cache=True, nogil=True)
def tangents_of_motion(velocity: Any, step: Any, rate: Any, fade: Any, push: Any, found: Any) -> None:
    """Write by how much the velocity of a drive with dry friction changes; see :mod:`fricmodels.weakform.tangent`.

    Args:
        velocity, rate: of the drive, and its acceleration, shape (N,).
        step: length of each step, shape (N − 1,).
        fade: what is left over a step of a change of the velocity at its beginning, shape (N − 1,).
        push: derivative of the acceleration by each parameter at the same velocity, shape (n, N).
        found: derivative of the velocity by each parameter, to be written, shape (n, N).
    """
    for i in range(len(push)):
        own, change = push[i], 0.0
        found[i, 0] = 0.0
        for k in range(len(step)):
            first, last, h = velocity[k], velocity[k + 1], step[k]
            if last == 0.0:
                change = 0.0
            elif first == 0.0:  # it left rest within the step, with no acceleration at first
                moving = 2.0 * last / rate[k + 1] if last * rate[k + 1] > 0.0 else h
                change = min(moving, h) * own[k + 1]
            elif first * last > 0.0:
                change = fade[k] * change + 0.5 * h * (fade[k] * own[k] + own[k + 1])
            else:  # the instant at which it turns is another one, and the acceleration jumps there
                share = first / (first - last)
                jump = rate[k + 1] / rate[k] if rate[k] != 0.0 else 0.0
                change = min(max(jump, 0.0), 1.0) * (change + share * h * own[k]) + (1.0 - share) * h * own[k + 1]
            found[i, k + 1] = change
