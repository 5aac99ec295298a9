"""RMS error over the Cramér–Rao bound on the paper's drive, the noise being 5, 10 and 20 % as a standard deviation.

    python benchmarks/efficiency.py                 100 recordings a level
    python benchmarks/efficiency.py --seeds 20

The ratio is the root of the mean, over recordings and the four coefficients, of (error/bound)²; 1 is the least that an
unbiased estimator can reach. Beside it stand the ratios of the single coefficients.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fricmodels import plugins
from paper import AMPLITUDE, KEYS, LEVELS, TRUE, bound_covariance, drive, sinusoid, table

ENTRANTS: Sequence[tuple[str, Mapping[str, Any]]] = (
    ("batch", {}),
    ("batch", {"objective": "simulation"}),
    ("detchmendy-sridhar", {}),
    ("detchmendy-sridhar", {"weight_of_observations": 100.0, "weight_of_model": 0.0, "average": 0.0}),
    ("ekf", {}),
)


def ratios(estimator: str, settings: Mapping[str, Any], level: float, seeds: int) -> np.ndarray:
    """Return error over bound, a row for each recording, a column for each coefficient."""
    bound = np.sqrt(np.diag(bound_covariance(AMPLITUDE, level)))
    solver = plugins.load().estimators[estimator](settings)
    rows = []
    for seed in range(seeds):
        found = solver.solve(drive(), sinusoid(TRUE, noise=level, seed=seed), seed).parameters
        rows.append([100 * (found[key] / TRUE[key] - 1) for key in KEYS])
    return np.array(rows) / bound


def section(seeds: int, entrants: Sequence[tuple[str, Mapping[str, Any]]] = ENTRANTS) -> str:
    """Return the table, a row for each estimator and level."""
    listed = []
    for estimator, settings in entrants:
        label = ", ".join(f"{key}: {value}" for key, value in settings.items())
        for level in LEVELS[1:]:
            square = ratios(estimator, settings, level, seeds) ** 2
            whole = np.sqrt(np.mean(square))
            chance = np.std(np.mean(square, axis=1)) / np.sqrt(seeds) / (2 * whole)
            each = np.sqrt(np.mean(square, axis=0))
            listed.append([f"`{estimator}`", label, level, f"{whole:.2f} ± {chance:.2f}", *(f"{r:.2f}" for r in each)])
            print(*listed[-1], flush=True)
    return table(["estimator", "settings", "noise %", "RMS error / bound", *KEYS], listed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=100, help="recordings a level")
    print(section(parser.parse_args().seeds))


if __name__ == "__main__":
    main()
