"""The simulated drive's motion: time steps between events, so that sticking and breaking away are exact.

Within a step a body either sticks or slides in one direction; its equation is then smooth and Heun's rule of second
order serves. Where a sliding body comes to rest or a sticking one breaks away inside a step, the step is cut at that
instant and begun anew (the switching treatment that Karnopp's band approximates).
"""

from __future__ import annotations

import math
from typing import Any

from fricmodels.rig.physics import (
    LUGRE,
    RIGID,
    applied_torques,
    bristles,
    compiled,
    dry_torque,
    known_load,
    slow_factors,
    viscous_torque,
)

_MOST_EVENTS = 12


@compiled
def friction_torque(
    p: Any,
    direction: float,
    w: float,
    lagged: float,
    q: float,
    load: float,
    slow: Any,
    peak: float,
    carried: Any,
) -> float:
    """Return the signed friction torque on the motor while it moves; ``carried`` are the bristles' shares."""
    speed = lagged if p.lag > 0.0 else abs(w)
    if p.presliding == RIGID:
        dry = dry_torque(p, direction, speed, q, load, slow, peak)
        return float(p.motor_share * direction * (dry + viscous_torque(p, direction, speed, slow)))
    side = 1.0 if w >= 0 else -1.0
    weakening, bent_at = 1.0, speed
    if p.presliding >= LUGRE:
        weakening, bent_at = weakening_ratio(p, w, q, load, slow, peak), 0.0
    forward, backward = carried
    elastic = 0.0
    if forward != 0.0:
        elastic += forward * dry_torque(p, 1.0, bent_at, q, load, slow, peak)
    if backward != 0.0:
        elastic += backward * dry_torque(p, -1.0, bent_at, q, load, slow, peak)
    damping = p.micro_damping * w * (1.0 - side * (forward + backward) / weakening)
    flow = side * viscous_torque(p, side, speed, slow)
    return float(p.motor_share * (elastic + damping + flow))


@compiled
def weakening_ratio(p: Any, w: float, q: float, load: float, slow: Any, peak: float) -> float:
    """Return sliding over static dry friction, which the bristles of LuGre relax to and Maxwell's blocks slip at."""
    if p.presliding < LUGRE:
        return 1.0
    side = 1.0 if w >= 0 else -1.0
    static = dry_torque(p, side, 0.0, q, load, slow, peak)
    return max(dry_torque(p, side, abs(w), q, load, slow, peak) / max(static, 1e-300), 1e-3)


@compiled
def accelerations(
    p: Any,
    x: Any,
    s1: float,
    s2: float,
    motor: float,
    given: float,
    lagged: float,
    slow: Any,
    carried: Any,
) -> Any:
    """Return the accelerations of motor and load for the state x = (q1, w1, q2, w2, peak)."""
    q1, w1, q2, w2, peak = x
    load = known_load(p, q1 if p.load_inertia == 0.0 else q2, given)
    t1, t2 = applied_torques(p, q1, w1, q2, w2, motor, load)
    a1, a2 = 0.0, 0.0
    if s1 != 0.0 or p.presliding != RIGID:
        a1 = (t1 - friction_torque(p, s1, w1, lagged, q1, load, slow, peak, carried)) / p.motor_inertia
    if p.load_inertia > 0.0 and s2 != 0.0:
        share = 1.0 - p.motor_share
        resisting = dry_torque(p, s2, abs(w2), q2, load, slow, 0.0) + viscous_torque(p, s2, abs(w2), slow)
        a2 = (t2 - share * s2 * resisting) / p.load_inertia
    return a1, a2


@compiled
def excess(p: Any, x: Any, body: int, motor: float, given: float, lagged: float, slow: Any, peak: float) -> float:
    """Return how far the torque on a sticking body is beyond what friction can hold, with the sign of the motion."""
    q1, w1, q2, w2, _ = x
    load = known_load(p, q1 if p.load_inertia == 0.0 else q2, given)
    t1, t2 = applied_torques(p, q1, w1, q2, w2, motor, load)
    torque = t1 if body == 1 else t2
    share = p.motor_share if body == 1 else 1.0 - p.motor_share
    side = 1.0 if torque > 0 else -1.0
    speed = lagged if (p.lag > 0.0 and body == 1) else 0.0
    q = q1 if body == 1 else q2
    hold = dry_torque(p, side, speed, q, load, slow, peak if body == 1 else 0.0)
    if speed > 0.0:
        hold += viscous_torque(p, side, speed, slow)
    return float(side * max(abs(torque) - share * hold, 0.0))


