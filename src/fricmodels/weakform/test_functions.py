r"""The equation of motion in weak form: multiplied by bumps that vanish at their ends, and integrated.

.. math:: \int \varphi\,(\tau_m - \tau_L - \tau_F)\,dt
          = J \int \varphi\,\dot\omega\,dt = -J \int \dot\varphi\,\omega\,dt

The derivative stands on the bump, which is known, and not on the velocity, which is measured: nothing smears the
Coulomb step at a reversal, and nothing amplifies noise. Torques are integrated along cubics through four samples; where
the velocity changes its sign between two samples, along straight lines, split at the instant of the crossing, where the
motor torque may jump. A resting
drive fulfils the equation whatever its friction is, so samples at rest contribute to neither side.

The test function is what makes the change of velocity exact. If the velocity is measured it is constant within a cell:
the change from one sample to the next is the integral of the acceleration over the cell. If only positions are, it is a
straight line within a cell: the change between the mean velocities of two neighbouring cells is the integral of the
acceleration under a hat over both, and hats add up to straight lines. By the trapezium rule instead, a torque of phase
θ per sample would be too small by θ²/12 and θ²/6, which at 100 Hz is more than noise.
"""

from __future__ import annotations

import itertools
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fricmodels.recording import Recording
from fricmodels.signals.rest import once
from fricmodels.weakform.jumps import jumps_at_reversals

Array = NDArray[np.float64]

HOPS = 8
"""Neighbouring bumps are an eighth of a bump apart: finer ones say nothing new."""


def segments(recording: Recording) -> list[slice]:
    """Return the stretches without a gap: within a run, no step longer than three median ones."""
    return _stretches_of(recording)[0]


@once
def _stretches_of(recording: Recording) -> tuple[list[slice], Array, NDArray[np.bool_]]:
    """Return the stretches, the duration of each cell, 0 between them, and which cells lie within one."""
    step = np.diff(recording.time)
    broken = (np.diff(recording.run) != 0) | (step > 3.0 * recording.interval)
    edges = [0, *(np.flatnonzero(broken) + 1), len(recording)]
    found = [slice(start, stop) for start, stop in itertools.pairwise(edges)]
    joined = np.zeros(len(step), dtype=bool)
    for piece in found:
        joined[piece.start : piece.stop - 1] = True
    return found, np.where(joined, step, 0.0), joined


