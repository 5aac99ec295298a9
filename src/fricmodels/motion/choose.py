"""Chooses among models by the motion that they simulate on what they were not fitted to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricmodels import progress
from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.loop import Loop
from fricmodels.motion.between import torque_between_samples
from fricmodels.motion.errors import MotionErrors, motion_errors
from fricmodels.motion.fit import MotionFit, fit_motion
from fricmodels.motion.simulator import Simulator
from fricmodels.motion.validate import folds, log_error, scores
from fricmodels.recording import Recording


@dataclass(frozen=True)
class Rung:
    """A model that may be chosen: its drive, and parameters by key that a fit of the torque found.

    Those of a loop may be among them; it begins as declared where they are not.
    """

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
        behind: mean and standard error, over the parts that were held out in turn, of the logarithm of the RMS error
            over that of the best model: 0.1 is an error that is a tenth larger.
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
) -> list[Judged]:
    r"""Fit models to the motion of what is fitted, and say which to take.

    Where both parts are cut from one recording, it is cut anew into six parts, each of which is held out in turn and
    simulated with what the others give, in windows of three lengths (:mod:`fricmodels.motion.validate`); else the
    pieces of ``test`` count. The best model has the least mean logarithm of the error; the choice is the first one, in
    order of the number of parameters, that is within one standard error of it: that of the difference between two
    models over K parts, :math:`s\sqrt{1/K + 1/(K-1)}`, as the fits share most of their data. Nothing but the recording
    that is fitted takes part. Whether the torque is held between samples is found there too, with the largest model.

    Args:
        rungs: models with a start for each; the optimum of each is a start for the next, which may contain it.
        train: prepared; see :func:`fricmodels.diagnosis.comparison.kept_back`.
        test: the same, of what is kept back.
        loop: what pushes the drive; the recorded torque if not given.
        horizon: samples of a window.

    Numbers of a model that are held are not fitted, and not chosen: only :attr:`Judged.by_torque` is known of them.

    Source of the rule: L. Breiman et al., "Classification and regression trees", 1984; of the standard error:
    C. Nadeau, Y. Bengio, "Inference for the generalization error", Machine Learning 52, 2003.
    """
    found: list[Judged] = []
    errors = []
    one, other = train.origin, test.origin
    cut = one is not None and other is not None and one.whole is other.whole  # from the same recording
    held = [rung.drive.model.known.fixed for rung in rungs]
    parts = folds(one.whole) if one is not None and cut and not all(held) else []
    doing = "simulating models" if all(held) else "fitting models to the motion"
    before: dict[str, float] = {}
    largest = max(rungs, key=lambda rung: len(rung.drive.parameters))
    between = torque_between_samples(largest.drive, largest.parameters, train, loop=loop)
    for rung, as_it_is in progress.each(doing, list(zip(rungs, held, strict=True))):
        fitted = Simulator(rung.drive, train, loop=loop, horizon=horizon, between_samples=between)
        kept = Simulator(rung.drive, test, loop=loop, horizon=horizon, between_samples=between)
        started = dict(rung.parameters)
        if loop is not None:
            started = {key: p.initial for key, p in zip(loop.keys, loop.parameters, strict=True)} | started
        by_torque = motion_errors(kept, started)
        if as_it_is:
            found.append(Judged(rung, kept, by_torque, None, None))
            continue
        try:
            fit = fit_motion(fitted, [started, {**started, **before}])
        except EstimationError:
            found.append(Judged(rung, kept, by_torque, None, None))
            errors.append(np.full(len(parts) or len(np.unique(test.run)), np.inf))
            continue
        before = dict(fit.parameters)
        found.append(Judged(rung, kept, by_torque, fit, motion_errors(kept, fit.parameters)))
        if parts and len(rungs) > 1:
            own = scores(rung.drive, fit.parameters, parts, loop=loop, horizon=horizon, between_samples=between)
            errors.append(np.mean(own, axis=1))
        else:
            errors.append(_by_piece(kept, fit.parameters))
    if not errors:
        return found
    means = [float(np.mean(each)) if np.all(np.isfinite(each)) else np.inf for each in errors]
    if not np.isfinite(min(means)):
        return found
    best = int(np.argmin(means))
    behind = [_difference(each, errors[best]) for each in errors]
    within = [i for i, (more, error) in enumerate(behind) if np.isfinite(more) and more <= error]
    fitted_to_motion = [i for i, as_it_is in enumerate(held) if not as_it_is]
    chosen = min(within or [best], key=lambda i: (len(rungs[fitted_to_motion[i]].drive.parameters), i))
    for i, place in enumerate(fitted_to_motion):
        found[place] = replace(found[place], behind=behind[i], chosen=i == chosen)
    return found


def _by_piece(simulator: Simulator, values: Mapping[str, float]) -> Array:
    """Return the logarithm of the RMS error of each piece."""
    run = simulator.recording.run
    return np.array([log_error(simulator, values, run == number) for number in np.unique(run)])


def _difference(own: Array, best: Array) -> tuple[float, float]:
    """Return by how much a model is behind on the mean, and the standard error of that over the parts."""
    if own is best:
        return 0.0, 0.0
    if not np.all(np.isfinite(own)):
        return float("inf"), 0.0
    more, parts = own - best, len(own)
    if parts < 2:
        return float(np.mean(more)), 0.0
    return float(np.mean(more)), float(np.std(more, ddof=1) * np.sqrt(1 / parts + 1 / (parts - 1)))