@compiled
def crossing(w0: float, w1: float, a0: float, a1: float, h: float) -> float:
    """Return the fraction of a step at which the velocity of Heun's rule passes zero."""
    fraction = w0 / (w0 - w1)
    for _ in range(3):
        value = w0 + fraction * h * a0 + 0.5 * fraction * fraction * h * (a1 - a0)
        slope = h * a0 + fraction * h * (a1 - a0)
        if slope == 0.0:
            break
        fraction = min(max(fraction - value / slope, 0.0), 1.0)
    return fraction


@compiled
def aged(p: Any, dwell: float) -> float:
    """Return the rise of the breakaway torque after a rest of length ``dwell``."""
    return p.ageing_rise * dwell / (dwell + p.ageing_time) if p.ageing_rise != 0.0 else 0.0


@compiled
def advance(
    p: Any,
    x: Any,
    s1: float,
    s2: float,
    dwell: float,
    z: Any,
    m0: float,
    m1: float,
    g0: float,
    g1: float,
    l0: float,
    l1: float,
    step: float,
    slow: Any,
) -> Any:
    """Advance by one sub-step; motor torque m, given load g and lagged speed l go linearly from 0 to 1."""
    elastic = p.presliding != RIGID
    two = p.load_inertia > 0.0
    done = 0.0
    for event in range(_MOST_EVENTS):
        h = (1.0 - done) * step
        if h <= 0.0:
            break
        motor = m0 + done * (m1 - m0)
        given = g0 + done * (g1 - g0)
        lagged = l0 + done * (l1 - l0)
        if s1 == 0.0 and not elastic:
            beyond = excess(p, x, 1, motor, given, lagged, slow, aged(p, dwell))
            if beyond != 0.0:
                s1 = math.copysign(1.0, beyond)
                x = (x[0], 0.0, x[2], x[3], aged(p, dwell))
        if two and s2 == 0.0:
            beyond = excess(p, x, 2, motor, given, lagged, slow, 0.0)
            if beyond != 0.0:
                s2 = math.copysign(1.0, beyond)
        ynew, zn, a0, a1, b0, b1 = _heun(p, x, s1, s2, z, motor, m1, given, g1, lagged, l1, h, slow)
        fraction, body = 1.0, 0
        if not elastic:
            if s1 != 0.0:
                if ynew[1] * s1 < 0.0:
                    fraction, body = crossing(x[1], ynew[1], a0, a1, h), 1
            elif event < _MOST_EVENTS - 1:
                at_end = excess(p, ynew, 1, m1, g1, l1, slow, aged(p, dwell + h))
                if at_end != 0.0:
                    fraction, body = _breakaway(p, x, ynew, 1, motor, m1, given, g1, lagged, l1, slow, dwell, h)
        if two and s2 != 0.0 and ynew[3] * s2 < 0.0:
            early = crossing(x[3], ynew[3], b0, b1, h)
            if early < fraction:
                fraction, body = early, 2
        if event == _MOST_EVENTS - 1:
            fraction = 1.0
        if fraction < 1.0:
            end = done + fraction * (1.0 - done)
            me, ge, le = m0 + end * (m1 - m0), g0 + end * (g1 - g0), l0 + end * (l1 - l0)
            h *= fraction
            ynew, zn, a0, a1, b0, b1 = _heun(p, x, s1, s2, z, motor, me, given, ge, lagged, le, h, slow)
            done = end
        else:
            done = 1.0
        if s1 == 0.0 and not elastic:
            dwell += h
        q1, w1, q2, w2, peak = ynew
        z = zn
        if not elastic and s1 != 0.0 and body != 1 and s1 * w1 < min(p.rest_speed, s1 * x[1]):
            body = 1
        if body == 1 and s1 != 0.0:
            w1, s1, dwell, peak = 0.0, 0.0, 0.0, 0.0
        elif body == 2:
            w2, s2 = 0.0, 0.0
        x = (q1, w1, q2, w2, peak)
    return x, s1, s2, dwell, z


@compiled
def _breakaway(
    p: Any,
    x: Any,
    y: Any,
    body: int,
    m0: float,
    m1: float,
    g0: float,
    g1: float,
    l0: float,
    l1: float,
    slow: Any,
    dwell: float,
    h: float,
) -> Any:
    low, high = 0.0, 1.0
    for _ in range(20):
        f = 0.5 * (low + high)
        at = (x[0], x[1], x[2] + f * (y[2] - x[2]), x[3] + f * (y[3] - x[3]), x[4])
        beyond = excess(
            p, at, body, m0 + f * (m1 - m0), g0 + f * (g1 - g0), l0 + f * (l1 - l0), slow, aged(p, dwell + f * h)
        )
        if beyond != 0.0:
            high = f
        else:
            low = f
    return high, body


