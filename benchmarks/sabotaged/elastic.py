"""Drives that look late and are not: a heavy link on a spring, a contact that bends; their motion is given."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from sabotaged.good import Good


def elastic(count: int, seed: int) -> Iterator[Good]:
    """Yield drives on nine sines, by turns with a link that is moved up to its resonance and with Dahl's contact."""
    for number in range(count):
        rng = np.random.default_rng([seed, number, 2])
        yield link(rng, number) if number % 2 else contact(rng, number)


def link(rng: np.random.Generator, number: int) -> Good:
    """Return a motor whose link, as heavy or heavier, hangs on a spring."""
    natural, damping, ratio = 2 * np.pi * rng.uniform(4, 9), rng.uniform(0.03, 0.2), rng.uniform(0.4, 2.0)
    time, angle, pulsation = sines(rng, 0.3, natural / 2 / np.pi * rng.uniform(0.8, 1.8))
    size = 3.0 / np.abs(np.cos(angle).sum(axis=1)).max()
    above = natural**2 + 2j * damping * natural * pulsation
    inertia = 0.25 * (1.0 + ratio * above / (above - pulsation**2)) * 1j * pulsation
    velocity = size * np.cos(angle).sum(axis=1)
    torque = size * (np.exp(1j * angle) @ inertia).real + 0.8 * velocity + 3.0 * np.sign(velocity)
    position = size * np.sin(angle) @ (1 / pulsation)
    return Good(f"link {number}: joint-compliance", sensed(rng, time, position, velocity, torque))


def contact(rng: np.random.Generator, number: int) -> Good:
    """Return a drive most of whose friction is built up over a length, in strokes of a few such lengths and more."""
    length, share = 10 ** rng.uniform(-2.3, -1.3), rng.uniform(0.5, 0.95)
    time, angle, pulsation = sines(rng, 0.4, 3.0)
    size = rng.uniform(0.3, 1.0) / np.abs(np.cos(angle).sum(axis=1)).max()
    velocity, position = size * np.cos(angle).sum(axis=1), size * np.sin(angle) @ (1 / pulsation)
    state, bent = 0.0, np.zeros(len(time))
    for k, step in enumerate(np.diff(position), 1):
        state = (state + step / length) / (1 + abs(step) / length)
        bent[k] = state
    friction = 0.3 * (share * bent + (1 - share) * np.sign(velocity)) + 0.05 * velocity
    torque = friction - 0.02 * size * np.sin(angle) @ pulsation
    return Good(f"contact {number}: presliding", sensed(rng, time, position, velocity, torque))


def sines(rng: np.random.Generator, low: float, high: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times [s], and angles [rad] and pulsations [rad/s] of nine sines between two frequencies [Hz]."""
    time = np.arange(15_000) * 2e-3
    pulsation = 2 * np.pi * np.geomspace(low, high, 9) * rng.uniform(0.9, 1.1, 9)
    return time, np.outer(time, pulsation) + rng.uniform(0, 2 * np.pi, 9), pulsation


def sensed(
    rng: np.random.Generator, time: np.ndarray, position: np.ndarray, velocity: np.ndarray, torque: np.ndarray
) -> Recording:
    """Return what sensors write: counts of a fine encoder, noise of the velocity and of the torque."""
    step = 2 * np.pi / 2 ** int(rng.integers(17, 23))
    channels = {
        "time": time,
        "torque": torque + rng.choice([0.005, 0.02]) * np.std(torque) * rng.standard_normal(len(time)),
        "velocity": velocity + 1e-3 * np.std(velocity) * rng.standard_normal(len(time)),
        "position": step * np.round(position / step),
    }
    return Recording("elastic", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
