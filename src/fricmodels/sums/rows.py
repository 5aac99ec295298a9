"""The rows of one stretch of samples, block by block: the same whatever the blocks are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np

from fricmodels.arrays import Array, Index, Mask, widened
from fricmodels.recording import Recording
from fricmodels.signals.creeping import creeping_stretches, held_while_creeping
from fricmodels.signals.lanczos import fit_stretch
from fricmodels.sums.plan import Plan
from fricmodels.weakform.kinks import with_kinks
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.test_functions import HOPS, TestFunctions, mean_velocity
from fricmodels.weakform.unclear import hidden_turns

Rows: TypeAlias = tuple[Array, Index]
"""Rows, shape (columns, rows), and the sample at which each begins."""

_BLOCK = 1 << 16
"""Samples whose rows are made together: enough that margins cost little, few enough for the processor's cache."""
_REACH = 4
"""Samples beside a cell that its integral looks at."""


@dataclass
class Stretch:
    """Takes the samples of one stretch without a gap as they come, and gives its rows.

    Attributes:
        plan: what the rows are.
        first: number of the first sample in the file.
    """

    plan: Plan
    first: int
    _waiting: list[Mapping[str, Array]] = field(default_factory=list)
    _held: int = 0
    _begin: int = 0
    """Sample of the stretch at which what is held begins."""
    _done: int = 0
    """Sample of the stretch at which the next test function begins."""

    @cached_property
    def _size(self) -> int:
        return max(1, round(_BLOCK / self.plan.hop)) * self.plan.hop

    @cached_property
    def _margin(self) -> int:
        """Samples beside a block that its rows depend on, a multiple of the way between test functions."""
        plan = self.plan
        smoothed = plan.half_width + plan.derived_over  # a kink reaches as far, and is found in what is smoothed
        needed = 2 * smoothed + plan.derived_over + lasting(plan) + _REACH
        return -(-needed // plan.hop) * plan.hop

    def take(self, channels: Mapping[str, Array]) -> Iterator[Rows]:
        """Take further samples; yield the rows that they complete, see :meth:`rest`."""
        self._waiting.append(channels)
        self._held += len(channels["time"])
        while self._begin + self._held >= self._done + self._size + self.plan.width + self._margin:
            yield from self._block(self._done + self._size, last=False)

    def rest(self) -> Iterator[Rows]:
        """Yield the rows of what is left at the end of the stretch.

        Yields:
            Rows, shape (columns, rows), and the sample of the file at which each begins.
        """
        if self._begin + self._held - self._done >= self.plan.width:
            yield from self._block(self._begin + self._held, last=True)

    def _block(self, until: int, *, last: bool) -> Iterator[Rows]:
        held = {name: np.concatenate([part[name] for part in self._waiting]) for name in self._waiting[0]}
        stop = len(held["time"]) if last else until + self.plan.width + self._margin - self._begin
        part = {name: values[:stop] for name, values in held.items()}
        rows, begins = block_rows(self.plan, part, self._done - self._begin, until - self._begin)
        yield rows, begins + (self.first + self._begin)
        kept = max(until - self._margin - self._begin, 0)
        self._waiting = [{name: values[kept:] for name, values in held.items()}]
        self._held -= kept
        self._begin += kept
        self._done = until


def lasting(plan: Plan) -> int:
    """Return how many slow samples in a row are no reversal any more: an eighth of a test function."""
    return max(2, plan.width // HOPS)


def block_rows(plan: Plan, channels: Mapping[str, Array], first: int, until: int) -> Rows:
    r"""Return the rows of the test functions that begin within some samples of a stretch without a gap.

    Args:
        plan: what the rows are.
        channels: of the samples, and of a margin beside them, shape (N,) each.
        first, until: test functions that begin from sample ``first`` on, and before ``until``.

    Returns:
        Shape (columns, rows): :math:`\int\varphi(\tau_m-\tau_L)\,dt` less what no parameter multiplies,
        :math:`\int\varphi\,d\omega`, the integrals of what the model's parameters multiply, and what a shift of
        reversals and of time would add; and the sample at which each row's test function begins.
    """
    recording, smooth = _moving(plan, channels)
    limits, slow = plan.drive.sticking_interval(recording, plan.friction), _slow(plan, smooth)
    inertia, _ = plan.drive.split(plan.friction)
    creeps = creeping_stretches(recording, smooth, slow, plan.creep)
    held = held_while_creeping(recording, smooth, creeps, inertia, lambda: limits)
    smooth = with_kinks(recording, smooth, plan.half_width, slow, limits, inertia, plan.kinks)
    unclear = widened(slow | held | hidden_turns(recording, smooth, plan.error, limits), 1 + recording.derived_over)
    quadrature = Quadrature.of(recording, smooth, unclear, plan.jump)
    index = np.arange(len(recording))
    elsewhere = (index < first) | (index >= until + plan.width - plan.hop)
    over_cells = plan.derived_over > 0
    test_functions = TestFunctions(recording, plan.width, unclear | elsewhere, least_moving=1.0, over_cells=over_cells)
    points = _as_planned(quadrature.recording, plan)
    design, offset = plan.drive.regressors(points)
    push = test_functions.driving(quadrature, points.driving_torque)
    integrals = test_functions.torques(quadrature, np.vstack([offset[None], design]))
    velocity = mean_velocity(recording, recording["position"]) if over_cells else recording.velocity
    turns = quadrature.turns * plan.interval
    rate = quadrature.change_while_moving(recording.torque)
    further = [test_functions.of_cells(turns[None])[0], test_functions.of_cells(rate[None])[0]]
    rows = np.vstack([push - integrals[0], test_functions.momentum(velocity), integrals[1:], further])
    return rows, test_functions.begins


def _moving(plan: Plan, channels: Mapping[str, Array]) -> tuple[Recording, Array]:
    """Return samples as a recording with a velocity, and the smoothed velocity."""
    time, found = channels["time"], dict(channels)
    if plan.derived_over:
        found["velocity"] = fit_stretch(time, channels["position"], plan.derived_over)[1]
    smooth, _ = fit_stretch(time, found["velocity"], plan.half_width)
    smooth[np.abs(smooth) <= plan.standstill] = 0.0
    run = np.zeros(len(time), dtype=np.int64)
    recording = Recording("samples", plan.motion, found, run, derived_over=plan.derived_over)
    return _as_planned(recording, plan), smooth


def _as_planned(recording: Recording, plan: Plan) -> Recording:
    """Return a recording whose interval and largest speed are the plan's, and not those of a block."""
    vars(recording).update(interval=plan.interval, peak_speed=plan.peak)  # both are computed once and remembered
    return recording


def _slow(plan: Plan, smooth: Array) -> Mask:
    """Mark where the drive creeps, or rests; see :func:`fricmodels.weakform.unclear.creeping`."""
    slow = np.abs(smooth) <= plan.slow
    found = np.zeros(len(smooth), dtype=bool)
    if slow.any():
        edges = np.flatnonzero(np.diff(np.r_[False, slow, False].astype(np.int8)))
        length = edges[1::2] - edges[::2]
        for begin, end in zip(edges[::2][length > lasting(plan)], edges[1::2][length > lasting(plan)], strict=True):
            found[begin:end] = True
    return found
