"""Drives whose sensors are coarse: counts, differences of counts, and a torque in steps of its RMS value.

A drive keeps one speed after the other, between 0.02 and 8 rad/s, with one stop in seven; 1 kHz, an encoder of 12 or 14
bit, and a torque with noise of 0.5 % of its RMS value before it is rounded. With nothing hidden a name is false; a
Stribeck friction of 60 % of the Coulomb torque is hidden in the others. Of the true model it is printed how many
standard errors its parameters are off, in the mean square, and how many intervals of 95 % hold.

    python benchmarks/coarse_sensors.py [--seeds 12]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from derivative_width import FINE, read_off, steps
from fricmodels import compare, diagnose
from fricmodels.dimension import Motion
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording

Array = NDArray[np.float64]
INERTIA, STRIBECK, SPEED = 1e-3, 0.03, 0.3
TRUE = {"K_v": 3e-3, "K_c": 0.05, "stribeck.F_s": STRIBECK, "stribeck.omega_s": SPEED}
RATE, NOISE, FIRST = 1000, 5e-4, 20


def drawn(seed: int, bits: int, hidden: bool) -> tuple[Array, Array, Array]:
    """Return time, counted position and torque, its mean over each sample."""
    velocity, every = steps(seed, 8.0, 12.0), FINE // RATE
    friction = TRUE["K_c"] + hidden * STRIBECK * np.exp(-np.abs(velocity) / SPEED)
    torque = INERTIA * np.gradient(velocity) * FINE + TRUE["K_v"] * velocity + friction * np.sign(velocity)
    time, position, _ = read_off(velocity, RATE, bits, 0.0, seed)
    mean = np.convolve(torque, np.full(every, 1.0 / every), "same")[::every]
    return time, position, mean + NOISE * np.random.default_rng(seed).standard_normal(len(time))


def recorded(time: Array, torque: Array, **motion: Array) -> Recording:
    """Return it as a recording."""
    channels = {"time": time, "torque": torque, **motion}
    return Recording("coarse", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def sensors(seed: int, hidden: bool) -> Iterator[tuple[str, Recording]]:
    """Yield what each set of sensors records of a drive."""
    for bits in (12, 14):
        time, position, torque = drawn(seed, bits, hidden)
        yield f"{bits} bit, positions", recorded(time, torque, position=position)
        change = np.diff(position, prepend=position[0]) * RATE
        yield f"{bits} bit, differences", recorded(time, torque, velocity=change)
    size = float(np.sqrt(np.mean(torque**2)))
    for share in (0.02, 0.05, 0.1, 0.2):
        rounded = share * size * np.round(torque / (share * size))
        yield f"torque in steps of {100 * share:g} %", recorded(time, rounded, position=position)


def tried(plain: Recording, hidden: Recording) -> tuple[bool, bool, bool, list[float]]:
    """Return whether a false name is given, nothing known, the effect found; and how far off the true model is."""
    try:
        nothing = diagnose(plain, "coulomb-viscous", INERTIA)
        first = next((one.names for one in diagnose(hidden, "coulomb-viscous", INERTIA).findings), ())
        fit = compare(hidden, "coulomb-viscous+stribeck", INERTIA).estimate
    except FricmodelsError:  # it "moves too little"
        return False, True, False, []
    errors = {key: fit.standard_errors.get(key, np.inf) for key in TRUE}
    off = [(fit.parameters[key] - value) / errors[key] for key, value in TRUE.items() if errors[key] > 0.0]
    return bool(nothing.findings), nothing.verdict == "unknown-effect", "stribeck" in first, off


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=12, help="drives of each kind")
    count = parser.parse_args().seeds
    found: dict[str, list[tuple[bool, bool, bool, list[float]]]] = {}
    for seed in range(FIRST, FIRST + count):
        for (name, plain), (_, hidden) in zip(sensors(seed, False), sensors(seed, True), strict=True):
            found.setdefault(name, []).append(tried(plain, hidden))
    print(f"{'':<26} false  unknown  found  standard errors off  intervals that hold")
    for name, rows in found.items():
        off = np.concatenate([row[3] for row in rows])
        counts = [sum(row[i] for row in rows) for i in range(3)]
        print(
            f"{name:<26} {counts[0]:>5}  {counts[1]:>7}  {counts[2]:>5}  {np.sqrt(np.mean(off**2)):>19.2f}  "
            f"{np.mean(np.abs(off) < 1.96):>8.0%}   of {len(rows)} and {len(rows)} drives, {len(off)} parameters"
        )


if __name__ == "__main__":
    main()
