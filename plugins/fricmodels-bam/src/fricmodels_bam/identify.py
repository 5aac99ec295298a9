"""Identifies motor and friction of the servo on the bench: least squares of the position, then its absolute error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels_bam import LAWS
from fricmodels_bam.bench import Bench, Log

Array: TypeAlias = NDArray[np.float64]

_MOTOR_START = {"k_t": 0.4, "R": 4.0, "armature": 0.002, "q_offset": 0.0}
_MOTOR_BOUNDS = {"k_t": (0.05, 5.0), "R": (0.5, 50.0), "armature": (1e-5, 0.1), "q_offset": (-0.2, 0.2)}
_FRICTION_START = {
    "K_v": 0.005, "K_c": 0.015, "K_cs": 0.003, "omega_s": 0.2, "alpha": 2.0, "K_l": 0.1, "K_ls": 0.05, "K_m": 0.1,
    "K_e": 0.1, "K_ms": 0.05, "K_es": 0.05, "K_mq": 0.1, "K_eq": 0.1,
}  # fmt: skip
_SIMPLER = {"bam-m2": "bam-m1", "bam-m3": "bam-m1", "bam-m4": "bam-m3", "bam-m5": "bam-m4", "bam-m6": "bam-m5"}
"""Each law continues from one that it contains."""
_SPLIT = {"K_m": "K_l", "K_e": "K_l", "K_ms": "K_ls", "K_es": "K_ls"}
"""M5 with these equal is M4."""
_FLOOR = 1e-3
"""Smallest size in which a parameter is counted."""


def identify(logs: Sequence[Log], *, evaluations: int = 300) -> dict[str, dict[str, float]]:
    """Return the parameters of all six laws by name, each law started from a simpler one that it contains.

    Args:
        logs: recordings of the bench.
        evaluations: most simulations of the logs in the second stage, for each law.
    """
    found: dict[str, dict[str, float]] = {}
    for law in LAWS:
        bench = Bench(law)
        known = {**_MOTOR_START, **_FRICTION_START, **found.get(_SIMPLER.get(law.name, ""), {})}
        known |= {key: known[whole] for key, whole in _SPLIT.items()}
        found[law.name] = _refine(bench, logs, {key: known[key] for key in bench.keys}, evaluations)
    return found


def _refine(bench: Bench, logs: Sequence[Log], start: Mapping[str, float], evaluations: int) -> dict[str, float]:
    from scipy.optimize import least_squares, minimize

    declared = {p.key: (p.declared.lower, p.declared.upper) for p in bench.model.parameters}
    low, high = np.array([{**_MOTOR_BOUNDS, **declared}[key] for key in bench.keys]).T
    begin = np.clip([start[key] for key in bench.keys], low, high)
    size = np.maximum(np.abs(begin), _FLOOR)
    low, high = low / size, high / size

    def values(scaled: Array) -> dict[str, float]:
        return dict(zip(bench.keys, (np.clip(scaled, low, high) * size).tolist(), strict=True))

    def residual(scaled: Array) -> Array:
        return np.concatenate([bench.positions(log, values(scaled)) - log.position for log in logs])

    def error(scaled: Array) -> float:
        return bench.error(logs, values(scaled))

    inside = np.clip(begin / size, np.nextafter(low, high), np.nextafter(high, low))
    smooth = least_squares(
        residual, inside, bounds=(low, high), diff_step=3e-3, loss="soft_l1", f_scale=0.02, max_nfev=60
    ).x
    best = min((begin / size, smooth), key=error)
    bounds = list(zip(low, np.where(np.isfinite(high), high, 1e3), strict=True))
    options = {"maxfev": evaluations, "xtol": 1e-3, "ftol": 1e-5}
    polished = minimize(error, best, method="Powell", bounds=bounds, options=options).x
    return values(min((best, polished), key=error))
