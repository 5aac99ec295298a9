"""The equations of the simulated drive, as plain scalar functions compiled by Numba.

Two bodies: the motor (index 1) and the load behind it (index 2), joined by a spring, damper and gap, or one rigid
body when the load inertia is 0. Every function takes the record ``p`` of :data:`PHYSICS`. Nothing here is shared with
the laws and effects that are identified.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit

MOST_WAVES = 16
PHYSICS = np.dtype(
    [
        ("waves", np.float64, (MOST_WAVES, 4)),
        *(
            (name, np.float64)
            for name in (
                *("wave_count", "rest_speed"),
                *("motor_inertia", "load_inertia", "coupling_stiffness", "coupling_damping", "gap", "motor_share"),
                *("viscous_forward", "viscous_backward", "coulomb_forward", "coulomb_backward"),
                *("rise_forward", "rise_backward", "fall_forward", "fall_backward"),
                *("stribeck_rise", "stribeck_speed", "stribeck_exponent", "power_coefficient", "power_exponent"),
                *("load_friction", "driving_loss", "driven_loss", "gain", "offset"),
                *("gravity_sine", "gravity_cosine", "gravity_loss", "stiffness", "neutral_position"),
                *("presliding", "elastic_width", "micro_damping", "lag"),
                *("ageing_rise", "ageing_time", "ageing_distance"),
                *("reference_temperature", "viscous_thinning", "coulomb_thinning"),
                *("temperature_start", "temperature_end", "temperature_time"),
                *("viscous_drift", "coulomb_drift", "drift_time", "step_time", "step_coulomb", "step_viscous"),
                *("payload", "payload_angle", "proportional", "derivative", "torque_limit"),
            )
        ),
    ]
)
"""Everything that the equations of motion need, in SI units; ``waves`` has rows (kind, k, a, φ). Zero is off."""

RIGID, DAHL, LUGRE, MAXWELL_SLIP = 0.0, 1.0, 2.0, 3.0
COGGING, FRICTION_WAVE, RIPPLE = 0.0, 1.0, 2.0

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function) -> _Function:
    """Compile a scalar function, once for all processes."""
    return cast(_Function, njit(cache=True, error_model="numpy", nogil=True)(function))


@compiled
def wave(p: Any, kind: float, position: float) -> float:
    """Return Σ a·cos(k q + φ) over the waves of one kind."""
    total = 0.0
    for i in range(int(p.wave_count)):
        if p.waves[i, 0] == kind:
            total += p.waves[i, 2] * math.cos(p.waves[i, 1] * position + p.waves[i, 3])
    return total


@compiled
def dry_torque(p: Any, direction: float, speed: float, position: float, load: float, slow: Any, peak: float) -> float:
    """Return the magnitude of the speed-weakening dry friction torque that opposes ``direction``."""
    if direction > 0:
        level, rise, fall = p.coulomb_forward, p.rise_forward, p.fall_forward
    else:
        level, rise, fall = p.coulomb_backward, p.rise_backward, p.fall_backward
    if rise != 0.0:
        level += rise * math.exp(-fall * speed)
    if p.stribeck_rise != 0.0:
        ratio = speed / p.stribeck_speed
        if p.stribeck_exponent == 2.0:
            level += p.stribeck_rise * math.exp(-ratio * ratio)
        elif p.stribeck_exponent == 1.0:
            level += p.stribeck_rise * math.exp(-ratio)
        else:
            level += p.stribeck_rise * math.exp(-(ratio**p.stribeck_exponent))
    level = level * slow[0] + slow[2] + peak
    loss = p.load_friction + (p.driving_loss if load * direction > 0 else p.driven_loss)
    if loss != 0.0:
        level += loss * abs(load)
    if p.gravity_loss != 0.0:
        level += p.gravity_loss * abs(p.gravity_sine * math.sin(position) + p.gravity_cosine * math.cos(position))
    if p.wave_count > 0:
        level += wave(p, FRICTION_WAVE, position)
    return float(max(level, 0.0))


@compiled
def viscous_torque(p: Any, direction: float, speed: float, slow: Any) -> float:
    """Return the magnitude of the friction torque that grows with speed."""
    torque = (p.viscous_forward if direction > 0 else p.viscous_backward) * speed * slow[1]
    if p.power_coefficient != 0.0:
        torque += p.power_coefficient * speed**p.power_exponent
    return float(torque + slow[3] * speed)


@compiled
def slow_factors(p: Any, time: float) -> Any:
    """Return (factor of dry, factor of viscous, added dry, added viscous coefficient, temperature) at one time."""
    temperature = p.temperature_start
    if p.temperature_time > 0.0:
        change = p.temperature_end - p.temperature_start
        temperature += change * -math.expm1(-time / p.temperature_time)
    warmer = temperature - p.reference_temperature
    dry = 1.0 - p.coulomb_thinning * warmer
    viscous = math.exp(-p.viscous_thinning * warmer)
    if p.drift_time > 0.0:
        progress = -math.expm1(-time / p.drift_time)
        dry *= 1.0 + p.coulomb_drift * progress
        viscous *= 1.0 + p.viscous_drift * progress
    after = 1.0 if time >= p.step_time else 0.0
    return dry, viscous, after * p.step_coulomb, after * p.step_viscous, temperature


@compiled
def known_load(p: Any, position: float, given: float) -> float:
    """Return the load torque that the recording knows: a payload's weight and a load put on from outside."""
    if p.payload == 0.0:
        return given
    return float(given + p.payload * math.sin(position + p.payload_angle))


