"""A drive behind a sampled controller, integrated step by step.

With the torque of the motor τ on the left, and what acts against it on the right, at the motor:

    J dω/dt = τ·(1 − r·cos(k_r·q + p_r)) − τ_L(t) − W(q, t) − V·v(t)·ω − a_v·|ω| − contact − R,
    L = (K_c + F_s·exp(−(s/ω_s)^δ) + A·√|ω| + B·ω² + μ·|τ_L| + P(q) + F_r·z_r)·f(t),

W is what acts whichever way the drive moves: an offset, gravity, a spring, two waves of the position, a bump, a rope
that pulls on one side of a place, and a disturbance. R is dry friction: L + a while it moves forwards, L − a backwards;
where the speed would change its sign within a step, the drive stands still as long as the torque on it lies between
those (Moreau's time stepping, semi-implicit Euler). The speed s is |ω|, or |ω| behind a first-order lag. z_r grows to
one at rest, dz_r/dt = (1 − z_r)/T_r − |ω|·z_r/x_r. With an elastic contact R = L·z + a·z, dz/dq = (sgn ω − z)/x_s.
A link behind a spring or a gap has a mass and dry friction of its own. The motor follows the command with a time
constant, dτ/dt = (u − τ)/T.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Plant(NamedTuple):
    """True parameters of one drive in SI units (N m and rad, or N and m); 0 is absent."""

    inertia: float
    coulomb: float
    viscous: float
    torque_time: float
    asymmetry_dry: float = 0.0
    asymmetry_viscous: float = 0.0
    stribeck_rise: float = 0.0
    stribeck_speed: float = 1.0
    stribeck_exponent: float = 1.0
    lag_time: float = 0.0
    square_root: float = 0.0
    square: float = 0.0
    load_friction: float = 0.0
    ageing_rise: float = 0.0
    ageing_time: float = 1.0
    ageing_distance: float = 1.0
    friction_wave: float = 0.0
    friction_wave_number: float = 0.0
    friction_wave_phase: float = 0.0
    friction_bump: float = 0.0
    bump_torque: float = 0.0
    bump_place: float = 0.0
    bump_width: float = 1.0
    presliding_distance: float = 0.0
    offset: float = 0.0
    gravity_cosine: float = 0.0
    gravity_sine: float = 0.0
    stiffness: float = 0.0
    neutral: float = 0.0
    wave: float = 0.0
    wave_number: float = 0.0
    wave_phase: float = 0.0
    second_wave: float = 0.0
    second_wave_number: float = 0.0
    second_wave_phase: float = 0.0
    ripple: float = 0.0
    ripple_wave_number: float = 0.0
    ripple_phase: float = 0.0
    rope_torque: float = 0.0
    rope_place: float = 0.0
    link_inertia: float = 0.0
    link_frequency: float = 0.0
    """Angular frequency of the link on its spring, with the motor held [rad/s]."""
    link_damping_ratio: float = 0.0
    link_gap: float = 0.0
    link_friction: float = 0.0


class Loop(NamedTuple):
    """The controller, once a period: u = K_v·(e + ∫e dt/T_i) + J·dω_r/dt + V·ω_r, e = ω_r + K_p·(q_r − q) − ω.

    q is read from an encoder, ω is its difference through a first-order low-pass; the integral stops at the limit.
    """

    closed: bool
    rate: float
    position_gain: float
    velocity_gain: float
    integral_gain: float
    feed_inertia: float
    feed_viscous: float
    limit: float
    resolution: float
    filter_share: float


class Course(NamedTuple):
    """What happened at the beginning of each period of the controller; shapes (periods,).

    Attributes:
        position, velocity: true ones.
        seen_position, seen_velocity: those that the controller has.
        command: that begins to act.
        torque: of the motor. mean_torque: over the period that begins.
        load: known load torque.
        hidden: mean over the period of all that is beyond inertia, viscous and Coulomb friction and load; elastic
            contact, a link and delays left out.
    """

    position: Array
    seen_position: Array
    seen_velocity: Array
    velocity: Array
    command: Array
    torque: Array
    load: Array
    mean_torque: Array
    hidden: Array


@njit(cache=True)
def _bump(p: Plant, q: float) -> float:
    return math.exp(-0.5 * ((q - p.bump_place) / p.bump_width) ** 2)


@njit(cache=True)
def _whichever_way(p: Plant, q: float) -> float:
    """Return W without the disturbance."""
    total = p.offset + p.gravity_cosine * math.cos(q) + p.gravity_sine * math.sin(q) + p.stiffness * (q - p.neutral)
    if p.wave != 0.0:
        total += p.wave * math.cos(p.wave_number * q + p.wave_phase)
    if p.second_wave != 0.0:
        total += p.second_wave * math.cos(p.second_wave_number * q + p.second_wave_phase)
    if p.bump_torque != 0.0:
        total += p.bump_torque * _bump(p, q)
    if q > p.rope_place:
        total += p.rope_torque
    return total


@njit(cache=True)
def _level(p: Plant, q: float, speed: float, followed: float, load: float, age: float) -> float:
    """Return L without its factor; ``followed`` is the speed behind its lag."""
    level = p.coulomb + p.square * speed * speed + p.load_friction * abs(load) + p.ageing_rise * age
    if p.stribeck_rise != 0.0:
        level += p.stribeck_rise * math.exp(-((followed / p.stribeck_speed) ** p.stribeck_exponent))
    if p.square_root != 0.0:
        level += p.square_root * math.sqrt(speed)
    if p.friction_wave != 0.0:
        level += p.friction_wave * math.cos(p.friction_wave_number * q + p.friction_wave_phase)
    if p.friction_bump != 0.0:
        level += p.friction_bump * _bump(p, q)
    return level


@njit(cache=True)
def _contact(p: Plant, twist: float, rate: float) -> float:
    """Return what the motor gives to the link: a spring with a damper, which behind a gap only pushes."""
    stiffness = p.link_inertia * p.link_frequency**2
    damping = 2.0 * p.link_damping_ratio * p.link_frequency * p.link_inertia
    if p.link_gap == 0.0:
        return stiffness * twist + damping * rate
    over = abs(twist) - 0.5 * p.link_gap
    if over <= 0.0:
        return 0.0
    side = math.copysign(1.0, twist)
    return side * max(stiffness * over + damping * rate * side, 0.0)


@njit(cache=True)
def _braked(free: float, most_forwards: float, most_backwards: float) -> float:
    """Return a speed after a step of dry friction, which takes at most so much of it and never turns it round."""
    if free > most_forwards:
        return free - most_forwards
    if free < -most_backwards:
        return free + most_backwards
    return 0.0


@njit(cache=True)
def run(p: Plant, loop: Loop, reference: Array, inputs: Array, substeps: int) -> Array:
    """Integrate one recording; return the fields of :class:`Course`, shape (9, periods).

    Args:
        p: the drive.
        loop: the controller.
        reference: position, velocity and acceleration, shape (3, periods).
        inputs: torque of an open loop, factors f of dry and v of viscous friction, disturbance, known load, shape
            (5, periods).
        substeps: integration steps in a period.
    """
    periods = reference.shape[1]
    out = np.empty((9, periods))
    period = 1.0 / loop.rate
    h = period / substeps
    q = q_link = reference[0, 0]
    w = w_link = followed = seen_velocity = integral = torque = z = 0.0
    age = 1.0
    last = math.floor(q / loop.resolution) * loop.resolution
    inertia = p.inertia - p.link_inertia
    for k in range(periods):
        factor, viscous, load = inputs[1, k], p.viscous * inputs[2, k], inputs[4, k]
        seen = math.floor(q / loop.resolution) * loop.resolution
        seen_velocity += loop.filter_share * ((seen - last) * loop.rate - seen_velocity)
        last = seen
        command = inputs[0, k]
        if loop.closed:
            error = reference[1, k] + loop.position_gain * (reference[0, k] - seen) - seen_velocity
            integral += loop.integral_gain * error * period
            wanted = loop.velocity_gain * error + integral
            wanted += loop.feed_inertia * reference[2, k] + loop.feed_viscous * reference[1, k]
            command = min(max(wanted, -loop.limit), loop.limit)
            if command != wanted:
                integral -= loop.integral_gain * error * period
        out[0, k], out[1, k], out[2, k], out[3, k] = q, seen, seen_velocity, w
        out[4, k], out[5, k], out[6, k] = command, torque, load
        total, hidden = 0.0, 0.0
        for _ in range(substeps):
            torque += h / p.torque_time * (command - torque)
            acting = torque * (1.0 - p.ripple * math.cos(p.ripple_wave_number * q + p.ripple_phase))
            outside = _whichever_way(p, q) + inputs[3, k]
            speed = abs(w)
            if p.lag_time > 0.0:
                followed += h / p.lag_time * (speed - followed)
            else:
                followed = speed
            if p.ageing_rise != 0.0:
                age = max(age + h * ((1.0 - age) / p.ageing_time - speed * age / p.ageing_distance), 0.0)
            level = factor * _level(p, q, speed, followed, load, age)
            push = acting - outside - load - viscous * w - p.asymmetry_viscous * speed
            if p.link_inertia > 0.0:
                contact = _contact(p, q - q_link, w - w_link)
                push -= contact
                most = h * p.link_friction / p.link_inertia
                w_link = _braked(w_link + h * contact / p.link_inertia, most, most)
                q_link += h * w_link
            if p.presliding_distance > 0.0:
                side = 1.0 if w > 0.0 else -1.0
                z = side + (z - side) * math.exp(-speed * h / p.presliding_distance)
                w += h / inertia * (push - (level + p.asymmetry_dry) * z)
            else:
                forwards, backwards = level + p.asymmetry_dry, level - p.asymmetry_dry
                w = _braked(w + h / inertia * push, h / inertia * forwards, h / inertia * backwards)
            q += h * w
            way = 1.0 if w > 0.0 else (-1.0 if w < 0.0 else 0.0)
            total += torque
            hidden += outside + torque - acting + (level - p.coulomb) * way + p.asymmetry_dry * abs(way)
            hidden += p.asymmetry_viscous * speed + (viscous - p.viscous) * w
        out[7, k], out[8, k] = total / substeps, hidden / substeps
    return out


def simulate(plant: Plant, loop: Loop, reference: Array, inputs: Array, substeps: int) -> Course:
    """Return the course of one recording; see :func:`run`."""
    return Course(*run(plant, loop, reference, inputs, substeps))
