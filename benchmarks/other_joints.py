"""Another joint that pulls, and joints that do not: how often the coupling is named, its interval true, a name false.

    python benchmarks/other_joints.py [--drives N]

One joint of 0.5 kg m² follows a sum of four sines for 30 s at 200 Hz, with Coulomb and viscous friction, white noise on
torque (2 % of the Coulomb torque) and velocity. Other joints follow sums of their own.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis import Diagnosis, compare, diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

Array = NDArray[np.float64]
Motions = Callable[[Array], tuple[Array, Array, Array]]
INERTIA, K_C, K_V = 0.5, 1.0, 0.6
COUPLING = 0.06
SAMPLES, INTERVAL, FINE = 6000, 0.005, 16


def motion(rng: np.random.Generator) -> Motions:
    """Return position, velocity and acceleration of a joint as functions of time."""
    omega, phase = 2 * np.pi * rng.uniform(0.15, 1.2, 4), rng.uniform(0, 2 * np.pi, 4)
    size = 0.6 * np.pi * rng.uniform(0.3, 1.0, 4)

    def at(t: Array) -> tuple[Array, Array, Array]:
        angle = omega[:, None] * t + phase[:, None]
        return (size / omega) @ np.sin(angle), size @ np.cos(angle), -(size * omega) @ np.sin(angle)

    return at


def drive(
    seed: int, coupling: float, joints: int, *, runs: int = 1, offsets: float = 0.0, lasting: float = 0.0
) -> Recording:
    """Return a recording of one joint beside others, of which the first pulls at it.

    Args:
        seed: of motions and noise.
        coupling: inertia that it shares with the first of the others [kg m²].
        joints: how many others were recorded, each with position, velocity and acceleration.
        runs: number of runs, of equal length.
        offsets: standard deviation of the torque sensor's zero from run to run [N m].
        lasting: size of a disturbance that lasts 0.3 s and lies in no channel, in shares of the RMS torque.
    """
    from scipy.signal import lfilter

    rng = np.random.default_rng(seed)
    own, others = motion(rng), [motion(rng) for _ in range(max(joints, 1))]
    t = np.arange(SAMPLES) * INTERVAL
    between = ((np.arange(FINE) + 0.5) / FINE - 0.5) * INTERVAL
    fine = (t[:, None] + between).ravel()
    _, velocity, acceleration = own(fine)
    pushed = INERTIA * acceleration + K_C * np.sign(velocity) + K_V * velocity + coupling * others[0](fine)[2]
    torque = pushed.reshape(SAMPLES, FINE).mean(axis=1)
    lasts = lfilter([1.0], [1.0, -np.exp(-INTERVAL / 0.3)], rng.standard_normal(SAMPLES))
    torque += lasting * float(np.sqrt(np.mean(torque**2))) * lasts / float(np.std(lasts))
    run = (np.arange(SAMPLES) * runs // SAMPLES).astype(np.int64)
    torque += rng.normal(0, offsets, runs)[run] + 0.02 * K_C * rng.standard_normal(SAMPLES)
    position, velocity, _ = own(t)
    channels = {"time": t, "torque": torque, "velocity": velocity + 1e-3 * rng.standard_normal(SAMPLES)}
    channels["position"] = position
    units = {}
    for number, other in enumerate(others[:joints], start=2):
        for name, unit, values in zip(
            ("position", "velocity", "acceleration"), ("rad", "rad/s", "rad/s^2"), other(t), strict=True
        ):
            channels[f"other.j{number}_{name}"] = values
            units[f"other.j{number}_{name}"] = unit
    return Recording("joint 1", Motion.ROTARY, channels, run, units=units)


def answer(found: Diagnosis) -> str:
    """Return what a diagnosis named, or its verdict."""
    return ", ".join(found.findings[0].names) if found.findings else found.verdict


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=100, help="number of drives of each kind")
    count = parser.parse_args().drives
    key = "other(j2_acceleration).c"
    inside = 0
    for seed in range(count):
        found = compare(drive(seed, COUPLING, 1), "coulomb-viscous+other(j2_acceleration)", INERTIA).estimate
        inside += abs(found.parameters[key] - COUPLING) < 1.96 * found.standard_errors[key]
    print(f"95 % interval of the coupling holds the truth: {inside} of {count}")
    cases: dict[str, Callable[[int], Recording]] = {
        "coupled, two further joints": lambda seed: drive(seed, COUPLING, 3),
        "not coupled, three joints recorded": lambda seed: drive(seed, 0.0, 3),
        "not coupled, a lasting disturbance of 3 %": lambda seed: drive(seed, 0.0, 3, lasting=0.03),
        "five runs, zeroed anew": lambda seed: drive(seed, 0.0, 0, runs=5, offsets=0.2),
        "five runs, nothing hidden": lambda seed: drive(seed, 0.0, 0, runs=5),
    }
    for number, (name, make) in enumerate(cases.items(), start=1):
        begin = time.perf_counter()
        named = Counter(
            answer(diagnose(make(10_000 * number + seed), "coulomb-viscous", INERTIA)) for seed in range(count)
        )
        seconds = (time.perf_counter() - begin) / count
        print(f"{name}: {dict(named.most_common())} ({seconds:.2f} s each)")


if __name__ == "__main__":
    main()
