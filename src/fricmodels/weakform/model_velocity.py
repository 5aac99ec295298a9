r"""The fit with friction evaluated at the velocity that the fitted model predicts.

Noise in the velocity does harm twice: it gives the Coulomb torque the wrong sign near standstill, and it weakens every
regressor (errors in variables). The predicted velocity, see :mod:`.predicted_velocity`, has neither fault.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, deviations
from fricmodels.recording import Recording
from fricmodels.signals import velocity_noise
from fricmodels.signals.lanczos import even_weights
from fricmodels.weakform.cases import fitted_as_held
from fricmodels.weakform.feedback import feedback
from fricmodels.weakform.hidden import drowned, sign_is_hidden
from fricmodels.weakform.inference import is_contradicted
from fricmodels.weakform.predicted_velocity import ModelVelocity, both_ways, model_velocity, risk, sought
from fricmodels.weakform.row_noise import FEWEST_WHERE_ALL_COUNT, NOISE_SHARE_WHERE_ALL_COUNT, least_width
from fricmodels.weakform.shift_evidence import STRONG, could_be_shifted, log_odds_of_a_shift
from fricmodels.weakform.solve import Solved, solve
from fricmodels.weakform.tangent import tangents

MAX_ROUNDS = 8
"""Rounds of predicting the velocity by the fit and fitting again."""
_CONTRADICTED = 2.0
"""A fit that leaves so many times the sum of squares of the rows at the smoothed velocity is contradicted by them. One
that is right, where noise makes the fit to these rows wrong by ten standard errors, leaves less than that of 100 rows.
"""
_CLEARLY = 1.25
"""Factor by which half the gain must predict the velocity worse for the measured one to be told from a smoother one. A
difference that wanders without noise gives a third more, a steady one four times as much, noise alone a third less."""
WORSE = 1.1
"""A round whose squared error of prediction is larger than the best by this factor has gone astray."""


def at_model_velocity(found: Solved, *, widen: bool) -> Solved:
    r"""Return the fit with friction evaluated at the velocity that the model predicts, if that is more certain.

    In rounds, while the velocity is not predicted worse. Which velocity is more certain is told by Stein's unbiased
    estimate of its squared error, :math:`\overline{(v - y)^2} + 2\sum_k w_k r_k` but for a constant, with the measured
    y, the autocovariance r of its noise, and the weights w of the samples about each in its own value.

    Args:
        found: the fit at the smoothed velocity. A velocity that was derived from positions, or that moves in steps,
            stays as it is: its error goes with the motion, and the risk does not see it.
        widen: whether test functions may be wider than those of that fit.
    """
    problem = found.problem
    recording = problem.recording
    if recording.derived_over or velocity_noise(recording).course is not None:
        return found
    smooth = risk(recording.velocity, problem.smooth, _smoothed_noise(recording, problem.half_width))
    at_smooth = found
    found, (begin, first) = _with_its_torque(found)
    best, predicted, settled = _rounds(begin, begin.parameters, first, widen=widen)
    certain = settled and not len(best.solution.normal.null.T)
    if sign_is_hidden(recording) and not (certain and _risk_of(predicted, recording) <= smooth):
        # Whether the drive turns at all, and for how long, says more of its Coulomb friction than its speed does.
        everywhere = _everywhere(found)
        shares = drowned(problem.drive, recording, everywhere.parameters)
        held = {max(shares, key=lambda key: shares[key]): 0.0} if max(shares.values(), default=0.0) > 0.0 else {}
        without = solve(everywhere.problem, replace(everywhere.plan, held=held), timing=False)
        starts = [without.values, everywhere.values, found.values]
        values = sought(problem.drive, starts, recording, held, torque_held=found.problem.held)
        from_search = {**begin.parameters, **dict(zip(problem.drive.keys, values, strict=True))}
        other, velocity, _ = _rounds(without, from_search, widen=widen)
        if velocity and (predicted is None or velocity.prediction_error < predicted.prediction_error):
            best, predicted = solve(other.problem, found.plan, timing=False), velocity
    if predicted is None or _risk_of(predicted, recording) > smooth:
        return at_smooth
    if not problem.drive.split(best.parameters)[0] > 0.0:
        return at_smooth  # without inertia any motion fulfils the equation, and none is predicted
    # Simulated with the torque at another time the velocity would be another, and what it is now hides the shift.
    if could_be_shifted(found) and log_odds_of_a_shift(found, reversals=False) > STRONG:
        return at_smooth
    if log_odds_of_a_shift(best.with_shift) > STRONG:
        return at_smooth
    more = found.left_by(best.values) / found.solution.cost - 1.0
    contradicted = found is not at_smooth and is_contradicted(more, len(found.values), found.problem.independent)
    if more > _CONTRADICTED - 1.0 or contradicted:
        return at_smooth  # what the rows at the measured velocity contradict is not more certain than they are

    def fitted(values: Array) -> Array:
        parameters = {**best.parameters, **dict(zip(problem.drive.keys, values.tolist(), strict=True))}
        other = model_velocity(problem.drive, parameters, recording, held=best.problem.held)
        if other is None:
            return best.values
        rows = best.problem.along(other.velocity, other.resting)
        enough = rows.rows > 4 * len(best.values)
        return solve(rows, best.again, timing=False).values if enough else best.values

    return best.changed(feedback=feedback(best, _changes(best, predicted), fitted))


def _changes(found: Solved, predicted: ModelVelocity) -> Array:
    """Return the derivative of the predicted velocity by each of the drive's parameters, shape (n, N)."""
    recording = found.problem.recording
    if predicted.is_measured:
        return np.zeros((len(found.values), len(recording)))
    of_model = tangents(found.problem.drive, found.parameters, recording, predicted.simulated)
    changes = of_model.copy()
    for number, gain in zip(recording.run_numbers, predicted.gains, strict=True):
        inside = np.flatnonzero(recording.run == number)
        for change in changes:
            change[inside] -= both_ways(change[inside], gain)
    changes = np.where(predicted.velocity == predicted.simulated, of_model, changes)
    return np.where(predicted.resting, 0.0, changes)


