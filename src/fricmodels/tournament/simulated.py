"""A tournament's simulated recordings, made from the plain values that describe them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording


@lru_cache(maxsize=8)
def _drive(model: str, motion: Motion) -> Drive:
    return Drive(Model.parse(model), None, motion)


def simulated(name: str, values: Mapping[str, Any]) -> Recording:
    """Return the recording that the values of a source describe."""
    from fricmodels.simulation import simulate

    drive = _drive(values["model"], Motion(values["motion"]))
    step = 2 * math.pi / values["frequency"] / values["samples_per_cycle"]
    time = step * np.arange(values["cycles"] * values["samples_per_cycle"])
    return simulate(
        drive,
        {drive.inertia_key: values["inertia"], **values["parameters"]},
        time,
        values["amplitude"] * np.sin(values["frequency"] * time),
        noise=values["noise_percent"],
        quantisation=values["quantisation"],
        hold=values["hold"],
        between_samples=values["between_samples"],
        seed=values["seed"],
        name=name,
    )
