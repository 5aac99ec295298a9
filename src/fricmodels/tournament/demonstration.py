"""The tournament of ``fricmodels demo``; ``configs/demo.yaml`` says the same in YAML."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fricmodels.tournament.config import Config

MOTOR = {
    "model": "asymmetric-coulomb-viscous",
    "parameters": {"K_v1": 1.0e-4, "K_v2": 6.6e-5, "K_c1": 1.0e-2, "K_c2": 6.6e-3},
    "inertia": 4.87e-6,
    "amplitude": 0.02,
    "frequency": 39.54,
    "noise_percent": 2,
}
"""The motor of Elhami and Brookfield (1997), simulated; SI units."""

LAWS = (
    "coulomb-viscous",
    "asymmetric-coulomb-viscous",
    "exponential-stick-slip",
    "asymmetric-exponential-stick-slip",
    "square-root",
    "two-thirds-power",
)
ESTIMATORS = ("detchmendy-sridhar", "ekf", "batch", "rls", "constant-velocity")
"""By name, not ``all``: whatever plugins are installed, it shows the same and takes as long."""


def demonstration() -> Config:
    """Return a tournament of every built-in law and estimator on the paper's motor with 2 % noise."""
    dataset = {"name": "simulated motor", "simulate": MOTOR}
    everything = {"models": list(LAWS), "estimators": list(ESTIMATORS), "simulate": False}
    return Config.model_validate({"name": "demo", "datasets": [dataset], **everything})


def with_and_without(data: Path, models: Sequence[str], inertia: float) -> Config:
    """Return a tournament of the models of a ladder on the recording that it was climbed on."""
    dataset = {"name": data.stem, "files": str(data.resolve()), "inertia": inertia}
    chosen = {"models": list(dict.fromkeys(models)), "estimators": ["batch"], "simulate": False}
    return Config.model_validate({"name": "with and without", "datasets": [dataset], **chosen})