@dataclass(frozen=True)
class Quadrature:
    """Where a torque is evaluated to be integrated: at the samples, and where the drive stops, starts or turns between.

    A cell lies between two neighbouring samples. Where the drive turns, stops or starts within a cell, only the parts
    of it before and after the standstill count; they are found by continuing the velocity of the neighbouring cells
    to zero, because its slope jumps there by twice the Coulomb friction.

    Attributes:
        recording: the recorded samples, then for each split cell the instant of stopping, then that of starting.
        cell: index of the sample before each split cell.
        before, after: half the duration of the moving part before and after the zero.
        half_step: half the duration of each split cell.
        half: half the duration of each cell that is not split, 0 for the others, shape (N − 1,).
        jump: by how much [N m or N] the motor torque jumps with the sign of the velocity; see :mod:`.jumps`.
    """

    recording: Recording
    cell: NDArray[np.int64]
    before: Array
    after: Array
    half_step: Array
    half: Array
    jump: float

    @classmethod
    def of(
        cls, recording: Recording, velocity: Array, resting: NDArray[np.bool_], jump: float | None = None
    ) -> Quadrature:
        """Prepare the integrals over a recording with the velocity that the friction torque is to be evaluated at.

        Args:
            recording: as it is integrated.
            velocity: at its samples, shape (N,).
            resting: samples of no use, shape (N,).
            jump: of the motor torque; as its reversals show it if not given.
        """
        from fricmodels.weakform.split import split_cells

        _, step, joined = _stretches_of(recording)
        moving, half, cell = ~resting, np.empty(len(step)), np.empty(len(step), dtype=np.int64)
        cell = cell[: split_cells(step, joined, velocity, resting, half, cell)].copy()
        earlier, later = velocity[cell], velocity[cell + 1]
        end = len(recording) - 1
        previous, following = np.maximum([cell - 1, cell - 2], 0), np.minimum([cell + 2, cell + 3], end)
        before = np.where(moving[cell], _share_to_zero(earlier, *velocity[previous]), 0.0)
        after = np.where(moving[cell + 1], _share_to_zero(later, *velocity[following]), 0.0)
        both_parts = np.maximum(before + after, 1.0)
        before, after = before / both_parts, after / both_parts
        tiny = 1e-9 * float(np.max(np.abs(velocity), initial=1e-300))
        channels = {}
        for name, values in recording.channels.items():
            if name == "velocity":
                parts = [velocity, tiny * np.sign(earlier), tiny * np.sign(later)]
            else:
                first, last, change = values[cell], values[cell + 1], values[cell + 1] - values[cell]
                if name == "torque":
                    sides = np.sign(later) - np.sign(earlier)
                    jumps, jump = jumps_at_reversals(values, cell, before, after, half, sides, jump)
                    change = change - jumps
                parts = [values, first + before * change, last - after * change]
            channels[name] = np.concatenate(parts)
        run = np.concatenate([recording.run, recording.run[cell], recording.run[cell]])
        half_step = 0.5 * step[cell]
        at = replace(recording, channels=channels, run=run, origin=None)
        return cls(at, cell, before * half_step, after * half_step, half_step, half, jump or 0.0)

    def change_while_moving(self, values: Array) -> Array:
        """Return by how much a channel, shape (N,), changes in each cell while the drive moves, shape (N,)."""
        change = np.zeros(len(values))
        np.subtract(values[1:], values[:-1], out=change[:-1], where=self.half > 0.0)
        if len(self.cell):
            whole = self.recording.time[self.cell + 1] - self.recording.time[self.cell]
            share = 2.0 * (self.before + self.after) / whole
            change[self.cell] = share * (values[self.cell + 1] - values[self.cell])
        return change

    def impulses(self, rows: Array) -> Array:
        """Return the integral of each row over each cell, shape (k, N), in torque × time; cell k follows sample k.

        Trapezium rule, in two parts where the cell is split.

        Args:
            rows: evaluated at :attr:`recording`, shape (k, N + two for each split cell).
        """
        values = np.zeros((len(rows), len(self.half) + 1))
        values[:, :-1] = self._straight(rows)
        return values

    def along_cubics(self, rows: Array) -> Array:
        """Return :meth:`impulses`, by cubics where four samples lie in one stretch of motion, shape (k, N)."""
        from fricmodels.weakform.cells import along_cubics

        values = np.empty((len(rows), len(self.half) + 1))
        rows = np.ascontiguousarray(rows, dtype=float)
        along_cubics(rows, self.half, self.cell, self.before, self.after, self._bending, values)
        return values

    def under_hats(self, rows: Array) -> Array:
        """Return the integral of each row under a hat over the two cells about each sample, shape (k, N).

        By cubics as :meth:`along_cubics`.
        """
        from fricmodels.weakform.cells import under_hats

        values = np.empty((len(rows), len(self.half) + 1))
        rows = np.ascontiguousarray(rows, dtype=float)
        under_hats(rows, self.half, self.cell, self.before, self.after, self.half_step, self._bending, values)
        return values

    @cached_property
    def moving_time(self) -> Array:
        """For how long the drive moves in each cell, shape (N,); cell k follows sample k, the last one is none."""
        time = np.append(2.0 * self.half, 0.0)
        time[self.cell] = 2.0 * (self.before + self.after)
        return time

    def _straight(self, rows: Array) -> Array:
        """Return the integral over each cell along straight lines, shape (k, N − 1)."""
        count = len(self.half) + 1
        values = np.add(rows[:, : count - 1], rows[:, 1:count])
        values *= self.half
        if len(self.cell):
            stopping, starting = self._at_zero(rows)
            values[:, self.cell] = self.before * (rows[:, self.cell] + stopping) + self.after * (
                starting + rows[:, self.cell + 1]
            )
        return values

    def _at_zero(self, rows: Array) -> tuple[Array, Array]:
        """Return the values at the instants of stopping and of starting, shape (k, split cells) each."""
        count, cells = len(self.half) + 1, len(self.cell)
        return rows[:, count : count + cells], rows[:, count + cells :]

    @cached_property
    def _bending(self) -> Array:
        r"""Weights of the changes within the cell before, each cell, and the cell after, shape (3, N − 3).

        What a cubic adds to the straight line over each cell but the first and last: :math:`-\frac{h^3}{12} f''`, with
        the mean of the second derivatives at both ends of the cell. They are zero where the cell or a neighbour is
        split, rests or is missing; the middle one is where all cells are equal, but for rounding.
        """
        from fricmodels.weakform.split import bending_of

        weights = np.empty((3, max(len(self.half) - 2, 0)))
        bending_of(self.half, weights)
        return weights


