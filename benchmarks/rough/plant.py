"""A drive in a closed loop, integrated step by step: stick and slip, effects with memory, a link behind a gap.

The equation of motion, with what is recorded on the left of the arrow and what acts on the right:

    τ → τ_a = (1 + g + ripple(q))·τ·(1 − droop·|τ|),
    J dω/dt = τ_a − τ_L − W(q, t, dω/dt) − V(ω) − R,

W is what acts whichever way the drive moves, V what is smooth in speed, R dry friction of level L. Dry friction is
taken implicitly: a drive whose speed would change its sign within a step stands still while |torque| ≤ L (Moreau's time
stepping), so that no smooth sign is needed. With an elastic contact R = L·z + D·(ω − |ω|·z), dz/dq = (1 − z·sgn ω)/x_s.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Plant(NamedTuple):
    """True parameters of one drive, in SI units on the side of the recorded motion; 0 is absent."""

    inertia: float
    coulomb_forward: float
    coulomb_backward: float
    viscous_forward: float
    viscous_backward: float
    offset: float = 0.0
    stribeck_rise: float = 0.0
    stribeck_speed: float = 0.0
    stribeck_exponent: float = 0.0
    power_coefficient: float = 0.0
    power_exponent: float = 0.0
    load_friction: float = 0.0
    driving_loss: float = 0.0
    driven_loss: float = 0.0
    gain: float = 0.0
    gravity_sine: float = 0.0
    gravity_cosine: float = 0.0
    stiffness: float = 0.0
    neutral: float = 0.0
    payload_sine: float = 0.0
    payload_cosine: float = 0.0
    presliding_distance: float = 0.0
    presliding_damping: float = 0.0
    lag: float = 0.0
    ageing_rise: float = 0.0
    ageing_time: float = 0.0
    ageing_distance: float = 0.0
    link_inertia: float = 0.0
    gap: float = 0.0
    contact_stiffness: float = 0.0
    contact_damping: float = 0.0
    link_friction: float = 0.0
    bump_torque: float = 0.0
    bump_friction: float = 0.0
    bump_place: float = 0.0
    bump_width: float = 0.0
    zone_friction: float = 0.0
    zone_from: float = 0.0
    zone_to: float = 0.0
    zone_edge: float = 0.0
    absolute_acceleration: float = 0.0
    droop: float = 0.0


class Loop(NamedTuple):
    """The controller: τ = kp·(q_r − q) + kd·(ω_r − ω) + ki·∫(ω_r − ω) + feed-forward, held over a period."""

    kp: float
    kd: float
    ki: float
    torque_limit: float
    resolution: float
    filter_share: float
    every: int


NO_WAVES = np.zeros((0, 4))
"""Rows of kind (0 torque, 1 friction, 2 ripple), wave number, amplitude, phase."""


class Course(NamedTuple):
    """What happened, at every integration step; shapes (steps,).

    ``friction`` is all that opposes or brakes (V + R), ``pushing`` all else (τ_a − τ_L − W − contact), both at the
    motor, so that J_m (ω_{n+1} − ω_n)/h = pushing − friction.
    """

    position: Array
    velocity: Array
    torque: Array
    load: Array
    pushing: Array
    friction: Array
    deflection: Array
    age: Array
    link_position: Array
    link_velocity: Array


@njit(cache=True)
def _waves(waves: Array, kind: float, q: float) -> float:
    total = 0.0
    for i in range(waves.shape[0]):
        if waves[i, 0] == kind:
            total += waves[i, 2] * math.cos(waves[i, 1] * q + waves[i, 3])
    return total


@njit(cache=True)
def _whichever_way(p: Plant, waves: Array, q: float, acceleration: float) -> float:
    """Return W without the coupling of another joint."""
    bump = 0.0
    if p.bump_torque != 0.0:
        bump = p.bump_torque * math.exp(-(((q - p.bump_place) / p.bump_width) ** 2))
    gravity = p.gravity_sine * math.sin(q) + p.gravity_cosine * math.cos(q)
    spring = p.stiffness * (q - p.neutral)
    return p.offset + gravity + spring + _waves(waves, 0.0, q) + bump + p.absolute_acceleration * abs(acceleration)


@njit(cache=True)
def _level(p: Plant, waves: Array, q: float, way: float, speed: float, load: float, age: float, factor: float) -> float:
    """Return the level of dry friction in a direction; ``speed`` is the one that it follows."""
    level = (p.coulomb_forward if way >= 0 else p.coulomb_backward) * factor
    if p.stribeck_rise != 0.0:
        level += p.stribeck_rise * math.exp(-((speed / p.stribeck_speed) ** p.stribeck_exponent))
    level += p.load_friction * abs(load) + (p.driving_loss if load * way >= 0 else p.driven_loss) * abs(load)
    level += p.ageing_rise * age + _waves(waves, 1.0, q)
    if p.bump_friction != 0.0:
        level += p.bump_friction * math.exp(-(((q - p.bump_place) / p.bump_width) ** 2))
    if p.zone_friction != 0.0:
        rise = math.tanh((q - p.zone_from) / p.zone_edge) - math.tanh((q - p.zone_to) / p.zone_edge)
        level += p.zone_friction * 0.5 * rise
    return max(level, 0.0)


@njit(cache=True)
def _viscous(p: Plant, way: float, speed: float, factor: float) -> float:
    """Return V without its sign."""
    slope = (p.viscous_forward if way >= 0 else p.viscous_backward) * factor
    return slope * speed + (p.power_coefficient * speed**p.power_exponent if p.power_coefficient != 0.0 else 0.0)


@njit(cache=True)
def run(
    p: Plant, loop: Loop, waves: Array, reference: Array, inputs: Array, h: float, every: int
) -> tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array, Array]:
    """Integrate one run.

    Args:
        p: the drive.
        loop: the controller.
        waves: periodic torques, shape (n, 4).
        reference: position, velocity and feed-forward torque, shape (3, periods of the controller).
        inputs: known load, torque of another joint, factor of Coulomb friction, factor of viscous friction, shape
            (4, periods).
        h: integration step [s].
        every: steps between what is returned.
    """
    periods = reference.shape[1]
    steps = periods * loop.every
    out = np.empty((10, (steps + every - 1) // every))
    q, w = reference[0, 0], reference[1, 0]
    q_link, w_link = q, w
    two = p.link_inertia > 0.0
    inertia = p.inertia - p.link_inertia if two else p.inertia
    if two and p.gap > 0.0:
        q_link = q - 0.5 * p.gap * (1.0 if w >= 0 else -1.0)
    z, age, acceleration, integral = 0.0, 0.0, 0.0, 0.0
    torque, filtered = 0.0, w
    last = math.floor(q / loop.resolution) * loop.resolution if loop.resolution > 0 else q
    length = max(round(p.lag / h), 1)
    past = np.full(length, abs(w))
    period = h * loop.every
    for n in range(steps):
        k = n // loop.every
        if n % loop.every == 0:
            seen = math.floor(q / loop.resolution) * loop.resolution if loop.resolution > 0 else q
            filtered += loop.filter_share * ((seen - last) / period - filtered)
            last = seen
            error = reference[1, k] - filtered
            wanted = loop.kp * (reference[0, k] - seen) + loop.kd * error + loop.ki * integral + reference[2, k]
            torque = min(max(wanted, -loop.torque_limit), loop.torque_limit)
            if wanted == torque:
                integral += error * period
        load = inputs[0, k] + p.payload_sine * math.sin(q) + p.payload_cosine * math.cos(q)
        acting = (1.0 + p.gain + _waves(waves, 2.0, q)) * torque * (1.0 - p.droop * abs(torque))
        outside = load + inputs[1, k] + _whichever_way(p, waves, q, acceleration)
        speed = abs(w)
        followed = speed
        if p.lag > 0.0:
            followed = past[n % length]
            past[n % length] = speed
        contact = 0.0
        if two:
            twist = q - q_link
            rate = w - w_link
            over = (
                twist - 0.5 * p.gap if twist > 0.5 * p.gap else (twist + 0.5 * p.gap if twist < -0.5 * p.gap else 0.0)
            )
            if p.gap == 0.0 or over != 0.0:
                contact = p.contact_stiffness * over + p.contact_damping * rate
                if p.gap > 0.0 and contact * over < 0.0:
                    contact = 0.0
        pushing = acting - (contact if two else outside)
        share = 1.0 - p.link_friction if two else 1.0
        smooth = share * _viscous(p, w, followed, inputs[3, k]) * (1.0 if w > 0 else (-1.0 if w < 0 else 0.0))
        free = w + h / inertia * (pushing - smooth)
        way = free if w == 0.0 else w
        level = share * _level(p, waves, q, way, followed, load, age, inputs[2, k])
        if p.presliding_distance > 0.0:
            s = 1.0 if w >= 0 else -1.0
            z = s + (z - s) * math.exp(-speed * h / p.presliding_distance)
            # The damping of the bending contact is implicit, since it may be stiff.
            damped = p.presliding_damping * max(1.0 - s * z, 0.0)
            new = (free - h / inertia * level * z) / (1.0 + h / inertia * damped)
        else:
            most = h / inertia * level
            new = 0.0 if abs(free) <= most else free - math.copysign(most, free)
        if n % every == 0:
            i = n // every
            out[0, i], out[1, i], out[2, i], out[3, i] = q, w, torque, load
            out[4, i], out[5, i] = pushing, pushing - inertia * (new - w) / h
            out[6, i], out[7, i], out[8, i], out[9, i] = z, age, q_link, w_link
        if two:
            braking = p.link_friction * _viscous(p, w_link, abs(w_link), inputs[3, k])
            free_link = w_link + h / p.link_inertia * (contact - outside - math.copysign(braking, w_link))
            dry = p.link_friction * _level(p, waves, q_link, free_link, abs(w_link), load, age, inputs[2, k])
            most = h / p.link_inertia * dry
            new_link = 0.0 if abs(free_link) <= most else free_link - math.copysign(most, free_link)
            q_link += 0.5 * h * (w_link + new_link)
            w_link = new_link
        moved = 0.5 * h * (w + new)
        if p.ageing_rise != 0.0:
            age += h * (1.0 - age) / p.ageing_time
            age *= math.exp(-abs(moved) / p.ageing_distance)
        acceleration += 0.2 * ((new - w) / h - acceleration)
        q += moved
        w = new
    return out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7], out[8], out[9]


def simulate(
    plant: Plant, loop: Loop, waves: Array, reference: Array, inputs: Array, h: float, every: int = 1
) -> Course:
    """Return the course of one run; see :func:`run`."""
    return Course(*run(plant, loop, waves, reference, inputs, h, every))
