"""Chooses among models by the motion that they simulate on what was kept back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.loop import Loop
from fricmodels.motion.errors import MotionErrors, motion_errors
from fricmodels.motion.fit import MotionFit, fit_motion
from fricmodels.motion.simulator import Simulator
from fricmodels.recording import Recording


@dataclass(frozen=True)
class Rung:
    """A model that may be chosen: its drive, and parameters by key that a fit of the torque found."""

    drive: Drive
    parameters: Mapping[str, float]

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.drive.model.name


@dataclass(frozen=True)
class Judged:
    """A model fitted to simulated motion on one part of a recording, and simulated on the other.

    Attributes:
        rung: the model.
        kept: what simulates the part that was kept back.
        by_torque: errors of the kept back part with the parameters that the torque gave.
        fit: to the motion of what was fitted; ``None`` where no simulation reaches its end.
        test: errors of the kept back part with these; ``None`` without a fit.
        behind: mean and standard error of the squared error beyond that of the best model, over the pieces that were
            kept back [position²].
        chosen: whether it is the smallest model that is not clearly behind the best one.
    """

    rung: Rung
    kept: Simulator
    by_torque: MotionErrors
    fit: MotionFit | None
    test: MotionErrors | None
    behind: tuple[float, float] = (np.nan, np.nan)
    chosen: bool = False


def judged(
    rungs: Sequence[Rung],
    train: Recording,
    test: Recording,
    *,
    loop: Loop | None = None,
    horizon: int | None = None,
    refit: bool = True,
) -> list[Judged]:
    """Fit models to the motion of what is fitted, and say which to take by the motion of what was kept back.

    The least squared position error on the pieces that were kept back is that of the best model; the choice is the
    first one, in order of the number of parameters, that is within one standard error of it (the standard error of the
    difference between two models over the pieces). Nothing but the recording that is fitted takes part.

    Args:
        rungs: models with a start for each; the optimum of each is a start for the next, which may contain it.
        train, test: prepared; see :func:`fricmodels.diagnosis.comparison.kept_back`.
        loop: what pushes the drive; the recorded torque if not given.
        horizon: samples of a window.
        refit: whether to fit the parameters to the motion; where not, only :attr:`Judged.by_torque` is known.

    Source of the rule: L. Breiman et al., "Classification and regression trees", 1984.
    """
    found: list[Judged] = []
    squares = []
    before: dict[str, float] = {}
    for rung in rungs:
        fitted = Simulator(rung.drive, train, loop=loop, horizon=horizon)
        kept = Simulator(rung.drive, test, loop=loop, horizon=horizon)
        started = dict(rung.parameters)
        if loop is not None:
            started |= {key: p.initial for key, p in zip(loop.keys, loop.parameters, strict=True)}
        by_torque = motion_errors(kept, started)
        if not refit:
            found.append(Judged(rung, kept, by_torque, None, None))
            continue
        try:
            fit = fit_motion(fitted, [started, {**started, **before}])
        except EstimationError:
            found.append(Judged(rung, kept, by_torque, None, None))
            squares.append(np.full(len(np.unique(test.run)), np.inf))
            continue
        before = dict(fit.parameters)
        found.append(Judged(rung, kept, by_torque, fit, motion_errors(kept, fit.parameters)))
        squares.append(_by_piece(kept, fit.parameters))
    if not squares:
        return found
    means = [float(np.mean(each)) if np.all(np.isfinite(each)) else np.inf for each in squares]
    if not np.isfinite(min(means)):
        return found
    best = int(np.argmin(means))
    behind = [_difference(each, squares[best]) for each in squares]
    within = [i for i, (more, error) in enumerate(behind) if np.isfinite(more) and more <= error]
    chosen = min(within or [best], key=lambda i: (len(rungs[i].drive.parameters), i))
    return [
        Judged(each.rung, each.kept, each.by_torque, each.fit, each.test, behind[i], i == chosen)
        for i, each in enumerate(found)
    ]


def _by_piece(simulator: Simulator, values: Mapping[str, float]) -> Array:
    """Return the mean squared error of the position (of the velocity without one) on each piece."""
    position, velocity = simulator(values)
    measured = simulator.recording
    known = "position" in measured
    error = position - measured["position"] if known else velocity - measured.velocity
    return np.array(
        [np.mean(error[simulator.scored & (measured.run == number)] ** 2) for number in np.unique(measured.run)]
    )


def _difference(own: Array, best: Array) -> tuple[float, float]:
    """Return by how much a model is behind on the mean, and the standard error of that over the pieces."""
    if own is best:
        return 0.0, 0.0
    if not np.all(np.isfinite(own)):
        return float("inf"), 0.0
    more = own - best
    return float(np.mean(more)), float(np.std(more, ddof=1) / np.sqrt(len(more))) if len(more) > 1 else 0.0
