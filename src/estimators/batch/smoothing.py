r"""A velocity with less noise: what the model says the drive does, corrected by what was measured.

Noise in the velocity does harm twice: it gives the Coulomb torque the wrong sign near standstill, and it weakens every
regressor (errors in variables). The simulated velocity has neither fault but drifts from the drive where the model is
wrong. Their difference is taken as a level that wanders, observed in white noise; its fixed-interval smoother is a pair
of exponential averages, one forth and one back. The better the model, the longer the average that predicts best.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.recording import Recording

Array = NDArray[np.float64]

FIRST_STEP, REACH, ROUNDS = 0.05, 10, 5
"""Of the search for values that predict the velocity: step, steps on either side at first, and how often halved."""
_GAINS = 0.5 ** np.arange(0, 12)


def explained_velocity(
    drive: Drive, values: Mapping[str, float], recording: Recording
) -> tuple[Array, NDArray[np.bool_], float] | None:
    """Return the smoothed velocity, where the drive rests by it, and the mean square error of predicting the measured
    velocity by it one sample ahead; ``None`` where the model cannot be simulated.
    """
    from fricmodels.simulation import simulated_velocity

    try:
        simulated = simulated_velocity(drive, values, recording)
    except InputError:
        return None
    if not np.all(np.isfinite(simulated)):
        return None
    velocity = np.empty(len(recording))
    noise = np.empty(len(recording))
    squares = 0.0
    for number in np.unique(recording.run):
        inside = recording.run == number
        level, hidden_by, error = wandering_level(recording.velocity[inside] - simulated[inside])
        velocity[inside] = simulated[inside] + level
        noise[inside] = hidden_by
        squares += error * float(inside.sum())
    hidden = (np.abs(velocity) <= 3.0 * noise) & (np.abs(simulated) <= 3.0 * noise)
    velocity = np.where(hidden, simulated, velocity)
    return velocity, velocity == 0.0, squares / len(recording)


def prediction_error(drive: Drive, values: Array, recording: Recording) -> float:
    """Return the mean square error of predicting the velocity, see :func:`explained_velocity`; infinite without one."""
    explained = explained_velocity(drive, dict(zip(drive.keys, values, strict=True)), recording)
    return np.inf if explained is None else explained[2]


def sought(drive: Drive, starts: Sequence[Array], recording: Recording, held: Mapping[str, float]) -> Array:
    """Return values that predict the velocity better, each linear one that is not held stepped up and down.

    Begins at the best start, first half up and down in steps of a twentieth, then in ever smaller ones. Where the
    velocity drowns in noise, whether the drive turns, and for how long, says more of its Coulomb friction than the
    velocity does.
    """
    places = [i for i, p in enumerate(drive.parameters) if p.linear and p.key not in held]

    def error(trial: Array) -> float:
        return prediction_error(drive, trial, recording)

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


def wandering_level(series: Array) -> tuple[Array, float, float]:
    """Return the smoothed level of a series, the noise that hid it, and the mean square error of prediction.

    The gain is the one that predicts best.
    """
    gain, least = 1.0, np.inf
    for candidate in _GAINS[_GAINS * len(series) >= 4.0]:
        square = float(np.mean((series[1:] - _average(series, candidate)[:-1]) ** 2))
        if square > least:
            break
        gain, least = float(candidate), square
    level = _average(_average(series, gain)[::-1], gain)[::-1]
    return level, float(np.sqrt(least * (1.0 - gain))), least


def _average(series: Array, gain: float) -> Array:
    """Return the exponential average, started at the mean of about as many samples as it spans."""
    from scipy.signal import lfilter

    first = float(np.mean(series[: max(1, round(1.0 / gain))]))
    averaged, _ = lfilter([gain], [1.0, gain - 1.0], series, zi=[(1.0 - gain) * first])
    return np.asarray(averaged)