@compiled
def coupling_torque(p: Any, twist: float, rate: float) -> float:
    """Return the torque through the joint: a spring and damper behind a gap, which can only push."""
    half = 0.5 * p.gap
    if abs(twist) <= half:
        return 0.0
    side = 1.0 if twist > 0 else -1.0
    torque = p.coupling_stiffness * (twist - side * half) + p.coupling_damping * rate
    if p.gap > 0.0 and torque * side < 0.0:
        return 0.0
    return float(torque)


@compiled
def applied_torques(p: Any, q1: float, w1: float, q2: float, w2: float, motor: float, load: float) -> Any:
    """Return the torques on motor and load, without friction."""
    drive = motor * (1.0 + p.gain) - p.offset
    if p.wave_count > 0:
        drive += motor * (1.0 + p.gain) * wave(p, RIPPLE, q1) - wave(p, COGGING, q1)
    outer_position = q1 if p.load_inertia == 0.0 else q2
    outer = load + p.stiffness * (outer_position - p.neutral_position)
    if p.gravity_sine != 0.0 or p.gravity_cosine != 0.0:
        outer += p.gravity_sine * math.sin(outer_position) + p.gravity_cosine * math.cos(outer_position)
    if p.load_inertia == 0.0:
        return drive - outer, 0.0
    joint = coupling_torque(p, q1 - q2, w1 - w2)
    return drive - joint, joint - outer


@compiled
def bristles(p: Any, z: Any, travel: float, weakening: float) -> Any:
    """Return the four elastic deflections after ``travel``, and the shares of full friction bent forward and backward.

    A contact is as stiff and as strong as in the direction in which it is bent, whichever way and however fast it
    moves, and slips at ``weakening`` of its strength: it gives back no more than it took.
    """
    if p.presliding == MAXWELL_SLIP:
        a, b, c, d = 0.25 * p.elastic_width, 0.5 * p.elastic_width, 0.75 * p.elastic_width, p.elastic_width
        za = min(max(z[0] + travel, -a * weakening), a * weakening)
        zb = min(max(z[1] + travel, -b * weakening), b * weakening)
        zc = min(max(z[2] + travel, -c * weakening), c * weakening)
        zd = min(max(z[3] + travel, -d * weakening), d * weakening)
        forward = 0.25 * (max(za, 0.0) / a + max(zb, 0.0) / b + max(zc, 0.0) / c + max(zd, 0.0) / d)
        backward = 0.25 * (min(za, 0.0) / a + min(zb, 0.0) / b + min(zc, 0.0) / c + min(zd, 0.0) / d)
        return (za, zb, zc, zd), (forward, backward)
    side = 1.0 if travel > 0 else -1.0
    if p.presliding == DAHL:
        end, distance = side, p.elastic_width
    else:
        end, distance = side * weakening, p.elastic_width * weakening
    after = end + (z[0] - end) * math.exp(-abs(travel) / distance)
    return (after, 0.0, 0.0, 0.0), (max(after, 0.0), min(after, 0.0))
