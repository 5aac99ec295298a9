"""The torque that a simulated drive needs to follow a motion: its own equations, solved for the motor's torque.

The bound for every model: what feed-forward from complete knowledge of the drive can do.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.rig.motion import _past, accelerations, aged, excess, friction_torque, weakening_ratio
from fricmodels.rig.physics import (
    RIGID,
    RIPPLE,
    applied_torques,
    bristles,
    compiled,
    known_load,
    slow_factors,
    wave,
)

if TYPE_CHECKING:
    from fricmodels.rig.rig import Rig

_HELD = 0.9
"""Share that is held at rest of what bent contacts carry: a drive that is known to a tenth is not pushed on by it."""
_REST = 1e-9
"""A reference slower than this share of its fastest rests; so does a model's compensation, at a width of 1e-6."""


def true_torque(rig: Rig, interval: float, motion: Array, load: Array, *, origin: float = 0.0) -> Array:
    """Return the motor torque under which the drive follows a motion, shape (N,).

    At rest dry friction is left out, which opposes motion and is there to hold, and nine tenths are held of what bent
    contacts carry. Bristles, ageing contacts and a load behind a joint are followed from rest along the motion.

    Args:
        rig: the drive. interval: between two rows [s].
        motion: position, velocity and acceleration of the motor, shape (N, 3), finely sampled.
        load: load torque put on from outside, shape (N,).
        origin: time of the first row, on the clock by which the drive warms and drifts [s].
    """
    torque = np.zeros(len(load))
    rest = _REST * float(np.max(np.abs(motion[:, 1]))) if len(motion) else 0.0
    _invert(rig._physics(), np.ascontiguousarray(motion), np.ascontiguousarray(load), interval, origin, rest, torque)
    return torque


@compiled
def _invert(p: Any, motion: Any, load: Any, step: float, origin: float, rest: float, torque: Any) -> None:
    n = motion.shape[0]
    speeds = motion[:, 1].copy()
    behind = p.lag / step
    elastic, two = p.presliding != RIGID, p.load_inertia > 0.0
    z = (0.0, 0.0, 0.0, 0.0)
    q2, w2 = motion[0, 0], motion[0, 1]
    s2 = 0.0 if w2 == 0.0 else math.copysign(1.0, w2)
    dwell, peak, s1 = 0.0, 0.0, 0.0
    for k in range(n):
        slow = slow_factors(p, origin + k * step)
        q1, w1, a1 = motion[k, 0], motion[k, 1], motion[k, 2]
        lagged = _past(speeds, k - behind, k) if behind > 0.0 else 0.0
        travel = q1 - motion[k - 1, 0] if k > 0 else 0.0
        resting = abs(w1) <= rest
        if resting:
            dwell = dwell + step if s1 == 0.0 else 0.0
            s1, peak = 0.0, 0.0
        else:
            if s1 == 0.0:
                peak = aged(p, dwell)
            elif peak != 0.0:
                peak *= math.exp(-abs(travel) / p.ageing_distance)
            s1 = math.copysign(1.0, w1)
        carried = (0.0, 0.0)
        known = known_load(p, q1 if not two else q2, load[k])
        if elastic:
            ratio = weakening_ratio(p, w1, q1, known, slow, peak)
            z, carried = bristles(p, z, travel, ratio)
        if resting:
            tiny = 1e-3 * rest
            up = friction_torque(p, 1.0, tiny, lagged, q1, known, slow, peak, carried)
            down = friction_torque(p, -1.0, -tiny, lagged, q1, known, slow, peak, carried)
            friction = _HELD * min(abs(up), abs(down)) * math.copysign(1.0, up) if up * down > 0.0 else 0.0
        else:
            friction = friction_torque(p, s1, w1, lagged, q1, known, slow, peak, carried)
        without, _ = applied_torques(p, q1, w1, q2, w2, 0.0, known)
        gain = 1.0 + p.gain
        if p.wave_count > 0:
            gain *= 1.0 + wave(p, RIPPLE, q1)
        torque[k] = (p.motor_inertia * a1 + friction - without) / gain
        if two and k + 1 < n:
            later = motion[k + 1]
            q2, w2, s2 = _carried_along(p, q1, w1, later[0], later[1], q2, w2, s2, load[k], load[k + 1], step, slow)


@compiled
def _carried_along(
    p: Any,
    q1: float,
    w1: float,
    q1n: float,
    w1n: float,
    q2: float,
    w2: float,
    s2: float,
    g0: float,
    g1: float,
    h: float,
    slow: Any,
) -> Any:
    """Advance the load behind the joint by a step in which the motor moves as prescribed; Heun's rule."""
    x = (q1, w1, q2, w2, 0.0)
    if s2 == 0.0:
        beyond = excess(p, x, 2, 0.0, g0, 0.0, slow, 0.0)
        if beyond == 0.0:
            return q2, 0.0, 0.0
        s2 = math.copysign(1.0, beyond)
    _, b0 = accelerations(p, x, 0.0, s2, 0.0, g0, 0.0, slow, (0.0, 0.0))
    y = (q1n, w1n, q2 + h * w2 + 0.5 * h * h * b0, w2 + h * b0, 0.0)
    _, b1 = accelerations(p, y, 0.0, s2, 0.0, g1, 0.0, slow, (0.0, 0.0))
    w = w2 + 0.5 * h * (b0 + b1)
    if w * s2 < 0.0:
        return q2 + 0.5 * h * w2, 0.0, 0.0
    return q2 + h * w2 + h * h * (2.0 * b0 + b1) / 6.0, w, s2
