r"""The velocity that the fitted model predicts, corrected by what was measured.

Noise in the velocity does harm twice: it gives the Coulomb torque the wrong sign near standstill, and it weakens every
regressor (errors in variables). The simulated velocity has neither fault but drifts from the drive where the model is
wrong. Their difference is taken as a level that wanders, observed in white noise; its fixed-interval smoother is a pair
of exponential averages, one forth and one back. The better the model, the longer the average that predicts best.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals import Noise, velocity_noise
from fricmodels.signals.lanczos import even_weights
from fricmodels.weakform.feedback import feedback
from fricmodels.weakform.hidden import drowned, sign_is_hidden
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.row_noise import FEWEST_WHERE_ALL_COUNT, NOISE_SHARE_WHERE_ALL_COUNT, bump_width
from fricmodels.weakform.solve import STRONG, Solved, as_held, solve
from fricmodels.weakform.tangent import tangents

Array = NDArray[np.float64]

FIRST_STEP, REACH, ROUNDS = 0.05, 10, 5
"""Of the search for values that predict the velocity: step, steps on either side at first, and how often halved."""
_GAINS = 0.5 ** np.arange(0, 12)
MAX_ROUNDS = 8
"""Rounds of predicting the velocity by the fit and fitting again."""
_REACH = 4096
"""Lags up to which a covariance is summed."""
_CONTRADICTED = 2.0
"""A fit that leaves so many times the sum of squares of the rows at the smoothed velocity is contradicted by them. One
that is right, where noise makes the fit to these rows wrong by ten standard errors, leaves less than that of 100 rows.
"""
_UNLIKELY = 0.01
"""Probability below which rows contradict a fit. The one that then stays is less certain, but as true."""
WORSE = 1.1
"""A round whose squared error of prediction is larger than the best by this factor has gone astray."""


@dataclass(frozen=True)
class ModelVelocity:
    """A velocity from model and measurement.

    Attributes:
        velocity: shape (N,).
        simulated: what the model alone predicts, shape (N,).
        gains: of the average that corrects it, in each run.
        resting: where the drive rests by it, shape (N,).
        prediction_error: mean square error of predicting the measured velocity one sample ahead.
        own_noise: mean covariance of the noise of each measured sample with that of its own value.
    """

    velocity: Array
    simulated: Array
    gains: tuple[float, ...]
    resting: NDArray[np.bool_]
    prediction_error: float
    own_noise: float


def at_model_velocity(found: Solved, *, widen: bool = True) -> Solved:
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
    smooth = _risk(recording.velocity, problem.smooth, _smoothed_noise(recording, problem.half_width))
    at_smooth = found
    found, (begin, everywhere, first) = _with_its_torque(found)
    best, predicted, settled = _rounds(begin, begin.parameters, first, widen=widen)
    lost = not settled or len(best.solution.normal.null.T) > 0 or _risk_of(predicted, recording) > smooth
    if lost and sign_is_hidden(recording):
        # Whether the drive turns at all, and for how long, says more of its Coulomb friction than its speed does.
        shares = drowned(problem.drive, recording, everywhere.parameters)
        held = {max(shares, key=lambda key: shares[key]): 0.0} if max(shares.values(), default=0.0) > 0.0 else {}
        without = solve(everywhere.problem, replace(everywhere.plan, held=held), timing=False)
        starts = [without.values, everywhere.values, found.values]
        values = sought(problem.drive, starts, recording, held, torque_held=found.problem.held)
        from_search = {**begin.parameters, **dict(zip(problem.drive.keys, values, strict=True))}
        other, velocity, _ = _rounds(without, from_search, widen=widen)
        if velocity and (predicted is None or velocity.prediction_error < predicted.prediction_error):
            best, predicted = solve(other.problem, found.plan, timing=False), velocity
    # Simulated with the torque at another time the velocity would be another, and what it is now hides the shift.
    if max(found.log_odds_of_a_shift(reversals=False), best.with_shift.log_odds_of_a_shift()) > STRONG:
        return at_smooth
    more = _left_by(best.values, found) / found.solution.cost - 1.0
    if more > _CONTRADICTED - 1.0 or (found is not at_smooth and _is_contradicted(more, found)):
        return at_smooth  # what the rows at the measured velocity contradict is not more certain than they are
    if predicted is None or _risk_of(predicted, recording) > smooth:
        return at_smooth

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
    if set(predicted.gains) == {1.0}:  # it is the measured velocity itself
        return np.zeros((len(found.values), len(recording)))
    of_model = tangents(found.problem.drive, found.parameters, recording, predicted.simulated)
    changes = of_model.copy()
    for number, gain in zip(recording.run_numbers, predicted.gains, strict=True):
        inside = np.flatnonzero(recording.run == number)
        for change in changes:
            change[inside] -= _both_ways(change[inside], gain)
    changes = np.where(predicted.velocity == predicted.simulated, of_model, changes)
    return np.where(predicted.resting, 0.0, changes)


def _is_contradicted(more: float, found: Solved) -> bool:
    """Whether so much more is left of the rows, as a share, than chance explains (F test).

    Rows that are certain enough to tell a held torque are certain enough for that, too.
    """
    from scipy.special import fdtrc

    count = len(found.values)
    free = found.problem.independent - count
    return free > 0.0 and bool(fdtrc(count, free, max(more, 0.0) * free / count) < _UNLIKELY)


def _left_by(values: Array, found: Solved) -> float:
    """Return the sum of squares that other parameters leave of the rows of a fit, with the best nuisances."""
    held = dict(zip(found.problem.drive.keys, values.tolist(), strict=True))
    return solve(found.problem, Plan(held=held), timing=found.timing).solution.cost


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
    width = problem.bumps.width
    if widen:
        inertia, _ = drive.split(parameters)
        width = max(width, bump_width(problem.recording, inertia, FEWEST_WHERE_ALL_COUNT, NOISE_SHARE_WHERE_ALL_COUNT))
    for _ in range(MAX_ROUNDS):
        before, (predicted, first) = used, (first, None)
        if predicted is None:
            now = {**parameters, **dict(zip(drive.keys, values, strict=True))}
            predicted = model_velocity(drive, now, problem.recording, held=problem.held)
        if predicted is None or predicted.prediction_error > WORSE * least:
            break
        if before is not None and np.array_equal(predicted.velocity, before.velocity):
            return best, predicted, True  # as where it is the measured one, whatever the model
        rows = problem.along(predicted.velocity, predicted.resting, width)
        if rows.rows <= 4 * len(drive.parameters):
            break
        least, used = min(least, predicted.prediction_error), predicted
        best = solve(rows, replace(begin.plan, start=_nonlinear(best)), timing=False)
        change, values = best.values - values, best.values
        spread = np.sqrt(np.clip(np.diag(best.covariance), 0.0, None))
        if np.all(np.abs(change) <= 0.1 * spread):
            return best, used, True
    return best, used, False


def _with_its_torque(found: Solved) -> tuple[Solved, tuple[Solved, Solved, ModelVelocity | None]]:
    """Return the fit, or that with a held torque if its rows and the velocity that it predicts both speak for it.

    Noise of 10 % in the velocity weakens every row; on the rows alone some torque was taken for held that was not. A
    velocity predicted with the torque at the wrong time is worse by far more than chance.
    """
    plain, held = _begin(found), as_held(found)
    if held is None:
        return found, plain
    other = _begin(held)
    recording = found.problem.recording
    return (held, other) if _risk_of(other[2], recording) <= _risk_of(plain[2], recording) else (found, plain)


def _begin(found: Solved) -> tuple[Solved, Solved, ModelVelocity | None]:
    """Return the fit to certain motion or to all, whichever predicts the velocity better; the one to all; and how.

    Where noise hides at which instants the drive turns, little motion is certain.
    """
    problem = found.problem
    everywhere = solve(problem.along(problem.smooth, problem.resting), found.plan, timing=False)

    def predicted(fit: Solved) -> ModelVelocity | None:
        return model_velocity(problem.drive, fit.parameters, problem.recording, held=problem.held)

    both = [(fit, predicted(fit)) for fit in (found, everywhere)]
    best, velocity = min(both, key=lambda each: np.inf if each[1] is None else each[1].prediction_error)
    return best, everywhere, velocity


def _nonlinear(found: Solved) -> dict[str, float]:
    nonlinear = {p.key for p in found.problem.drive.parameters if not p.linear}
    return {key: value for key, value in found.parameters.items() if key in nonlinear}


def _smoothed_noise(recording: Recording, half_width: int) -> float:
    """Return the covariance of the noise of a sample with that of its smoothed value."""
    return velocity_noise(recording).product(even_weights(half_width)[0], np.ones(1))


def _averaged_noise(noise: Noise, gain: float) -> float:
    """Return the covariance of the noise of a sample with that of its average forth and back."""
    weight = gain / (2.0 - gain)
    if noise.is_white or gain == 1.0:
        return noise.deviation**2 * weight
    covariance = noise.covariance(min(_REACH, 1 + int(5.0 / gain)))
    faded = covariance * (1.0 - gain) ** np.arange(len(covariance))
    return weight * float(2.0 * faded.sum() - faded[0])


def _risk(measured: Array, velocity: Array, own_noise: float) -> float:
    with np.errstate(over="ignore"):  # a motion that runs away is infinitely far off
        return float(np.mean((velocity - measured) ** 2)) + 2 * own_noise


def _risk_of(predicted: ModelVelocity | None, recording: Recording) -> float:
    return np.inf if predicted is None else _risk(recording.velocity, predicted.velocity, predicted.own_noise)


def model_velocity(
    drive: Drive, values: Mapping[str, float], recording: Recording, *, held: bool = False
) -> ModelVelocity | None:
    """Return the velocity that a model predicts, corrected; ``None`` where the model cannot be simulated.

    Args:
        drive, values: the model, and its parameters by key.
        recording: with the torque, and the velocity that corrects it.
        held: whether the torque keeps each sample's value until the next.
    """
    from fricmodels.simulation import simulated_velocity

    try:
        simulated = simulated_velocity(drive, values, recording, between_samples="held" if held else "linear")
    except InputError:
        return None
    if not np.all(np.isfinite(simulated)):
        return None
    velocity = np.empty(len(recording))
    noise = np.empty(len(recording))
    squares = shared = 0.0
    own, gains = velocity_noise(recording), []
    for number in recording.run_numbers:
        inside = recording.run == number
        level, hidden_by, error, gain = wandering_level(recording.velocity[inside] - simulated[inside], own)
        velocity[inside] = recording.velocity[inside] if gain == 1.0 else simulated[inside] + level
        noise[inside] = hidden_by
        gains.append(gain)
        squares += error * float(inside.sum())
        shared += _averaged_noise(own, gain) * float(inside.sum())
    hidden = (np.abs(velocity) <= 3.0 * noise) & (np.abs(simulated) <= 3.0 * noise)
    velocity = np.where(hidden, simulated, velocity)
    errors = squares / len(recording), shared / len(recording)
    return ModelVelocity(velocity, simulated, tuple(gains), velocity == 0.0, *errors)


def prediction_error(drive: Drive, values: Array, recording: Recording, *, held: bool = False) -> float:
    """Return the mean square error of predicting the velocity one sample ahead; infinite where there is no model."""
    given = {drive.inertia_key: drive.inertia or float("nan")}
    predicted = model_velocity(drive, {**given, **dict(zip(drive.keys, values, strict=True))}, recording, held=held)
    return np.inf if predicted is None else predicted.prediction_error


def sought(
    drive: Drive,
    starts: Sequence[Array],
    recording: Recording,
    held: Mapping[str, float],
    *,
    torque_held: bool = False,
) -> Array:
    """Return values that predict the velocity better, each linear one that is not held stepped up and down.

    Begins at the best start, first half up and down in steps of a twentieth, then in ever smaller ones. Where the
    velocity drowns in noise, whether the drive turns, and for how long, says more of its Coulomb friction than the
    velocity does.
    """
    places = [i for i, p in enumerate(drive.parameters) if p.linear and p.key not in held]

    def error(trial: Array) -> float:
        return prediction_error(drive, trial, recording, held=torque_held)

    fixed = [np.array([held.get(k, v) for k, v in zip(drive.keys, values, strict=True)]) for values in starts]
    least, _, best = min((error(values), i, values) for i, values in enumerate(fixed))
    for round_number in range(ROUNDS):
        step = FIRST_STEP * 0.5**round_number
        multiples = np.arange(-REACH, REACH + 1) if round_number == 0 else np.array([-1, 1])
        for i in places:
            better = best
            for factor in 1.0 + step * multiples:
                trial = np.where(np.arange(len(best)) == i, factor * best, best)
                reached = error(trial)
                if reached < least:
                    better, least = trial, reached
            best = better
    return best


def wandering_level(series: Array, noise: Noise) -> tuple[Array, float, float, float]:
    """Return the smoothed level of a series, the noise that hid it, the mean square error of prediction, and the gain.

    The gain is the one that predicts best where the noise is white. Lasting noise predicts itself; there it is the one
    with the least risk, see :func:`at_model_velocity`.

    Args:
        series: shape (N,).
        noise: of the series.
    """
    if noise.lasting:
        return _level_of_least_risk(series, noise)
    gain, least = 1.0, np.inf
    for candidate in _GAINS[_GAINS * len(series) >= 4.0]:
        square = float(np.mean((series[1:] - _average(series, candidate)[:-1]) ** 2))
        if square > least:
            break
        gain, least = float(candidate), square
    return _both_ways(series, gain), float(np.sqrt(least * (1.0 - gain))), least, gain


def _level_of_least_risk(series: Array, noise: Noise) -> tuple[Array, float, float, float]:
    best, least = (series, 1.0), np.inf
    for gain in _GAINS[_GAINS * len(series) >= 4.0].tolist():
        level = _both_ways(series, gain)
        risk = _risk(series, level, _averaged_noise(noise, gain))
        if risk > least:
            break
        best, least = (level, gain), risk
    level, gain = best
    return level, noise.deviation, float(np.mean((series - level) ** 2)), gain


def _both_ways(series: Array, gain: float) -> Array:
    return _average(_average(series, gain)[::-1], gain)[::-1]


def _average(series: Array, gain: float) -> Array:
    """Return the exponential average, started at the mean of about as many samples as it spans."""
    from fricmodels.kernels.recursion import first_order

    first = float(np.mean(series[: max(1, round(1.0 / gain))]))
    averaged = np.empty(len(series))
    first_order(series, gain, 1.0 - gain, first, averaged)
    return averaged
