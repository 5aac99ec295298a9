r"""The velocity that a model predicts, corrected by what was measured.

The simulated velocity has no noise but drifts from the drive where the model is wrong. Their difference is taken as a
level that wanders, observed in white noise; its fixed-interval smoother is a pair of exponential averages, one forth
and one back. The better the model, the longer the average that predicts best.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals import Noise, velocity_noise
from fricmodels.signals.lost_samples import as_held

FIRST_STEP, REACH, ROUNDS = 0.05, 10, 5
"""Of the search for values that predict the velocity: step, steps on either side at first, and how often halved."""
_GAINS = 0.5 ** np.arange(0, 12)
_REACH = 4096
"""Lags up to which a covariance is summed."""


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
        margin: least factor by which a run would be predicted worse with half the gain.
    """

    velocity: Array
    simulated: Array
    gains: tuple[float, ...]
    resting: Mask
    prediction_error: float
    own_noise: float
    margin: float

    @property
    def is_measured(self) -> bool:
        """Whether it is the measured velocity, in which the model has no part."""
        return set(self.gains) == {1.0}


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

    pushed = as_held(recording) if held else recording
    try:
        simulated = simulated_velocity(drive, values, pushed, between_samples="held" if held else "linear")
    except InputError:
        return None
    if not np.all(np.isfinite(simulated)):
        return None
    velocity = np.empty(len(recording))
    noise = np.empty(len(recording))
    squares = shared = 0.0
    own, gains, margin = velocity_noise(recording), [], np.inf
    for inside, count in _runs(recording):
        level, hidden_by, error, gain, more = wandering_level(recording.velocity[inside] - simulated[inside], own)
        velocity[inside] = recording.velocity[inside] if gain == 1.0 else simulated[inside] + level
        noise[inside] = hidden_by
        gains.append(gain)
        margin = min(margin, more)
        squares += error * count
        shared += _averaged_noise(own, gain) * count
    hidden = (np.abs(velocity) <= 3.0 * noise) & (np.abs(simulated) <= 3.0 * noise)
    velocity = np.where(hidden, simulated, velocity)
    errors = squares / len(recording), shared / len(recording)
    return ModelVelocity(velocity, simulated, tuple(gains), velocity == 0.0, *errors, margin)


def _runs(recording: Recording) -> list[tuple[slice | Mask, float]]:
    """Return the samples of each run, and how many there are."""
    if len(recording.run_numbers) == 1:
        return [(slice(None), float(len(recording)))]
    masks = [recording.run == number for number in recording.run_numbers]
    return [(mask, float(mask.sum())) for mask in masks]


def prediction_error(drive: Drive, values: Array, recording: Recording, *, held: bool) -> float:
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
    torque_held: bool,
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


def wandering_level(series: Array, noise: Noise) -> tuple[Array, float, float, float, float]:
    """Return the smoothed level of a series, the noise that hid it, the mean square error of prediction, and the gain.

    Last comes by what factor that error would be larger with half the gain; 1 where it did not choose the gain. The
    gain is the one that predicts best where the noise is white. Lasting noise predicts itself; there it is the one with
    the least risk, see :func:`.model_velocity.at_model_velocity`.

    Args:
        series: shape (N,).
        noise: of the series.
    """
    if noise.lasting:
        return _level_of_leastrisk(series, noise)
    gain, least, more = 1.0, np.inf, 1.0
    for candidate in _GAINS[_GAINS * len(series) >= 4.0]:
        square = float(np.mean((series[1:] - _average(series, candidate)[:-1]) ** 2))
        if square > least:
            more = square / least if least else np.inf
            break
        gain, least = float(candidate), square
    return both_ways(series, gain), float(np.sqrt(least * (1.0 - gain))), least, gain, more


def _level_of_leastrisk(series: Array, noise: Noise) -> tuple[Array, float, float, float, float]:
    best, least = (series, 1.0), np.inf
    for gain in _GAINS[_GAINS * len(series) >= 4.0].tolist():
        level = both_ways(series, gain)
        now = risk(series, level, _averaged_noise(noise, gain))
        if now > least:
            break
        best, least = (level, gain), now
    level, gain = best
    return level, noise.deviation, float(np.mean((series - level) ** 2)), gain, 1.0


def both_ways(series: Array, gain: float) -> Array:
    """Return the exponential average of a series forth and back."""
    if gain == 1.0:
        return series
    return _average(_average(series, gain)[::-1], gain)[::-1]


def _average(series: Array, gain: float) -> Array:
    """Return the exponential average, started at the mean of about as many samples as it spans."""
    from fricmodels.kernels.recursion import first_order

    first = float(np.mean(series[: max(1, round(1.0 / gain))]))
    averaged = np.empty(len(series))
    first_order(series, gain, 1.0 - gain, first, averaged)
    return averaged


def _averaged_noise(noise: Noise, gain: float) -> float:
    """Return the covariance of the noise of a sample with that of its average forth and back."""
    weight = gain / (2.0 - gain)
    if noise.is_white or gain == 1.0:
        return noise.deviation**2 * weight
    covariance = noise.covariance(min(_REACH, 1 + int(5.0 / gain)))
    faded = covariance * (1.0 - gain) ** np.arange(len(covariance))
    return weight * float(2.0 * faded.sum() - faded[0])


def risk(measured: Array, velocity: Array, own_noise: float) -> float:
    """Return Stein's estimate of the squared error of a velocity but for a constant, see :mod:`.model_velocity`.

    Args:
        measured, velocity: shape (N,).
        own_noise: covariance of the noise of a sample with that of its own value in the velocity.
    """
    with np.errstate(over="ignore"):  # a motion that runs away is infinitely far off
        return float(np.mean((velocity - measured) ** 2)) + 2 * own_noise
