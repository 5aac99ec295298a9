"""Comparisons whose truth is known: a prescribed motion, and the torque that the law asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from fricmodels.diagnosis.comparison import Comparison, compare_model, kept_back
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report.figures.style import Figure, graph_objects, recolouring
from fricmodels.weakform.prepared import ready

Compared = Callable[..., Comparison]

INERTIA, VISCOUS, COULOMB = 2.0, 0.5, 3.0
ORDER, RIPPLE = 5.0, 0.4
SAMPLES, INTERVAL = 6000, 0.004


def moved(motion: Motion = Motion.ROTARY, *, name: str = "a drive", ripple: float = RIPPLE) -> Recording:
    """Return a recording of two sines of motion with Coulomb and viscous friction, and a ripple over position."""
    time = INTERVAL * np.arange(SAMPLES)
    omega, velocity, position, acceleration = 2 * np.pi * np.array([0.25, 0.61]), 0.0, 0.0, 0.0
    for w, amplitude in zip(omega, (4.0, 2.5), strict=True):
        velocity = velocity + amplitude * np.sin(w * time)
        position = position - amplitude / w * np.cos(w * time)
        acceleration = acceleration + amplitude * w * np.cos(w * time)
    load = 1.5 * np.sin(0.8 * time)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity) + load
    torque = torque + ripple * np.cos(ORDER * position)
    noise = np.random.default_rng(0).standard_normal((2, SAMPLES))
    channels = {
        "time": time,
        "torque": torque + 0.01 * noise[0],
        "velocity": velocity + 1e-3 * noise[1],
        "position": position,
        "load_torque": load,
        "temperature": 20 + 10 * time / time[-1],
    }
    return Recording(name, motion, channels, np.zeros(SAMPLES, dtype=np.int64))


@pytest.fixture(scope="session")
def compared() -> Compared:
    """``compared(recording, "coulomb-viscous", start)`` fits a model; the inertia is known."""

    def build(
        recording: Recording, model: str = "coulomb-viscous", start: Mapping[str, float] | None = None
    ) -> Comparison:
        train, test = kept_back(ready(recording))
        return compare_model(train, test, Drive(Model.parse(model), INERTIA, recording.motion), start)

    return build


@pytest.fixture(scope="session", params=list(Motion))
def comparison(request: pytest.FixtureRequest, compared: Compared) -> Comparison:
    """Coulomb and viscous friction against a drive that ripples, rotary and linear."""
    return compared(moved(request.param))


@pytest.fixture(scope="session")
def rotary(compared: Compared) -> Comparison:
    """The same on a rotary drive."""
    return compared(moved())


def recoloured(figure: Figure, theme: Mapping[str, str]) -> Figure:
    """Return a copy of a figure in other colours, as the script of a page makes it."""
    go = graph_objects()
    return go.Figure(_replaced(figure.to_plotly_json(), recolouring(theme), coloured=False))


def _replaced(value: Any, colours: Mapping[str, str], *, coloured: bool) -> Any:
    """Return a tree of settings in which the colours below any key that speaks of colour are replaced."""
    if isinstance(value, dict):
        return {key: _replaced(each, colours, coloured=coloured or "color" in key) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_replaced(each, colours, coloured=coloured) for each in value]
    return colours.get(value, value) if coloured and isinstance(value, str) else value
