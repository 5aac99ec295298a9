"""Whether the torque was recorded later than it acted, and whether that is known or only looks so."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.logcheck.balance import CLUSTERS, Balance, Cells
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.clusters import PROBABLE, significance, slope

_LEAST_LATE = 2.0
"""Samples: sampling and holding alone make about one."""
_AGREED = 0.05
"""Level at which a delay has to be above zero at every width that knows it better."""
_STEPS = 8
"""Newton steps to a delay; each is a tenth of the one before where the torque is late."""
_HALVINGS = 5
_NEAR = 0.05
"""Samples: below what a delay is rounded to in words."""
_LOOKS = 0.8
"""Share of the squared error that a delay may leave in any part of the record to be spoken of at all."""
_KNOWN = 0.2
"""The same, to be called one. A link on a spring that is driven up to its resonance leaves a quarter and more, found on
simulated drives; see docs/log_check.md."""
_ALONE = 0.93
"""Share of what a delay and the second change of the motion explain together that a delay has to explain alone. Noise
of the position takes some: it is in the motion's torque too."""

_SHARP = 0.8
"""Share of the inertia that shows without noise which has to show with it, for a width to tell of a delay. On 46 drives
with a late torque it is 0.89 and more; counts of 10 and 11 bits that made a delay out of nothing left 0.74 and less."""


def delay(log: Log, rows: list[Balance]) -> Iterator[Finding]:
    r"""Judge whether the torque was recorded later than it acted.

    .. math:: \tau(t) = m(t - T) \approx m - T\,\dot m

    where m is the balance fitted to uninterrupted sliding, away from reversals, where presliding, backlash and
    frictional lag look like a delay, with columns for |ω| and ω|ω| besides. T is the coefficient of the change of m
    after all columns of the balance are projected out, at the width at which it explains most; its error is over 32
    clusters. Asked further where T is longer than two samples at the level of
    :data:`~fricmodels.signals.clusters.PROBABLE`, and every width that knows T better says as well that it is above
    zero: a delay is the same at all widths, what else the balance leaves out is not.

    Noise and coarse counts blur the acceleration, so that the balance shows less inertia than there is. What is left
    of it then goes with the change of K_v ω, as if the torque were late. A width at which it shows less than four
    fifths of what it does with an acceleration that does not share the noise (:func:`_sharpness`) tells nothing.

    A spring behind the drive and a contact that bends are late as well, each at some frequencies or after reversals
    only. So the torque is shifted back, and what is then left decides (:func:`_undone`): a delay is spoken of where the
    error falls in both halves of the record, and where the speed rises as well as where it falls. It is called one
    where no more than a fifth is left in each of them, and a torque that also goes with the second change of m, as over
    a spring, explains hardly more. Otherwise it is spoken of only if it is the same at the widths that know it better
    (:func:`_differ`): friction that fades after each start is one sample late at one width, and forty at another. What
    then only looks like a delay, as much else does, is noted and not warned of. A motion that is recorded late is not
    told here from friction with memory; that is the effect ``sensor-delay``.
    """
    interval = log.recording.interval
    sharp = (row for row in rows if _sharpness(row) > _SHARP)
    found = [estimate for row in sharp if (estimate := _estimated(row)) is not None]
    if not found:
        return
    best = max(found, key=lambda estimate: estimate.share)
    surer = [estimate for estimate in found if estimate.error < best.error]
    agreed = all(estimate.chance_of_more_than(0.0) < _AGREED for estimate in surer)
    if not agreed or best.chance_of_more_than(_LEAST_LATE) >= PROBABLE:
        return
    shifted = [_undone(log.short, estimate) for estimate in found]
    undone = min(shifted, key=lambda undone: undone.left)
    if undone.samples < _LEAST_LATE or undone.most > _LOOKS:
        return
    size = f"{figures(1e3 * undone.samples * interval, 3)} ms ({undone.samples:.1f} samples) behind the motion"
    known = undone.most < _KNOWN and undone.alone > _ALONE
    if not known and any(_differ(undone, other) for other in shifted):
        return
    yield Finding(
        "torque-delay",
        Severity.WARN if known else Severity.NOTE,
        "torque",
        f"the {log.called('torque')} is {size}"
        if known
        else f"the {log.called('torque')} looks as if it were {size}, as over an elastic part too",
        "shift it, or see what the effect sensor-delay makes of it"
        if known
        else "do not shift it before fricmodels improve has told a delay from a spring or a contact that bends",
    )


