"""Recordings on which two effects cannot be told apart, by how they were made."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fricmodels.rig import Load, Rig, random_rig
from fricmodels.rig.excitation import ClosedLoop, Sine, Tracking

SAME = 0.02
"""Two effects explain the data equally well when one leaves less than this share of what the other explains."""

Drawn = tuple[Rig, tuple[str, ...]]


def _effect(rig: Rig, **fields: object) -> Rig:
    """Return the rig with another hidden effect."""
    return Rig.model_validate({**rig.model_dump(), "effects": [fields]})


def _friction(rig: Rig) -> float:
    speed = float(np.quantile(np.abs(rig.histories[0].velocity), 0.9))
    return float(rig.friction.level(np.array([speed]), 0)[0])


def offset(rng: np.random.Generator) -> Drawn:
    """A Coulomb asymmetry or a constant torque."""
    if rng.random() < 0.5:
        return random_rig(rng, ["torque-offset"]), ("asymmetry", "torque-offset")
    rig = random_rig(rng, ["asymmetry"])
    return _effect(rig, name="asymmetry", coulomb=rig.effects[0].coulomb), ("asymmetry", "torque-offset")


def no_load(rng: np.random.Generator) -> Drawn:
    """A wrong inertia or a wrong torque constant, with no load known."""
    name = str(rng.choice(["inertia-error", "torque-gain"]))
    rig = random_rig(rng, [name]).model_copy(update={"load": None})
    return rig, ("inertia-error", "torque-gain")


def one_frequency(rng: np.random.Generator) -> Drawn:
    """A wrong inertia or a delay, in motion of one frequency of a drive with little dry friction."""
    name = str(rng.choice(["inertia-error", "sensor-delay"]))
    rig = random_rig(rng, [name], excitation="tracking")
    motion = rig.excitation
    assert isinstance(motion, Tracking)
    small = rig.friction.model_copy(update={"coulomb": 1e-3 * np.min(rig.friction.coulomb)})
    moved = motion.model_copy(update={"lines": 1, "frequency": 2 * motion.frequency})
    changed = rig.model_copy(update={"excitation": moved, "friction": small, "load": None})
    return changed, ("inertia-error", "sensor-delay", "torque-gain", "joint-compliance")


def narrow(rng: np.random.Generator) -> Drawn:
    """Gravity, a spring, or cogging of low order over a small part of a turn."""
    rig = random_rig(rng, ["gravity"], excitation="tracking")
    motion = rig.excitation
    assert isinstance(motion, Tracking)
    position = rig.histories[0].position
    factor = float(np.ptp(position)) / rng.uniform(0.3, 0.9)
    faster = motion.model_copy(update={"frequency": motion.frequency * factor})
    inertia = rig.inertia / factor**2
    changed = rig.model_copy(update={"excitation": faster, "rate": rig.rate * factor, "inertia": inertia})
    changed = changed.model_copy(
        update={"excitation": faster.model_copy(update={"bandwidth": motion.bandwidth * factor})}
    )
    if rng.random() < 0.5:
        force = _friction(rig)
        changed = _effect(changed, name="stiffness", stiffness=0.3 * force / (np.ptp(position) / factor))
    return changed, ("gravity", "stiffness", "cogging")


def one_direction(rng: np.random.Generator) -> Drawn:
    """A periodic torque or periodic friction, in motion that never reverses."""
    name = str(rng.choice(["cogging", "position-friction"]))
    rig = random_rig(rng, [name], excitation="sine")
    motion = rig.excitation
    assert isinstance(motion, Sine)
    biased = motion.model_copy(update={"bias": 2.0 * motion.amplitude, "frequency": 0.5 * motion.frequency})
    return rig.model_copy(update={"excitation": biased}), ("cogging", "position-friction")


def one_load(rng: np.random.Generator) -> Drawn:
    """Gear losses under a load that never changes: the same as an offset."""
    rig = random_rig(rng, ["directional-efficiency"])
    load = Load(bias=_friction(rig) * float(rng.choice([-1, 1])) * rng.uniform(0.5, 1.5))
    return rig.model_copy(update={"load": load}), ("directional-efficiency", "torque-offset", "asymmetry")


def warming(rng: np.random.Generator) -> Drawn:
    """A temperature that rises in proportion to time."""
    rig = random_rig(rng, ["thermal"])
    effect = rig.effects[0]
    end = 20 + 40 * 5
    slow = effect.model_copy(update={"time": 5 * rig.samples / rig.rate, "end": end})
    sensors = rig.sensors.model_copy(update={"temperature_noise": 0.02})
    return rig.model_copy(update={"effects": (slow,), "sensors": sensors}), ("thermal", "drift")


def one_payload(rng: np.random.Generator) -> Drawn:
    """A wrong torque constant or a wrong weight, on a slow joint loaded by one known weight."""
    rig = random_rig(rng, ["gravity"])
    weight, angle = 4 * _friction(rig), float(rng.uniform(0, 2 * np.pi))
    changed = rig.model_copy(update={"load": Load(payload=weight, payload_angle=angle)})
    assert isinstance(rig.excitation, ClosedLoop)
    if rng.random() < 0.5:
        changed = _effect(changed, name="torque-gain", error=0.03)
    else:
        sine, cosine = 0.03 * weight * np.cos(angle), 0.03 * weight * np.sin(angle)
        changed = _effect(changed, name="gravity", sine=sine, cosine=cosine)
    return changed, ("gravity", "torque-gain")


ONE_DIRECTION = "one direction"
SITUATIONS: Mapping[str, Callable[[np.random.Generator], Drawn]] = {
    "asymmetry or offset": offset,
    "no load": no_load,
    "one frequency": one_frequency,
    "narrow range": narrow,
    ONE_DIRECTION: one_direction,
    "one load": one_load,
    "steady warming": warming,
    "one payload": one_payload,
}