@compiled
def _heun(
    p: Any,
    x: Any,
    s1: float,
    s2: float,
    z: Any,
    m0: float,
    m1: float,
    g0: float,
    g1: float,
    l0: float,
    l1: float,
    h: float,
    slow: Any,
) -> Any:
    q1, w1, q2, w2, peak = x
    carried = (0.0, 0.0)
    zn = z
    if p.presliding != RIGID:
        _, carried = bristles(p, z, 0.0, 1.0)
    a0, b0 = accelerations(p, x, s1, s2, m0, g0, l0, slow, carried)
    travel = h * w1 + 0.5 * h * h * a0
    worn = peak
    if peak != 0.0:
        worn = peak * math.exp(-abs(travel) / p.ageing_distance)
    if p.presliding != RIGID:
        ratio = weakening_ratio(p, w1 + 0.5 * h * a0, q1, known_load(p, q1, g0), slow, peak)
        zn, carried = bristles(p, z, travel, ratio)
    y = (q1 + travel, w1 + h * a0, q2 + h * w2 + 0.5 * h * h * b0, w2 + h * b0, worn)
    a1, b1 = accelerations(p, y, s1, s2, m1, g1, l1, slow, carried)
    end = (
        q1 + h * w1 + h * h * (2.0 * a0 + a1) / 6.0,
        w1 + 0.5 * h * (a0 + a1),
        q2 + h * w2 + h * h * (2.0 * b0 + b1) / 6.0,
        w2 + 0.5 * h * (b0 + b1),
        worn,
    )
    return end, zn, a0, a1, b0, b1


@compiled
def simulate(
    p: Any,
    torque: Any,
    reference: Any,
    feedback_noise: Any,
    load: Any,
    start: Any,
    hold: bool,
    interval: float,
    substeps: int,
    origin: float,
    fine_position: Any,
    fine_velocity: Any,
    known: Any,
    temperature: Any,
) -> None:
    """Run one record of N samples.

    Args:
        p: the physics, a record of :data:`fricmodels.rig.physics.PHYSICS`.
        torque: open-loop motor torque, or feed-forward of the closed loop, shape (N,); holds the torque applied.
        reference: position and velocity to follow, shape (N, 2); no loop is closed when both gains are 0.
        feedback_noise: noise on the velocity fed back, shape (N,).
        load: load torque put on from outside, shape (N,).
        start: position and velocity at the start.
        hold: hold the torque between samples; otherwise it goes linearly (open loop only).
        interval, substeps: sampling interval, and the number of steps in it.
        origin: time of the first sample.
        fine_position, fine_velocity: filled with the motor's motion at every sub-step, shape (N·substeps,).
        known, temperature: filled with known load and temperature, shape (N,).
    """
    n = torque.shape[0]
    step = interval / substeps
    closed = p.proportional != 0.0 or p.derivative != 0.0
    x = (start[0], start[1], start[0], start[1], 0.0)
    s1 = 0.0 if start[1] == 0.0 else math.copysign(1.0, start[1])
    s2 = s1
    dwell = 0.0
    z = (0.0, 0.0, 0.0, 0.0)
    behind = p.lag / step
    for k in range(n):
        slow = slow_factors(p, origin + k * interval)
        if closed:
            wanted = p.proportional * (reference[k, 0] - x[0])
            wanted += p.derivative * (reference[k, 1] - x[1] - feedback_noise[k])
            torque[k] = min(max(torque[k] + wanted, -p.torque_limit), p.torque_limit)
        known[k] = known_load(p, x[0] if p.load_inertia == 0.0 else x[2], load[k])
        temperature[k] = slow[4]
        last = torque[k] if hold or closed or k + 1 == n else torque[k + 1]
        load_last = load[min(k + 1, n - 1)]
        for j in range(substeps):
            i = k * substeps + j
            fine_position[i] = x[0]
            fine_velocity[i] = x[1]
            f0, f1 = j / substeps, (j + 1) / substeps
            l0, l1 = 0.0, 0.0
            if behind > 0.0:
                l0, l1 = _past(fine_velocity, i - behind, i), _past(fine_velocity, i + 1 - behind, i)
            x, s1, s2, dwell, z = advance(
                p,
                x,
                s1,
                s2,
                dwell,
                z,
                torque[k] + f0 * (last - torque[k]),
                torque[k] + f1 * (last - torque[k]),
                load[k] + f0 * (load_last - load[k]),
                load[k] + f1 * (load_last - load[k]),
                l0,
                l1,
                step,
                slow,
            )


@compiled
def _past(history: Any, index: float, newest: int) -> float:
    if index <= 0.0:
        return float(abs(history[0]))
    low = min(int(index), newest)
    high = min(low + 1, newest)
    return float(abs(history[low] + (index - low) * (history[high] - history[low])))