@dataclass(frozen=True)
class _Rows:
    """What a balance leaves of uninterrupted sliding, and the changes of the motion's torque, beside its columns.

    Attributes:
        left, first, second: the rest, the first and the second change of m a sample, shape (rows,).
        cluster: of each row. faster: whether the speed rises.
    """

    left: Array
    first: Array
    second: Array
    cluster: Index
    faster: Mask

    @property
    def parts(self) -> list[Mask]:
        """Both halves of the record, and where the speed rises and falls."""
        early = 2 * self.cluster <= self.cluster.max()
        return [early, ~early, self.faster, ~self.faster]

    @property
    def late(self) -> float:
        """Delay [samples] that is still in the torque."""
        return -slope(self.left, self.first, self.cluster)[0]

    @property
    def square(self) -> float:
        """Sum of squares that is left."""
        return float(self.left @ self.left)


@dataclass(frozen=True)
class _Estimate:
    """A delay as the coefficient of the first change of m.

    Attributes:
        row, rows: the balance, and its rows of uninterrupted sliding.
        samples, error: the delay and its standard error. count: of clusters.
        share: of the rest that it explains.
    """

    row: Balance
    rows: _Rows
    samples: float
    error: float
    count: int
    share: float

    def chance_of_more_than(self, least: float) -> float:
        """Return the p value of a delay of no more than so many samples."""
        return significance(max(self.samples - least, 0.0) / self.error, self.count)


@dataclass(frozen=True)
class _Undone:
    """A delay, and what is left of the squared error once the torque is shifted back by it.

    Attributes:
        estimate: the delay to first order, whose error is that of this one.
        samples: the delay.
        left, most: of all, and in the part where most is left, as shares of what was there before.
        alone: share of what it and the second change of m explain together that it explains alone.
    """

    estimate: _Estimate
    samples: float
    left: float
    most: float
    alone: float


def _differ(one: _Undone, other: _Undone) -> bool:
    """Whether a delay is another one at a width that knows it better."""
    error, surer = one.estimate.error, other.estimate.error
    between = (one.samples - other.samples) / float(np.hypot(error, surer))
    return surer < error and significance(between, other.estimate.count) < PROBABLE


def _undone(log: Log, estimate: _Estimate) -> _Undone:
    """Return the delay with which least is left at the width of a balance, by Newton's steps, halved where needed."""
    row, before = estimate.row, estimate.rows
    cells = Cells.of(log, row.width)
    late, now = 0.0, before
    for _ in range(_STEPS):
        step = now.late
        for _ in range(_HALVINGS):
            there = _sliding(replace(row, target=cells.mean(_earlier(log, late + step))))
            if there is not None and there.square < now.square:
                late, now = late + step, there
                break
            step /= 2.0
        else:
            break
        if abs(step) < _NEAR:
            break
    shares = [_share(now.left[part], before.left[part]) for part in now.parts]
    changes = np.stack([now.first, now.second], axis=1)
    rest = now.left - changes @ np.linalg.lstsq(changes, now.left, rcond=1e-10)[0]
    left, both = _share(now.left, before.left), 1.0 - _share(rest, before.left)
    return _Undone(estimate, late, left, max(shares), (1.0 - left) / both if both > 0.0 else 0.0)


def _share(after: Array, before: Array) -> float:
    whole = float(before @ before)
    return float(after @ after) / whole if whole > 0.0 else 1.0


