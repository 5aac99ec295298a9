"""How many cosines estimate the variance of a test: what it costs and what it gives.

    python benchmarks/score_terms.py [--replications N]

Rows of the weak form overlap: here white or lasting noise is summed under bumps of eight rows, two of which are
independent. For so many rows and columns the table shows how often a true null is rejected at 1 % and at 0.1 %, and
how often columns that explain a third of the rows are seen with p < 1e-4, with the fewest cosines (0.4 T^(2/3), at
least 8) and with as many as the scores allow.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray

from fricmodels.weakform.regression import Regression

Array = NDArray[np.float64]
WIDTH = 8
EVIDENT, EXPLAINED = 1e-4, 1 / 3
NOISES = {"white": 0.0, "lasting": 0.9, "long": 0.97}
"""Correlation of the noise from row to row, before it is summed."""


def summed(rho: float, count: int, rows: int, rng: np.random.Generator) -> Array:
    """Return a first-order process under bumps, shape (count, rows)."""
    from scipy.signal import lfilter

    noise = lfilter([1.0], [1.0, -rho], rng.standard_normal((count, rows + 300)), axis=1)[:, 300:]
    bump = np.hanning(WIDTH + 3)[1:-1]
    return np.array([np.convolve(row, bump, "same") for row in noise])


def p_values(rho: float, rows: int, columns: int, explained: float, rng: np.random.Generator) -> tuple[float, float]:
    """Return the p-value of columns that explain a share of the rows, with the fewest cosines and with more."""
    target = summed(rho, 1, rows, rng)[0]
    tried = summed(float(rng.choice([0.0, 0.9, 0.97])), columns, rows, rng)
    if explained:
        signal = tried.sum(axis=0)
        target = target + signal * np.sqrt(explained / (1 - explained)) * np.std(target) / np.std(signal)
    base = np.vstack([np.ones(rows), summed(0.9, 2, rows, rng)])
    few, many = (Regression(base, target, 2.0 * rows / WIDTH, strokes) for strokes in (1.0, np.inf))
    return few.test(tried).p_value, many.test(tried).p_value


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--replications", type=int, default=1000)
    count = parser.parse_args().replications
    print("| noise | rows | columns | null, p < 1 % | more cosines | p < 0.1 % | more | effect seen | more |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, rho in NOISES.items():
        for rows in (200, 400, 1000):
            for columns in (2, 4):
                rng = np.random.default_rng([rows, columns, round(100 * rho)])
                null = np.array([p_values(rho, rows, columns, 0.0, rng) for _ in range(count)])
                real = np.array([p_values(rho, rows, columns, EXPLAINED, rng) for _ in range(count // 4)])
                shares = [*(null < 0.01).mean(axis=0), *(null < 0.001).mean(axis=0), *(real < EVIDENT).mean(axis=0)]
                print(f"| {name} | {rows} | {columns} | " + " | ".join(f"{100 * x:.1f} %" for x in shares) + " |")


if __name__ == "__main__":
    main()
