"""An independent simulation of the paper's drive: Karnopp's velocity band, many small trapezium-rule steps."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fricmodels.dimension import Motion
from fricmodels.recording import Recording

INERTIA = 4.87e-6
OMEGA = 39.54
TRUE = {"K_v1": 1.0e-4, "K_v2": 6.6e-5, "K_c1": 1.0e-2, "K_c2": 6.6e-3}
AMPLITUDE = 0.03


@njit
def _motion(count, per_sample, step, omega, amplitude, inertia, k, exponential):
    """k: K_v1, K_v2, K_c1, K_c2, C_1, C_2, B_1, B_2."""
    velocities = np.zeros(count)
    velocity, time = 0.0, 0.0
    band = 1e-6
    for i in range(1, count):
        for _ in range(per_sample):
            drive = 0.5 * amplitude * (math.sin(omega * time) + math.sin(omega * (time + step)))
            time += step
            if abs(velocity) <= band:
                if -k[3] <= drive <= k[2]:
                    velocity = 0.0
                    continue
                direction = 1 if drive > 0 else -1
            else:
                direction = 1 if velocity > 0 else -1
            speed = abs(velocity)
            j = 0 if direction > 0 else 1
            coulomb = k[4 + j] + (k[2 + j] - k[4 + j]) * math.exp(-k[6 + j] * speed)
            first = (drive - direction * (k[j] * speed + coulomb)) / inertia
            speed = max(direction * (velocity + step * first), 0.0)
            coulomb = k[4 + j] + (k[2 + j] - k[4 + j]) * math.exp(-k[6 + j] * speed)
            second = (drive - direction * (k[j] * speed + coulomb)) / inertia
            new = velocity + 0.5 * step * (first + second)
            velocity = 0.0 if new * direction < 0 else new
        velocities[i] = velocity
    return velocities


def paper_recording(
    noise: float = 0.0,
    seed: int = 0,
    *,
    cycles: int = 10,
    per_cycle: int = 200,
    amplitude: float = AMPLITUDE,
    omega: float = OMEGA,
    slip: tuple[float, float] | None = None,
    rate: tuple[float, float] = (0.5, 0.5),
    inertia: float = INERTIA,
    true: dict[str, float] = TRUE,
) -> Recording:
    """Simulate the drive; ``noise`` is the standard deviation of white velocity noise over the RMS velocity."""
    count = cycles * per_cycle
    step = 2 * np.pi / omega / per_cycle
    c = slip or (true["K_c1"], true["K_c2"])
    k = np.array([true["K_v1"], true["K_v2"], true["K_c1"], true["K_c2"], *c, *rate])
    velocity = _motion(count, 40, step / 40, omega, amplitude, inertia, k, slip is not None)
    time = step * np.arange(count)
    rms = float(np.sqrt(np.mean(velocity**2)))
    noisy = velocity + noise * rms * np.random.default_rng(seed).standard_normal(count)
    channels = {"time": time, "torque": amplitude * np.sin(omega * time), "velocity": noisy}
    return Recording(f"paper-{noise}-{seed}", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))