def mean_velocity(recording: Recording, position: Array) -> Array:
    """Return the mean velocity from each sample to the next, shape (N,): what positions say without any smoothing.

    At the last sample of a run there is none; 0 stands there, and no bump reaches it.
    """
    step = np.diff(recording.time)
    within = (np.diff(recording.run) == 0) & (step > 0)
    velocity = np.zeros(len(recording))
    velocity[:-1][within] = np.diff(position)[within] / step[within]
    return velocity


def _cells(width: int, over_cells: bool) -> tuple[Array, Array]:
    """Return a bump's weights of the changes of velocity, and of everything else in each cell, each of sum 1.

    The change between the mean velocities of two cells weighs the acceleration by a hat over both.
    """
    inner = width - 1 if over_cells else width
    x = 2.0 * np.arange(1, inner) / inner - 1.0
    changes = (1.0 - x**2) ** 2
    changes /= changes.sum()
    if not over_cells:
        return np.pad(changes, 1), np.pad(changes, 1)
    return np.pad(changes, (1, 2)), np.pad(np.convolve(changes, [0.5, 0.5]), 1)


def _share_to_zero(velocity: Array, next_one: Array, one_further: Array) -> Array:
    """Return the share of a cell within which a velocity reaches zero, continued with the change of its slope.

    Args:
        velocity: at the sample beside the cell.
        next_one, one_further: at the two samples beyond it, away from the cell.
    """
    change, bend = next_one - velocity, one_further - 2 * next_one + velocity
    first = _share(velocity, change)
    mean_change = change - 0.5 * (1.0 + first) * bend
    return np.where(mean_change * change > 0.0, _share(velocity, mean_change), first)