def _rounds(
    begin: Solved, parameters: Mapping[str, float], first: ModelVelocity | None = None, *, widen: bool
) -> tuple[Solved, ModelVelocity | None, bool]:
    """Return the fit after rounds of predicting the velocity and fitting anew, its velocity, and whether they settled.

    Args:
        begin: gives drive, recording and starts.
        parameters: by which the velocity is predicted first, by key.
        first: that velocity, if it is known.
        widen: see :func:`at_model_velocity`.
    """
    problem, drive = begin.problem, begin.problem.drive
    # No row need be clear of uncertain motion: the noise of the momentum alone says how wide is wide enough.
    best, used, least = begin, None, np.inf
    values = np.array([parameters[key] for key in drive.keys])
    width = problem.test_functions.width
    if widen:
        inertia, _ = drive.split(parameters)
        width = max(width, least_width(problem.recording, inertia, FEWEST_WHERE_ALL_COUNT, NOISE_SHARE_WHERE_ALL_COUNT))
    for _ in range(MAX_ROUNDS):
        predicted, first = first, None
        if predicted is None:
            now = {**parameters, **dict(zip(drive.keys, values, strict=True))}
            predicted = model_velocity(drive, now, problem.recording, held=problem.held)
        if predicted is None or predicted.prediction_error > WORSE * least:
            break
        rows = problem.along(predicted.velocity, predicted.resting, width)
        if rows.rows <= 4 * len(drive.parameters):
            break
        least, used = min(least, predicted.prediction_error), predicted
        best = solve(rows, replace(begin.plan, start=best.again.start), timing=False)
        change, values = best.values - values, best.values
        if _is_final(used, problem.recording) or _is_little(change, best):
            return best, used, True
    return best, used, False


def _is_little(change: Array, found: Solved) -> bool:
    """Whether no parameter changed by more than a tenth of its standard error."""
    spread = deviations(found.covariance)
    return bool(np.all(np.abs(change) <= 0.1 * spread))


def _with_its_torque(found: Solved) -> tuple[Solved, tuple[Solved, ModelVelocity | None]]:
    """Return the fit, or that with a held torque if its rows and the velocity that it predicts both speak for it.

    Noise of 10 % in the velocity weakens every row; on the rows alone some torque was taken for held that was not. A
    velocity predicted with the torque at the wrong time is worse by far more than chance.
    """
    plain, held = _begin(found), fitted_as_held(found)
    if held is None:
        return found, plain
    other = _begin(held)
    recording = found.problem.recording
    return (held, other) if _risk_of(other[1], recording) <= _risk_of(plain[1], recording) else (found, plain)


def _begin(found: Solved) -> tuple[Solved, ModelVelocity | None]:
    """Return the fit to certain motion or to all, whichever predicts the velocity better, and how.

    Where noise hides at which instants the drive turns, little motion is certain.
    """
    own = _predicted(found)
    if own is not None and _is_final(own, found.problem.recording):
        return found, own
    everywhere = _everywhere(found)
    both = [(found, own), (everywhere, _predicted(everywhere))]
    return min(both, key=lambda each: np.inf if each[1] is None else each[1].prediction_error)


def _is_final(predicted: ModelVelocity, recording: Recording) -> bool:
    """Whether other parameters would hardly predict another velocity: it is the measured one, and that is not noisy."""
    return predicted.is_measured and predicted.margin >= _CLEARLY and not sign_is_hidden(recording)


def _everywhere(found: Solved) -> Solved:
    """Return the fit to all motion at the same velocity."""
    problem = found.problem
    return solve(problem.along(problem.smooth, problem.resting), found.plan, timing=False)


def _predicted(found: Solved) -> ModelVelocity | None:
    problem = found.problem
    return model_velocity(problem.drive, found.parameters, problem.recording, held=problem.held)


def _smoothed_noise(recording: Recording, half_width: int) -> float:
    """Return the covariance of the noise of a sample with that of its smoothed value."""
    return velocity_noise(recording).product(even_weights(half_width)[0], np.ones(1))


def _risk_of(predicted: ModelVelocity | None, recording: Recording) -> float:
    return np.inf if predicted is None else risk(recording.velocity, predicted.velocity, predicted.own_noise)
