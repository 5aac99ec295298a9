"""How near the best is the width over which a coarse encoder's position is differentiated?

A motion of steps between constant speeds, each drawn between a 400th of the largest and the largest, with one stop in
seven, is read off an encoder at 50 to 4000 Hz, with and without noise before it is rounded. The velocity is derived
over the width that is chosen from the data alone, and over all others. Printed is the RMS error with the chosen width
over the least that any width has: its mean, what nine in ten stay below, and the largest.

    python benchmarks/derivative_width.py [--seeds 2] [--verbose]
"""

from __future__ import annotations

import argparse
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fricmodels.signals import best_half_width, lanczos_derivative

Array = NDArray[np.float64]
FINE, DURATION, SMOOTHED, STOPS = 20_000, 16.0, 0.04, 0.15
RATES, BITS, FASTEST, NOISE = (50, 100, 200, 500, 1000, 2000, 4000), (12, 14, 16, 18, 20), (1.0, 8.0, 60.0), (0, 0.5, 2)
WIDTHS = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 18, 22, 27, 33, 41, 51, 63, 78, 97, 121, 151, 188, 235)


def steps(seed: int, fastest: float, duration: float = DURATION) -> Array:
    """Return the velocity [rad/s] at :data:`FINE` hertz: levels, smoothed twice over 40 ms."""
    rng = np.random.default_rng(seed)
    levels: list[Array] = []
    while sum(map(len, levels)) < FINE * duration:
        count = int(FINE * rng.uniform(0.2, 0.8))
        speed = rng.choice([-1.0, 1.0]) * fastest * 400.0 ** -rng.uniform()
        levels.append(np.full(count, 0.0 if rng.uniform() < STOPS else speed))
    wanted = np.concatenate(levels)[: int(FINE * duration)]
    window = np.full(int(FINE * SMOOTHED), 1.0 / int(FINE * SMOOTHED))
    found = np.convolve(np.convolve(wanted, window, "same"), window, "same")
    return np.asarray(np.where(np.abs(found) < 1e-9, 0.0, found))


def read_off(velocity: Array, rate: int, bits: int, noise: float, seed: int) -> tuple[Array, Array, Array]:
    """Return the time, the counted position and the true velocity at a rate; noise in steps, before rounding."""
    every, step, rng = FINE // rate, 2.0 * np.pi / 2**bits, np.random.default_rng(seed)
    position = (np.cumsum(velocity) / FINE)[::every]
    if noise:
        position = position + step * (rng.uniform() + noise * rng.standard_normal(len(position)))
    return np.arange(len(position)) / rate, np.floor(position / step) * step, velocity[::every]


def excess(time: Array, position: Array, velocity: Array) -> tuple[float, int, int]:
    """Return the error with the chosen width over the least one, and both half widths."""
    chosen = best_half_width(time, position)

    def error(half_width: int) -> float:
        derived = lanczos_derivative(time, position, half_width)[1]
        return float(np.sqrt(np.mean((derived - velocity) ** 2)))

    errors = {width: error(width) for width in {*WIDTHS, chosen}}
    best = min(errors, key=lambda width: errors[width])
    return errors[chosen] / errors[best], chosen, best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=2, help="motions of each kind")
    parser.add_argument("--verbose", action="store_true", help="print each that is off by more than a half")
    given = parser.parse_args()
    found = []
    for fastest, seed in product(FASTEST, range(1, given.seeds + 1)):
        velocity = steps(seed, fastest)
        for rate, bits, noise in product(RATES, BITS, NOISE):
            ratio, chosen, best = excess(*read_off(velocity, rate, bits, noise, seed))
            found.append(ratio)
            if given.verbose and ratio > 1.5:
                print(f"{rate} Hz, {bits} bit, {fastest} rad/s, noise {noise}: {chosen} for {best}, {ratio:.2f}")
    ratios = np.array(found)
    print(f"{len(ratios)} recordings, error over the least one: {ratios.mean():.3f} on average,")
    print(f"{np.quantile(ratios, 0.9):.2f} in nine of ten, {ratios.max():.1f} at most;", end=" ")
    print(f"above 1.5 in {np.sum(ratios > 1.5)}, above 2 in {np.sum(ratios > 2.0)}")


if __name__ == "__main__":
    main()
