"""Rigs drawn at random: a drive, a motion that can show the hidden effects, sensors, and effects of a wanted size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.errors import InputError, suggestion
from fricmodels.rig.effects import HIDDEN
from fricmodels.rig.hidden import CLOSED_LOOP, EXCITATIONS, Drawn, HiddenEffect, log_uniform
from fricmodels.rig.rig import EXCLUSIVE, Rig


@dataclass(frozen=True)
class Scale:
    """Ranges of one kind of drive, in SI units; ``flow`` is viscous over Coulomb torque at the highest speed."""

    motion: Motion
    inertia: tuple[float, float]
    coulomb: tuple[float, float]
    speed: tuple[float, float]
    flow: tuple[float, float]


SCALES: Mapping[str, Scale] = {
    "paper-motor": Scale(Motion.ROTARY, (3e-6, 8e-6), (6e-3, 1.4e-2), (60.0, 120.0), (0.4, 1.5)),
    "robot-joint": Scale(Motion.ROTARY, (0.5, 5.0), (5.0, 30.0), (1.0, 3.0), (0.4, 1.5)),
    "linear-axis": Scale(Motion.LINEAR, (50.0, 200.0), (10.0, 40.0), (0.15, 0.5), (0.5, 3.0)),
}
"""Kinds of drive that :func:`random_rig` knows."""

_WEAKEST = 0.02


def random_rig(
    rng: np.random.Generator,
    effects: Sequence[str] = ("cogging",),
    *,
    size: float | Sequence[float] | None = None,
    scale: str | None = None,
    excitation: str | None = None,
    noise_percent: float | None = None,
    samples: int = 20_000,
) -> Rig:
    """Draw a rig whose recording contains what is needed to show the hidden effects.

    Args:
        rng: source of everything that is drawn.
        effects: names of the hidden effects; none is allowed.
        size: RMS torque that each effect leaves in the residual, relative to the RMS friction torque; drawn
            log-uniformly from 0.05 to 0.3 where not given. An effect that saturates comes as near as it can.
        scale: one of :data:`SCALES`; excitation: one of :data:`EXCITATIONS`; drawn where not given.
        noise_percent: noise of the velocity in % of its RMS value; drawn log-uniformly from 0.2 to 5.
        samples: length of the record.

    Raises:
        InputError: for an unknown effect, scale or excitation, two effects that exclude each other, or an
            excitation that cannot show one of them.
    """
    for name, known in (*((e, HIDDEN) for e in effects), (scale, SCALES), (excitation, EXCITATIONS)):
        if name is not None and name not in known:
            raise InputError(f"there is no '{name}'{suggestion(name, known)}")
    for pair in EXCLUSIVE:
        if set(pair) <= set(effects):
            raise InputError(f"'{pair[0]}' and '{pair[1]}' cannot be simulated together")
    for _ in range(30):
        rig = _draw(rng, tuple(effects), size, scale, excitation, noise_percent, samples)
        if rig is not None:
            return rig
    raise InputError(f"no rig in 30 draws moved enough to show {', '.join(effects) or 'friction'}")


def strength(rig: Rig) -> float:
    """Return the RMS torque that the hidden effects leave in the residual over the RMS friction torque while sliding.

    A rig that never moves has no strength, NaN; one that runs away has an infinite one.
    """
    speeds = np.concatenate([h.velocity[:: len(h.velocity) // rig.samples] for h in rig.histories])
    speeds = speeds[speeds != 0]
    if not len(speeds):
        return float("nan")
    level = np.where(speeds > 0, rig.friction.level(abs(speeds), 0), rig.friction.level(abs(speeds), 1))
    with np.errstate(over="ignore", invalid="ignore"):
        left, friction = np.mean(rig.effect_torque() ** 2), np.mean(level**2)
    return float(np.sqrt(left / friction)) if np.isfinite(left) and np.isfinite(friction) else float("inf")


def with_size(rig: Rig, size: float) -> Rig:
    """Return the rig with its hidden effects scaled so that their :func:`strength` is ``size``, to 5 %.

    An effect that saturates (a delay, a gap, an asymmetry) comes as near as it can.
    """
    low, high = 0.0, np.inf
    factor, best, error = 1.0, rig, np.inf
    for _ in range(8):
        trial = rig.with_strength(factor)
        reached = strength(trial)
        miss = abs(np.log(reached / size)) if np.isfinite(reached) and reached > 0 else np.inf
        if miss < error:
            best, error = trial, miss
        if miss < 0.05:
            break
        if np.isfinite(reached) and reached < size:
            low = factor
        else:
            high = factor
        step = float(np.clip(size / reached, 0.1, 10.0)) if np.isfinite(reached) and reached > 0 else 0.3
        factor *= step
        if not low < factor < high:
            factor = float(np.sqrt(low * high)) if low > 0 and np.isfinite(high) else 0.5 * (low + min(high, 4 * low))
        factor = min(max(factor, _WEAKEST), 1 / _WEAKEST)
    return best


def _draw(
    rng: np.random.Generator,
    effects: tuple[str, ...],
    size: float | Sequence[float] | None,
    scale: str | None,
    excitation: str | None,
    noise_percent: float | None,
    samples: int,
) -> Rig | None:
    classes = [HIDDEN[name] for name in effects]
    possible = [s for s in SCALES if all(SCALES[s].motion in cls.motions for cls in classes)]
    ranges = SCALES[scale or str(rng.choice(possible))]
    votes = {kind: sum(kind in cls.shown_by for cls in classes) for kind in EXCITATIONS}
    shown = [kind for kind in EXCITATIONS if votes[kind] == max(votes.values())]
    if excitation is not None and votes[excitation] < len(effects):
        raise InputError(f"'{excitation}' does not show {', '.join(effects)}; better: {', '.join(shown)}")
    kind = excitation or str(rng.choice(shown))
    d, friction = _drive(rng, ranges, classes, samples)
    loaded = any(cls.needs_load for cls in classes) or (kind in CLOSED_LOOP and rng.random() < 0.2)
    amplitude = d.friction * rng.uniform(0.5, 1.5)
    load = {
        "bias": amplitude * rng.uniform(-0.4, 0.4),
        "amplitude": amplitude * (1.0 if kind in CLOSED_LOOP else 0.3),
        "frequency": d.frequency * rng.uniform(0.15, 0.6),
    }
    noise = log_uniform(rng, 0.2, 5.0) if noise_percent is None else noise_percent
    base: dict[str, Any] = {
        "motion": ranges.motion,
        "inertia": d.inertia,
        "friction": friction,
        "load": load if loaded else None,
        "excitation": _excitation(rng, kind, d),
        "sensors": {"velocity_noise_percent": noise, "temperature_noise": 0.1},
        "rate": d.rate,
        "samples": samples,
        "rest_speed": 1e-4 * d.speed,
        "hold": bool(rng.random() < 0.7),
        "seed": int(rng.integers(2**31)),
    }
    plain = Rig.model_validate(base)
    if not _moves(plain, d):
        return None
    wanted = size if isinstance(size, Sequence) else [size] * len(effects)
    hidden: list[HiddenEffect] = []
    for name, target in zip(effects, wanted, strict=True):
        drawn = {"name": name, **HIDDEN[name].draw(rng, d, partial(_wave_number, rng, d, plain))}
        alone = Rig.model_validate({**base, "effects": [drawn]})
        goal = log_uniform(rng, 0.05, 0.3) if target is None else target
        hidden.extend(with_size(alone, goal).effects)
    rig = Rig.model_validate({**base, "effects": hidden, "name": "+".join(effects) or "nothing-hidden"})
    return rig if _moves(rig, d) else None


def _drive(
    rng: np.random.Generator, ranges: Scale, effects: Sequence[type[HiddenEffect]], samples: int
) -> tuple[Drawn, dict[str, Any]]:
    inertia, coulomb = log_uniform(rng, *ranges.inertia), log_uniform(rng, *ranges.coulomb)
    speed, flow = log_uniform(rng, *ranges.speed), rng.uniform(*ranges.flow)
    total = coulomb * (1 + flow)
    frequency = rng.uniform(0.3, 1.5) * total / (inertia * 2 * np.pi * speed)
    if any(cls.needs_turns for cls in effects):
        frequency = speed / (2 * np.pi * rng.uniform(1.6, 3.5))
    travel = speed / (2 * np.pi * frequency)
    rate = frequency * log_uniform(rng, 400, 1000)
    viscous = flow * coulomb / speed
    drive = Drawn(inertia, coulomb, speed, total, frequency, rate, samples, travel, frequency * rng.uniform(12, 25))
    skew = rng.uniform(0.05, 0.25) if rng.random() < 0.4 and not any(cls.needs_symmetry for cls in effects) else 0.0

    def sides(value: float, share: float) -> float | tuple[float, float]:
        return (value * (1 + share), value * (1 - share)) if skew else value

    friction: dict[str, Any] = {"viscous": sides(viscous, rng.uniform(-1, 1) * skew), "coulomb": sides(coulomb, skew)}
    if any(cls.needs_falling_friction for cls in effects):
        friction["stick"] = sides(coulomb * rng.uniform(1.3, 1.7), skew)
        friction["fall"] = sides(1 / (speed * rng.uniform(0.05, 0.2)), 0.0)
    return drive, friction


def _excitation(rng: np.random.Generator, kind: str, d: Drawn) -> dict[str, Any]:
    torque = 1.1 * float(np.hypot(d.friction, d.inertia * 2 * np.pi * d.frequency * d.speed))
    acceleration = 2 * np.pi * d.frequency * d.speed
    closed = {"bandwidth": d.bandwidth, "damping_ratio": rng.uniform(0.7, 1.1)}
    period = 1 / d.frequency
    choices: Mapping[str, dict[str, Any]] = {
        "sine": {"amplitude": torque, "frequency": d.frequency},
        "multisine": {"amplitude": torque, "frequency": d.frequency / 3, "lines": int(rng.integers(4, 9))},
        "tracking": {
            "velocity": 0.7 * d.speed,
            "frequency": d.frequency / 2,
            "lines": int(rng.integers(3, 7)),
            **closed,
        },
        "trapezoid": {
            "velocity": d.speed,
            "acceleration": acceleration,
            "span": 4 * d.travel,
            "rests": (0.02 * period, period),
            **closed,
        },
        "stair": {"velocity": d.speed, "acceleration": acceleration, "hold": 0.4 * period, "levels": 8, **closed},
        "ramp": {"velocity": d.speed, "period": 2 * period, **closed},
    }
    return {"kind": kind, **choices[kind]}


def _moves(rig: Rig, d: Drawn) -> bool:
    """Whether the drive slides in both directions for a good part of the record, at sensible speeds."""
    velocity = np.concatenate([h.velocity for h in rig.histories])
    if not np.all(np.isfinite(velocity)) or np.max(np.abs(velocity)) > 6 * d.speed:
        return False
    fast = 0.02 * d.speed
    return bool(min(np.mean(velocity > fast), np.mean(velocity < -fast)) > 0.15)


def _wave_number(rng: np.random.Generator, d: Drawn, plain: Rig) -> float:
    """Draw a wave number with several periods over the travel, and enough samples in each at full speed."""
    position = np.concatenate([h.position for h in plain.histories])
    span = float(np.quantile(position, 0.95) - np.quantile(position, 0.05))
    fastest = float(np.quantile(np.concatenate([np.abs(h.velocity) for h in plain.histories]), 0.95))
    least, most = 2 * np.pi * 4 / span, 2 * np.pi * d.rate / (12 * fastest)
    if plain.motion is Motion.ROTARY:
        least = max(least, 2.0)
    return log_uniform(rng, least, max(min(most, 10 * least), 1.2 * least))
