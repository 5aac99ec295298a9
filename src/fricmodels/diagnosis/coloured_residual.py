r"""What is left of a model as noise with a colour, where nothing but its own past predicts it.

Noise of the torque, or a disturbance that was not recorded, is in no channel. If it is stationary and forgets itself
soon, nothing can be added to the model for it, and nothing has to be: it is named with its size and how long it lasts.
It is taken as first-order autoregressive noise of the torque,

.. math:: r(t) = \sigma^2 e^{-|t|/T},

seen through the test functions, beside the noise of the velocity. It is not noise where it lasts so long that the
record hardly shows it end, where it rings or comes back with the motion, or where its size goes with time, speed, place
or load: then something acts that is not known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.candidate_tests import CandidateTests
from fricmodels.dimension import FORCE, Motion
from fricmodels.results.words import figures
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression

_LAGS = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
"""Lags at which the autocovariance is fitted, in widths of a test function."""
_SHORTEST, _MANY = 0.1, 20.0
"""Least T, in widths of a test function, and how many T a record must last at least."""
_NOT_EXPLAINED = 0.1
"""Mean square by which autocorrelations may miss those of the noise at most, beside their own error."""


@dataclass(frozen=True)
class ColouredNoise:
    """Autoregressive noise of the torque.

    Attributes:
        deviation: σ [N m or N].
        lasts: T [s].
        percent: σ, of the RMS motor torque.
        motion: rotary or linear.
    """

    deviation: float
    lasts: float
    percent: float
    motion: Motion

    def __str__(self) -> str:
        unit = FORCE.unit(self.motion)
        return (
            f"coloured noise of the torque: standard deviation {figures(self.deviation)} {unit} "
            f"({figures(self.percent)} % of the RMS motor torque), correlation time {figures(1000 * self.lasts)} ms"
        )


def coloured_residual(result: CandidateTests) -> ColouredNoise | None:
    """Return what is left as noise with a colour, or ``None`` where it is not stationary, or no such noise."""
    problem, residual = result.problem, result.regression.residual
    if not _is_stationary(result):
        return None
    width, hop, recording = problem.test_functions.width, problem.test_functions.hop, problem.recording
    inertia, _ = problem.drive.split(result.parameters)
    lags = np.unique(np.rint(np.array(_LAGS) * width / hop).astype(int)) * hop
    found = [_autocovariance(problem, residual, int(lag)) for lag in lags]
    known = [_autocovariance(problem, inertia * problem.noise_of_momentum, int(lag))[0] for lag in lags]
    measured, count = np.array([value for value, _ in found]), np.array([number for _, number in found])
    lags, measured, left = (each[count > 0] for each in (lags, measured, measured - np.array(known)))
    longest = len(recording) / _MANY
    if measured[0] <= 0.0 or longest <= _SHORTEST * width:
        return None
    best: tuple[float, float, float, Array] | None = None
    for samples in np.geomspace(_SHORTEST * width, longest, 48):
        shape = np.array(list(_through_test_functions(problem, float(samples), lags)))
        square = max(float(shape @ left) / float(shape @ shape), 0.0)
        miss = float(np.sum((left - square * shape) ** 2))
        if best is None or miss < best[0]:
            best = (miss, float(samples), square, shape)
    assert best is not None
    miss, samples, square, _ = best
    # An autocorrelation of n correlated values, 2T to each independent one, is uncertain by √(2T/n).
    own_error = 2.0 * max(samples, width / 2.0) / len(recording)
    at_end = samples > 0.95 * longest
    if at_end or square == 0.0 or miss / measured[0] ** 2 / len(lags) > max(_NOT_EXPLAINED**2, 4.0 * own_error):
        return None
    size = recording.rms_torque
    deviation = float(np.sqrt(square))
    return ColouredNoise(deviation, samples * recording.interval, 100.0 * deviation / size, recording.motion)


def _autocovariance(problem: WeakFormProblem, series: Array, lag: int) -> tuple[float, int]:
    """Return the mean product of rows so many samples apart, and how many pairs there are."""
    centre, hop = problem.centre, problem.test_functions.hop
    at = np.minimum(np.searchsorted(centre, centre - lag), len(centre) - 1)
    run = problem.recording.run[np.clip(centre, 0, len(problem.recording) - 1)]
    there = (np.abs(centre[at] - (centre - lag)) <= hop // 2) & (run[at] == run)
    count = int(np.count_nonzero(there))
    return (float(series[there] @ series[at[there]]) / count if count else 0.0), count


def _through_test_functions(problem: WeakFormProblem, samples: float, lags: Array) -> Iterator[float]:
    """Yield the autocovariance of rows of unit noise that lasts so many samples, at lags in samples."""
    weights = problem.test_functions.weights * problem.recording.interval
    own = np.correlate(weights, weights, "full")
    apart = np.arange(-len(weights) + 1, len(weights))
    for lag in lags:
        yield float(own @ np.exp(-np.abs(lag + apart) / samples))


def _is_stationary(result: CandidateTests) -> bool:
    """Whether the size of what is left goes with nothing that was recorded: its square, tested by regression."""
    problem, square = result.problem, result.regression.residual**2
    points, centre = problem.recording, np.clip(result.problem.centre, 0, len(result.problem.recording) - 1)
    time, speed = points.time[centre], np.abs(problem.smooth[centre])
    phase = np.pi * (time - time.min()) / (float(np.ptp(time)) or 1.0)
    groups = [np.cos(np.arange(1, 4)[:, None] * phase), np.vstack([speed, speed**2])]
    for name in ("position", "load_torque"):
        if name in points:
            values = points[name][centre]
            turn = np.pi * (values - values.min()) / (float(np.ptp(values)) or 1.0)
            groups.append(np.cos(np.arange(1, 4)[:, None] * turn))
    flat = Regression(np.ones((1, len(square))), square, problem.independent)
    for columns in groups:
        seen = flat.visible(columns)
        if np.any(seen) and flat.test(columns[seen]).p_value * len(groups) < result.policy.significance:
            return False
    return True