def _share(velocity: Array, change: Array) -> Array:
    """Return the share of a cell after which a velocity that changes so much in a cell is zero, at most 1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(change != 0.0, velocity / change, velocity != 0.0)
    return np.where((share >= 0.0) & (share <= 1.0), share, 1.0)


class TestFunctions:
    """TestFunctions of one width along a recording, an eighth of their width apart.

    Args:
        recording: gives the stretches without a gap.
        width: samples that a bump spans; rounded to a multiple of 8.
        resting: samples at rest, or otherwise of no use.
        least_moving: share of a bump's weight that must be in motion; a bump with less is left out.
        over_cells: whether the velocity is the mean over each cell, see :func:`mean_velocity`.
    """

    def __init__(
        self,
        recording: Recording,
        width: int,
        resting: NDArray[np.bool_],
        *,
        least_moving: float = 0.5,
        over_cells: bool = False,
    ) -> None:
        self.hop = max(1, round(width / HOPS))
        self.width = self.hop * HOPS
        self.over_cells = over_cells
        self._resting, self._asked = resting, width
        changes, between = _cells(self.width, over_cells)
        self.changes = changes[:-1]
        self._mean = 0.5 * (between[:-1] + between[1:])
        self._cell = between[1:]
        self._fall = between[:-1] - between[1:]
        self._velocity_fall = changes[:-1] - changes[1:]
        pieces = [piece for piece in segments(recording) if piece.stop - piece.start >= self.width]
        self._first = np.array([piece.start for piece in pieces], dtype=np.int64)
        self._bumps = np.array([(p.stop - p.start) // self.hop - HOPS + 1 for p in pieces], dtype=np.int64)
        self._kept = np.arange(self._bumps.sum())
        moving = self._apply((~resting).astype(float)[None], self._mean)[0]
        self._kept = np.flatnonzero(moving >= least_moving - 1e-12)
        self.count = len(self._kept)

    def clear_of(self, samples: NDArray[np.bool_]) -> TestFunctions:
        """Return the test functions that none of some samples lies within."""
        other = copy(self)
        other._asked = 0
        other._kept = self._kept[self.integrals(samples.astype(float)[None])[0] == 0.0]
        other.count = len(other._kept)
        return other

    def is_of(self, width: int, resting: NDArray[np.bool_]) -> bool:
        """Whether they were made for a width and samples of no use."""
        return self._asked == width and np.array_equal(self._resting, resting)

    each = 1
    """Rows of each bump."""

    @property
    def left_out(self) -> NDArray[np.bool_]:
        """Samples at rest, or otherwise of no use, shape (N,)."""
        return self._resting

    def covered(self, count: int) -> NDArray[np.bool_]:
        """Mark the samples that lie within a bump, shape (N,)."""
        marks = np.zeros(count + 1)
        np.add.at(marks, self.begins, 1.0)
        np.add.at(marks, self.begins + self.width, -1.0)
        return np.asarray(np.cumsum(marks[:-1]) > 0.5)

    @property
    def begins(self) -> NDArray[np.int64]:
        """The sample at which each bump begins, shape (number of bumps,)."""
        starts = [a + self.hop * np.arange(n) for a, n in zip(self._first, self._bumps, strict=True)]
        return np.concatenate([np.zeros(0, dtype=np.int64), *starts])[self._kept]

    @property
    def weights(self) -> Array:
        """Weight of each sample in a mean over a test function, of sum 1."""
        return self._mean

    def integrals(self, integrand: Array) -> Array:
        """Return ∫φ f dt for rows f, shape (k, number of bumps)."""
        return self._apply(integrand, self._mean)

    def torques(self, quadrature: Quadrature, rows: Array) -> Array:
        """Return ∫φ f dt of rows, shape (k, N + two for each split cell) → (k, number of test functions)."""
        if self.over_cells:
            return self._apply(quadrature.under_hats(rows), self.changes)
        return self.of_cells(quadrature.along_cubics(rows))

    def of_cells(self, impulses: Array) -> Array:
        """Return Σ φ I over the cells, shape (k, number of test functions), of what is known to happen in each cell.

        Args:
            impulses: of each cell, shape (k, N), weighted by the mean of the test function there.
        """
        return self._apply(impulses, self._cell)

    def momentum(self, velocity: Array) -> Array:
        """Return ∫φ dω = −∫φ' ω dt, shape (number of bumps,)."""
        return np.asarray(self._apply(velocity[None], self._velocity_fall)[0])

    def change(self, values: Array) -> Array:
        """Return ∫φ df = −∫φ' f dt of what was measured, shape (number of bumps,)."""
        return np.asarray(self._apply(values[None], self._fall)[0])

    def of_steps(self, steps: Array) -> Array:
        """Return Σ φ x over the samples, shape (k, number of bumps), of what is centred as changes of velocity are.

        Args:
            steps: shape (k, N); the first of a bump belongs to the change from its first sample to its second.
        """
        return self._apply(steps, self.changes)

    def _apply(self, rows: Array, kernel: Array) -> Array:
        from fricmodels.weakform.cells import weighted_sums

        sums = np.empty((len(rows), len(self._kept)))
        rows = np.ascontiguousarray(rows, dtype=float)
        weighted_sums(rows, self._first, self._bumps, kernel.reshape(HOPS, self.hop), self._kept, sums)
        return sums
