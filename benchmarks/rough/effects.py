"""What may be hidden in a drive: the listed effects and what is on no list, each drawn with a size.

A size is the RMS torque of the effect over the RMS torque of the drive, both on the motion that is asked for. Effects
with memory are drawn by their lengths and times instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rough.drives import Drive, Nominal, log_uniform
from rough.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Change:
    """What an effect changes in a drive.

    Attributes:
        name: of the effect.
        fields: what is added to fields of the plant.
        waves: rows of the table of waves.
        coulomb, viscous: relative change of the friction over time and temperature, of the functions named by
            ``course``: ``warming``, ``time``, ``step`` or ``walk``.
        course: how that goes; empty if not at all.
        at: instant of a step, as a share of the recording; or time of a drift.
        delay: delay of the motion against the torque, in s.
        clip: level at which the torque sensor saturates [N m or N]; infinite if not.
        coupling: torque of another joint, in N m per its RMS acceleration.
    """

    name: str
    fields: Mapping[str, float] = field(default_factory=dict)
    waves: tuple[tuple[float, float, float, float], ...] = ()
    coulomb: float = 0.0
    viscous: float = 0.0
    course: str = ""
    at: float = 0.5
    delay: float = 0.0
    clip: float = math.inf
    coupling: float = 0.0


Draw = Callable[[np.random.Generator, Drive, Nominal, float], dict[str, Any]]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) or 1.0


def _sign(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _asymmetry(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    share, p = _sign(rng) * min(torque / d.plant.coulomb_forward, 0.7), d.plant
    slope = share * rng.uniform(-0.5, 1) if rng.random() < 0.5 else 0.0
    both = {"coulomb_forward": share * p.coulomb_forward, "coulomb_backward": -share * p.coulomb_backward}
    return {
        "fields": {**both, "viscous_forward": slope * p.viscous_forward, "viscous_backward": -slope * p.viscous_forward}
    }


def _offset(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"fields": {"offset": _sign(rng) * torque}}


def _stribeck(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    speed, exponent = d.speed * log_uniform(rng, 0.02, 0.2), float(rng.uniform(0.7, 2.0))
    shape = np.where(m.velocity != 0, np.exp(-((np.abs(m.velocity) / speed) ** exponent)), 0.0)
    rise = min(torque / _rms(shape), 1.5 * d.plant.coulomb_forward)
    return {
        "fields": {"stribeck_rise": rise, "stribeck_speed": speed, "stribeck_exponent": exponent},
    }


def _nonlinear(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    exponent = float(rng.choice([0.5, 2 / 3, 1.7, 2.0, 3.0]))
    coefficient = torque / _rms(np.abs(m.velocity) ** exponent)
    return {"fields": {"power_coefficient": coefficient, "power_exponent": exponent}}


def _load_friction(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"fields": {"load_friction": min(torque / _rms(m.load), 0.5)}}


def _efficiency(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    driving = min(1.4 * torque / _rms(m.load), 0.5)
    return {"fields": {"driving_loss": driving, "driven_loss": driving * rng.uniform(0.0, 0.4)}}


def _gain(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"fields": {"gain": _sign(rng) * min(torque / m.rms, 0.3)}}


def _inertia(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    share = _sign(rng) * min(torque / _rms(d.plant.inertia * m.acceleration), 0.4)
    return {"fields": {"inertia": share * d.plant.inertia}}


def _gravity(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    angle = rng.uniform(0, 2 * np.pi)
    return {
        "fields": {
            "gravity_sine": math.sqrt(2) * torque * math.sin(angle),
            "gravity_cosine": math.sqrt(2) * torque * math.cos(angle),
        }
    }


def _stiffness(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    neutral = float(np.mean(m.position) + rng.uniform(-0.3, 0.3) * m.range)
    return {"fields": {"stiffness": torque / _rms(m.position - neutral), "neutral": neutral}}


def wave_number(rng: np.random.Generator, d: Drive, m: Nominal) -> float:
    """Draw a wave number: two periods in the range at least, four samples in a period at the RMS speed at least."""
    least = 2 * np.pi * 2 / m.range
    most = 2 * np.pi * d.sensors.rate / 4 / _rms(m.velocity)
    if not d.linear:
        least = max(least, 2.0)
    k = log_uniform(rng, least, max(min(most, 150 * least), 1.2 * least))
    return k if d.linear or k < 3 else float(round(k))


def _periodic(kind: float) -> Draw:
    def draw(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
        k, amplitude = wave_number(rng, d, m), math.sqrt(2) * torque
        if kind == 1.0:
            amplitude = min(amplitude, 0.9 * d.plant.coulomb_forward)
        if kind == 2.0:
            amplitude = min(amplitude / m.rms, 0.4)
        rows = [(kind, k, amplitude, float(rng.uniform(0, 2 * np.pi)))]
        if rng.random() < 0.25:
            rows.append((kind, 2 * k, 0.4 * amplitude, float(rng.uniform(0, 2 * np.pi))))
        return {"waves": tuple(rows)}

    return draw


def _presliding(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    # The contact's own frequency stays a tenth of the integration's.
    stiffest = d.plant.coulomb_forward / (d.plant.inertia * (0.1 * 24_000) ** 2)
    distance = max(m.range * log_uniform(rng, 3e-4, 0.03), stiffest)
    spring = d.plant.coulomb_forward / distance
    damping = 2 * rng.uniform(0.1, 0.7) * math.sqrt(spring * d.plant.inertia)
    return {"fields": {"presliding_distance": distance, "presliding_damping": damping}}


def _lag(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"fields": {"lag": d.period * log_uniform(rng, 0.002, 0.03)}}


def _ageing(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {
        "fields": {
            "ageing_rise": d.plant.coulomb_forward * log_uniform(rng, 0.3, 2.0),
            "ageing_time": d.period * log_uniform(rng, 0.05, 1.0),
            "ageing_distance": m.range * log_uniform(rng, 1e-3, 0.03),
        }
    }


def _backlash(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    share = rng.uniform(0.2, 0.8)
    reduced = d.plant.inertia * share * (1 - share)
    natural = 2 * np.pi * rng.uniform(300, 600)
    return {
        "fields": {
            "link_inertia": share * d.plant.inertia,
            "gap": m.range * log_uniform(rng, 5e-4, 0.02),
            "contact_stiffness": reduced * natural**2,
            "contact_damping": 2 * 0.3 * reduced * natural,
            "link_friction": rng.uniform(0.2, 0.7),
        }
    }


def _delay(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"delay": min(log_uniform(rng, 0.5, 10.0) / d.sensors.rate, d.period / 20)}


def _friction(d: Drive, m: Nominal) -> float:
    return _rms(d.plant.coulomb_forward * np.sign(m.velocity) + d.plant.viscous_forward * m.velocity)


def _changing(course: str) -> Draw:
    def draw(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
        share = min(2 * torque / _friction(d, m), 0.8 if course == "warming" else 1.5)
        share *= -1.0 if course == "warming" else (_sign(rng) if share < 0.8 else 1.0)
        viscous = share if course != "step" else 0.0
        return {"course": course, "coulomb": share, "viscous": viscous, "at": rng.uniform(0.2, 0.8)}

    return draw


def _compliance(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    share = rng.uniform(0.2, 0.8)
    natural = 2 * np.pi * min(log_uniform(rng, 4, 60) / d.period, d.sensors.rate / 6)
    link = share * d.plant.inertia
    return {
        "fields": {
            "link_inertia": link,
            "contact_stiffness": link * natural**2,
            "contact_damping": 2 * link * natural * log_uniform(rng, 0.02, 0.2),
        }
    }


LISTED: Mapping[str, Draw] = {
    "asymmetry": _asymmetry,
    "torque-offset": _offset,
    "stribeck": _stribeck,
    "nonlinear-viscous": _nonlinear,
    "load-friction": _load_friction,
    "directional-efficiency": _efficiency,
    "torque-gain": _gain,
    "inertia-error": _inertia,
    "gravity": _gravity,
    "stiffness": _stiffness,
    "cogging": _periodic(0.0),
    "position-friction": _periodic(1.0),
    "torque-ripple": _periodic(2.0),
    "presliding": _presliding,
    "frictional-lag": _lag,
    "rising-stiction": _ageing,
    "backlash": _backlash,
    "sensor-delay": _delay,
    "thermal": _changing("warming"),
    "drift": _changing("time"),
    "step-change": _changing("step"),
    "joint-compliance": _compliance,
}


def _bump(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    place, width = rng.uniform(*np.quantile(m.position, [0.2, 0.8])), m.range * log_uniform(rng, 0.01, 0.1)
    shape = np.exp(-(((m.position - place) / width) ** 2))
    kind = "bump_torque" if rng.random() < 0.5 else "bump_friction"
    amplitude = min(torque / max(_rms(shape), 0.05), 3 * m.rms)
    return {"fields": {kind: amplitude, "bump_place": place, "bump_width": width}}


def _zone(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    start = rng.uniform(*np.quantile(m.position, [0.1, 0.6]))
    stop, edge = start + m.range * rng.uniform(0.1, 0.3), 0.01 * m.range
    inside = (m.position > start) & (m.position < stop)
    amplitude = min(torque / max(_rms(inside.astype(float)), 0.1), 3 * m.rms)
    return {"fields": {"zone_friction": amplitude, "zone_from": start, "zone_to": stop, "zone_edge": edge}}


def _acceleration(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"fields": {"absolute_acceleration": min(torque / _rms(m.acceleration), 0.5 * d.plant.inertia)}}


def _saturating(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    """Return the level at which what is cut off has the wanted size."""
    size = np.abs(m.torque)
    levels = np.quantile(size, np.linspace(0.3, 0.999, 60))
    lost = [_rms(np.maximum(size - level, 0.0)) for level in levels]
    return {"clip": float(levels[int(np.argmin(np.abs(np.array(lost) - torque)))])}


def _droop(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"fields": {"droop": min(torque / _rms(m.torque**2), 0.4 / float(np.max(np.abs(m.torque))))}}


def _coupling(rng: np.random.Generator, d: Drive, m: Nominal, torque: float) -> dict[str, Any]:
    return {"coupling": torque}


UNLISTED: Mapping[str, Draw] = {
    "bump": _bump,
    "zone": _zone,
    "absolute-acceleration": _acceleration,
    "saturating-sensor": _saturating,
    "random-walk": _changing("walk"),
    "droop": _droop,
    "coupling": _coupling,
}

NEEDS_LOAD = ("load-friction", "directional-efficiency")
NEEDS_INERTIA = ("inertia-error", "torque-gain", "joint-compliance", "backlash")
NEEDS_POSITION = ("gravity", "stiffness", "cogging", "position-friction", "torque-ripple")
NEEDS_TEMPERATURE = ("thermal",)
TWO_MASSES = ("backlash", "joint-compliance")
SIZES = (0.01, 0.3)


def change(rng: np.random.Generator, name: str, drive: Drive, motion: Nominal) -> Change:
    """Draw an effect."""
    size = log_uniform(rng, *SIZES) if name in LISTED else log_uniform(rng, 0.04, 0.3)
    return Change(name, **{**LISTED, **UNLISTED}[name](rng, drive, motion, size * motion.rms))


def changed(plant: Plant, changes: tuple[Change, ...]) -> tuple[Plant, Array]:
    """Return the plant with what effects change, and its table of waves."""
    values = plant._asdict()
    for one in changes:
        for key, value in one.fields.items():
            values[key] += value
    rows = [row for one in changes for row in one.waves]
    return Plant(*map(float, values.values())), np.array(rows, dtype=float).reshape(-1, 4)


def without(changes: tuple[Change, ...], names: frozenset[str]) -> tuple[Change, ...]:
    """Return the effects other than those named."""
    return tuple(one for one in changes if one.name not in names)
