"""Whether a measured velocity has the scale of the position beside it, and by how much it has not."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.logcheck.balance import CLUSTERS, Cells
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.rates import in_same_unit
from fricmodels.logcheck.view import UNITS, Log
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.results.words import figures
from fricmodels.signals.clusters import certain, clusters
from fricmodels.signals.differences import is_difference

_WIDTHS, _APART = (1, 4, 16, 64, 256), 4
"""Samples of a cell, and cells between a row and its instruments."""
_LEAST_ROWS = 4 * CLUSTERS
_NUMBER = re.compile(r"-?\d+(\.\d*)?([eE][-+]?\d+)?(?=[ *a-zA-Zµ])")
_SAME = 0.005
"""Share up to which scales may differ: half of the hundredth that is looked for in the torque. A velocity that is k
times the rate of the position makes J and K_v 1/k of what they are; with a J that is given it leaves the share k - 1 of
J times the acceleration. Of 250 recordings with right velocities (31 of real machines, simulated drives with encoders
from 9 to 24 bits, filtered, late, with jitter) none is off by more than a five thousandth where the error is below it,
so that the limit is one of cost, not of what can be told."""
_FURTHEST = 1.25
"""Ratio up to which it is a scale. Beyond, the two channels are in other units or tell other motions: `rates` says."""


@dataclass(frozen=True)
class Scale:
    """How many times the rate of the position a measured velocity is.

    Attributes:
        value, error: the ratio and its standard error.
        clusters: parts of the record that the error is of.
    """

    value: float
    error: float
    clusters: int

    @property
    def is_another(self) -> bool:
        """Whether it certainly differs from 1, by more than a two hundredth and not by more than a quarter."""
        return 1.0 / _FURTHEST < self.value < _FURTHEST and certain(
            (abs(self.value - 1.0) - _SAME) / self.error, self.clusters
        )


@once
def velocity_scale(recording: Recording) -> Scale | None:
    r"""Return the scale k of the measured velocity v beside the measured position q, where there are both.

    .. math:: \dot q = \frac{1}{k}\left(v - v_0 + T_1\dot v + T_2\ddot v\right)

    Integrated over cells, so that stamps that wander change no side on average. The derivatives undo a low-pass filter
    of second order and, nearly, a delay: what a filter takes from fast motion is no scale. v_0 is an offset. The
    instruments are the same columns made of the position, four cells earlier and later, so that neither noise nor
    rounding of either channel shrinks the ratio. Error over 32 clusters. Of cells of 1 to 256 samples those with the
    least error. One sine alone does not tell T_2 from k: there the error is large.
    """
    log = Log(recording)
    if not {"position", "velocity"} <= set(log.measured):
        return None
    short = log.short
    area = short.area(short.recording.velocity)
    found = [scale for width in _WIDTHS if (scale := _at(short, width, area)) is not None]
    return min(found, key=lambda scale: scale.error, default=None)


def _at(log: Log, width: int, area: Array) -> Scale | None:
    if len(log.recording) < width * (_LEAST_ROWS + 2 * _APART + 3):
        return None
    cells = Cells.of(log, width)
    rows = np.flatnonzero(cells.inside(_APART + 1)) + _APART + 1
    if len(rows) < _LEAST_ROWS:
        return None
    rate, velocity = cells.slope(log.recording["position"]), cells.slope(area)
    length = np.diff(cells.time)[rows]
    moved, columns = length * rate[rows], length[:, None] * _derivatives(cells, velocity, rows)
    beside = _derivatives(cells, rate, rows - _APART) + _derivatives(cells, rate, rows + _APART)
    sizes, others = (np.sqrt(np.mean(x**2, axis=0)) for x in (columns, beside))
    if not (sizes.all() and others.all()):
        return None
    columns, beside = columns / sizes, beside / others
    try:
        inverse = np.linalg.inv(beside.T @ columns)
    except np.linalg.LinAlgError:
        return None
    solution = inverse @ (beside.T @ moved)
    scores = beside * (moved - columns @ solution)[:, None]
    group = clusters(cells.edges[rows], len(log.recording), CLUSTERS)
    count = int(group.max()) + 1
    sums = np.stack([np.bincount(group, score, count) for score in scores.T], axis=1)
    spread = float(np.linalg.norm(sums @ inverse[1])) * math.sqrt(count / max(count - 1, 1))
    if count < CLUSTERS // 2 or solution[1] == 0.0 or not spread > 0.0:
        return None
    value = float(sizes[1] / solution[1])
    return Scale(value, abs(value) * spread / abs(float(solution[1])), count)


def _derivatives(cells: Cells, mean: Array, at: Index) -> Array:
    """Return one, a rate, its first and its second derivative in some cells, shape (cells, 4)."""
    step = 0.25 * (cells.time[at + 2] - cells.time[at - 1] + cells.time[at + 1] - cells.time[at])
    first, second = mean[at + 1] - mean[at - 1], mean[at + 1] - 2.0 * mean[at] + mean[at - 1]
    return np.stack([np.ones(len(at)), mean[at], 0.5 * first / step, second / step**2], axis=1)


def _another(log: Log) -> Scale | None:
    """Return the scale of a velocity where it certainly is another one; a gear between the two is none."""
    found = velocity_scale(log.recording)
    return found if found is not None and found.is_another and in_same_unit(log) else None


def other_scale(recording: Recording) -> float:
    """Return by how much a measured velocity is to be divided so that it goes with the position; 1 where it does."""
    found = _another(Log(recording))
    return 1.0 if found is None else found.value


def scale(log: Log) -> Iterator[Finding]:
    """Say by how much the scales of velocity and position differ; see :func:`velocity_scale`.

    Nothing is said of a velocity that was computed from the positions: it is not used.
    """
    found = _another(log)
    if found is None or is_difference(log.recording):
        return
    digits = min(max(-math.floor(math.log10(found.error)), 2), 6)
    yield Finding(
        "velocity-scale",
        Severity.WARN,
        "velocity",
        f"the {log.called('velocity')} is {found.value:.{digits}f} ± {found.error:.{digits}f} times the "
        f"change of the {log.called('position')}: one of them has another scale, as by a gear, a calibration or a "
        "rounded unit; the position is taken, and the velocity divided by that",
        f"if the velocity is right give the position its scale, as in {_position_as(log, found.value)}",
    )


def _position_as(log: Log, scale: float) -> str:
    """Return the option that reads the position so many times larger."""
    unit = log.column("position")[1] or UNITS["position"].format(length=log.length_unit)
    number = _NUMBER.match(unit)
    times, rest = (float(number[0]), unit[number.end() :]) if number else (1.0, unit)
    return log.option("position", f"{figures(scale * times, 6)} {rest.strip()}")