def _earlier(log: Log, samples: float) -> Array:
    """Return the torque that many samples earlier, by straight lines within each stretch, whose ends are held."""
    torque = log.recording.torque
    first = np.zeros(len(torque))
    last = np.zeros(len(torque))
    for part in log.parts:
        first[part], last[part] = part.start, part.stop - 1
    index = np.arange(len(torque), dtype=float)
    return np.interp(np.clip(index + samples, first, last), index, torque)


def _sharpness(row: Balance) -> float:
    r"""Return the inertia by least squares over that with the acceleration beside each row as its instrument.

    .. math:: \frac{a\cdot y / a\cdot a}{b\cdot y / b\cdot a}

    with the acceleration a of each row, b between the cells before and after it, and the torque y, all without what the
    other columns explain. It is 1 without noise in a, however fast the motion is, and falls to 0 where all is noise.
    """
    inertial = row.names.index("J")
    at = _slides(row) & np.isfinite(row.beside)
    if np.count_nonzero(at) < 4 * CLUSTERS:
        return 1.0
    others = np.delete(_wider(row), inertial, axis=1)[at]
    known = np.stack([row.columns[at, inertial], row.beside[at], row.target[at]], axis=1)
    a, b, y = (known - others @ np.linalg.lstsq(others, known, rcond=1e-10)[0]).T
    plain, true = float(a @ y) * float(b @ a), float(b @ y) * float(a @ a)
    return plain / true if true != 0.0 else 0.0


def _slides(row: Balance) -> Mask:
    """Return the rows under which the drive does not turn back."""
    return np.asarray(np.abs(row.columns[:, row.names.index("K_c")]) > 1.0 - 1e-9)


def _wider(row: Balance) -> Array:
    """Return the columns of a balance with two more, |ω| and ω|ω|, each of the size one."""
    velocity = row.columns[:, row.names.index("K_v")]
    columns = np.column_stack([row.columns, np.abs(velocity), np.abs(velocity) * velocity])
    scale = np.sqrt(np.mean(columns**2, axis=0))
    return np.asarray(columns / np.where(scale > 0, scale, 1.0))


def _sliding(row: Balance) -> _Rows | None:
    """Return the rows of uninterrupted sliding, or ``None`` where there are too few."""
    sliding = _slides(row)
    middle = np.zeros(len(row.start), dtype=bool)
    middle[1:-1] = (row.start[2:] - row.start[:-2] == 2 * row.width) & sliding[1:-1] & sliding[2:] & sliding[:-2]
    at = np.flatnonzero(middle)
    if len(at) < 4 * CLUSTERS:
        return None
    velocity = row.columns[:, row.names.index("K_v")]
    columns = _wider(row)
    fitted = columns @ np.linalg.lstsq(columns[sliding], row.target[sliding], rcond=1e-10)[0]
    first = (fitted[at + 1] - fitted[at - 1]) / (2 * row.width)
    second = (fitted[at + 1] - 2.0 * fitted[at] + fitted[at - 1]) / row.width**2
    beside = np.stack([row.target[at], first, second], axis=1)
    beside -= columns[at] @ np.linalg.lstsq(columns[at], beside, rcond=1e-10)[0]
    cluster = np.unique(row.cluster[at], return_inverse=True)[1]
    faster = velocity[at] * row.columns[at, row.names.index("J")] > 0.0
    return _Rows(beside[:, 0], beside[:, 1], beside[:, 2], cluster, faster)


def _estimated(row: Balance) -> _Estimate | None:
    """Return the delay that a balance shows, or ``None`` where there are too few rows."""
    rows = _sliding(row)
    if rows is None:
        return None
    value, error, count = slope(rows.left, rows.first, rows.cluster)
    return _Estimate(row, rows, -value, error, count, 1.0 - _share(rows.left - value * rows.first, rows.left))
