"""An independent simulation of the paper's drive: Karnopp's velocity band, many small trapezium-rule steps."""

from __future__ import annotations

import math
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording

INERTIA = 4.87e-6
OMEGA = 39.54
TRUE = {"K_v1": 1.0e-4, "K_v2": 6.6e-5, "K_c1": 1.0e-2, "K_c2": 6.6e-3}
AMPLITUDE = 0.03


@lru_cache(maxsize=64)
def _motion(
    cycles: int, per_cycle: int, amplitude: float, omega: float, inertia: float, k: tuple[float, ...]
) -> tuple[float, ...]:
    """Return the velocities; k: K_v1, K_v2, K_c1, K_c2, C_1, C_2, B_1, B_2."""
    velocity, velocities, parts = 0.0, [0.0], 16
    step = 2 * math.pi / omega / per_cycle / parts
    torque = 0.0
    for i in range(1, (cycles * per_cycle - 1) * parts + 1):
        before, torque = torque, amplitude * math.sin(omega * step * i)
        drive = 0.5 * (before + torque)
        held = abs(velocity) <= 1e-6
        if held and -k[3] <= drive <= k[2]:
            velocity = 0.0
        else:
            direction = (1 if drive > 0 else -1) if held else (1 if velocity > 0 else -1)
            j = 0 if direction > 0 else 1
            rates, speed = [], abs(velocity)
            for _ in range(2):
                coulomb = k[4 + j] + (k[2 + j] - k[4 + j]) * math.exp(-k[6 + j] * speed)
                rates.append((drive - direction * (k[j] * speed + coulomb)) / inertia)
                speed = max(direction * (velocity + step * rates[0]), 0.0)
            new = velocity + 0.5 * step * (rates[0] + rates[1])
            velocity = 0.0 if new * direction < 0 else new
        if i % parts == 0:
            velocities.append(velocity)
    return tuple(velocities)


def recording(
    noise: float = 0.0,
    seed: int = 0,
    *,
    cycles: int = 10,
    per_cycle: int = 200,
    amplitude: float = AMPLITUDE,
    omega: float = OMEGA,
    slip: tuple[float, float] | None = None,
    rate: tuple[float, float] = (0.5, 0.5),
) -> Recording:
    """Simulate the drive; ``noise`` is the standard deviation of white velocity noise over the RMS velocity."""
    c = slip or (TRUE["K_c1"], TRUE["K_c2"])
    velocity = np.array(_motion(cycles, per_cycle, amplitude, omega, INERTIA, (*TRUE.values(), *c, *rate)))
    time = 2 * np.pi / omega / per_cycle * np.arange(len(velocity))
    rms = float(np.sqrt(np.mean(velocity**2)))
    noisy = velocity + noise * rms * np.random.default_rng(seed).standard_normal(len(velocity))
    channels = {"time": time, "torque": amplitude * np.sin(omega * time), "velocity": noisy}
    return Recording(f"paper-{noise}-{seed}", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def drive(model: str = "asymmetric-coulomb-viscous", inertia: float | None = INERTIA) -> Drive:
    """Return the paper's drive with a model by name."""
    return Drive(Model.parse(model), inertia)


@pytest.fixture(scope="session")
def paper() -> SimpleNamespace:
    """The paper's drive: ``recording(…)``, ``drive(…)`` and the true values."""
    return SimpleNamespace(
        recording=recording, drive=drive, true=TRUE, inertia=INERTIA, omega=OMEGA, amplitude=AMPLITUDE
    )
