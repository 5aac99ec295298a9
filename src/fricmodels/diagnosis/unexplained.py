"""Whether a residual could be predicted at all, from which channel, whatever the physics.

Each *view* is a flexible set of shapes in one channel: hats over speed, waves over position, … . A view that predicts
the residual on held-out blocks shows that something is missing there; where no known effect does as well, it is
unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.evidence import Evidence, Regression
from fricmodels.diagnosis.problem import Problem
from fricmodels.diagnosis.search import periods

Array = NDArray[np.float64]

_HATS = 8
_WAVES = 6
_FINE_WAVES = 3


@dataclass(frozen=True)
class View:
    """What one channel predicts of the residual.

    Attributes:
        channels: in words.
        evidence: of its shapes, all together.
        p_value: corrected for the number of views.
    """

    channels: str
    evidence: Evidence
    p_value: float


def views(problem: Problem, regression: Regression) -> list[View]:
    """Return every view of the residual, the best predictor first."""
    shapes = {**_shapes(problem), **_periodic(problem, regression)}
    found = []
    for channels, build in shapes.items():
        columns = problem.integrals(build())
        visible = regression.visible(columns)
        room = max(1, regression.terms // 2)
        chosen = np.flatnonzero(visible)[:room]
        if not len(chosen):
            continue
        evidence = regression.test(columns[chosen])
        found.append(View(channels, evidence, min(1.0, evidence.p_value * len(shapes))))
    return sorted(found, key=lambda view: float(np.sum(view.evidence.loss)))


def _shapes(problem: Problem) -> Mapping[str, Callable[[], Array]]:
    points = problem.quadrature.recording
    velocity = points.velocity
    speed, side = np.abs(velocity), np.sign(velocity)
    shapes: dict[str, Callable[[], Array]] = {
        "speed, along the motion": lambda: side * _hats(speed),
        "speed, the same in both directions": lambda: _hats(speed),
        "time, along the motion": lambda: side * _hats(points.time),
        "time, the same in both directions": lambda: _hats(points.time),
        "motor torque": lambda: _powers(problem.motor_torque),
        "motor torque, along the motion": lambda: side * np.abs(_powers(problem.motor_torque)),
        "rate of the motor torque": lambda: np.vstack([points["torque_rate"], side * np.abs(points["torque_rate"])]),
        "acceleration": lambda: np.vstack([points["acceleration"], side * np.abs(points["acceleration"])]),
    }
    if "position" in points:
        waves = _waves(points["position"])
        shapes["position"] = lambda: waves
        shapes["position, along the motion"] = lambda: side * waves
        shapes["position and motor torque"] = lambda: problem.motor_torque * waves
        travelled = _since_reversal(problem)
        shapes["distance since the last reversal"] = lambda: side * _decays(travelled)
    if "load_torque" in points:
        shapes["load torque"] = lambda: _powers(points.load_torque)
        shapes["load torque, along the motion"] = lambda: side * np.abs(_powers(points.load_torque))
        shapes["load torque and direction"] = lambda: np.vstack(
            [
                points.load_torque,
                np.abs(points.load_torque),
                side * points.load_torque,
                side * np.abs(points.load_torque),
            ]
        )
    if "temperature" in points:
        warm = points["temperature"] - np.mean(points["temperature"])
        shapes["temperature"] = lambda: np.vstack([warm, side * warm, velocity * warm, side * warm**2])
    return shapes


def _periodic(problem: Problem, regression: Regression) -> dict[str, Callable[[], Array]]:
    """Return waves over position at the wave numbers at which the residual is most periodic."""
    if "position" not in problem.recording:
        return {}
    points = problem.quadrature.recording
    side = np.sign(points.velocity)
    count = len(problem.recording)
    factors = {
        "position, finely": np.ones(len(side)),
        "position, finely, along the motion": side,
        "position, finely, and motor torque": problem.motor_torque,
    }
    shapes: dict[str, Callable[[], Array]] = {}
    for name, factor in factors.items():
        found = periods(problem, regression, factor[:count], 0.0).strongest[:_FINE_WAVES]
        if found:
            phases = np.outer(found, points["position"])
            waves = factor * np.vstack([np.cos(phases), np.sin(phases)])
            shapes[name] = lambda waves=waves: waves  # type: ignore[misc]
    return shapes


def _hats(values: Array) -> Array:
    knots = np.unique(np.quantile(values, np.linspace(0, 1, _HATS)))
    if len(knots) < 2:
        return np.zeros((1, len(values)))
    return np.stack([np.interp(values, knots, row) for row in np.eye(len(knots))])


def _powers(values: Array) -> Array:
    scale = float(np.max(np.abs(values))) or 1.0
    return np.vstack([values / scale, (values / scale) ** 2, (values / scale) ** 3])


def _waves(position: Array) -> Array:
    low, high = float(np.min(position)), float(np.max(position))
    phase = np.pi * (position - low) / ((high - low) or 1.0)
    numbers = np.arange(1, _WAVES + 1)[:, None]
    return np.vstack([np.cos(numbers * phase), np.sin(numbers * phase)])


def _decays(distance: Array) -> Array:
    positive = distance[distance > 0]
    lengths = np.quantile(positive, [0.02, 0.05, 0.1, 0.2, 0.4]) if len(positive) else np.ones(1)
    return np.stack([np.exp(-distance / length) for length in lengths if length > 0])


def _since_reversal(problem: Problem) -> Array:
    """Return the distance travelled since the direction last changed, at the quadrature's samples."""
    position = problem.recording["position"]
    side = np.sign(problem.smooth)
    turned = np.concatenate([[True], (side[1:] != side[:-1]) | (np.diff(problem.recording.run) != 0)])
    start = np.maximum.accumulate(np.where(turned, np.arange(len(side)), 0))
    distance = np.abs(position - position[start])
    cell = problem.quadrature.cell
    return np.concatenate([distance, distance[cell], np.zeros(len(cell))])
