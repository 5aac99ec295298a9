"""Integrals of torques over the cells between neighbouring samples.

Torques are integrated along cubics through four samples; where the velocity changes its sign between two samples, along
straight lines, split at the instant of the crossing, where the motor torque may jump.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.weakform.jumps import jumps_at_reversals
from fricmodels.weakform.stretches import cells_of


@dataclass(frozen=True)
class Quadrature:
    """Where a torque is evaluated to be integrated: at the samples, and where the drive stops, starts or turns between.

    A cell lies between two neighbouring samples. Where the drive turns, stops or starts within a cell, only the parts
    of it before and after the standstill count; they are found by continuing the velocity of the neighbouring cells
    to zero, because its slope jumps there by twice the Coulomb friction. A standstill between them that is no longer
    than the bend of the velocity moves both ends is none: a velocity without a standstill, continued from both sides,
    leaves 1 % of a cell between, and an inertia that is 0.1 % too small at 100 Hz.

    Attributes:
        recording: the recorded samples, then for each split cell the instant of stopping, then that of starting.
        cell: index of the sample before each split cell.
        before, after: half the duration of the moving part before and after the zero.
        half_step: half the duration of each split cell.
        half: half the duration of each cell that is not split, 0 for the others, shape (N − 1,).
        jumps: by how much [N m or N] the motor torque jumps in each split cell, shape (c,); see :mod:`.jumps`.
        jump: by how much it jumps with the sign of the velocity.
        cubic: what a cubic adds to the straight line over each cell but the first and last, were all whole: weights of
            the changes within the cell before, the cell, and the cell after, shape (3, N − 3).
    """

    recording: Recording
    cell: Index
    before: Array
    after: Array
    half_step: Array
    half: Array
    jumps: Array
    jump: float
    cubic: Array

    @classmethod
    def of(cls, recording: Recording, velocity: Array, resting: Mask, jump: float | None = None) -> Quadrature:
        """Prepare the integrals over a recording with the velocity that the friction torque is to be evaluated at.

        Args:
            recording: as it is integrated.
            velocity: at its samples, shape (N,).
            resting: samples of no use, shape (N,).
            jump: of the motor torque; as its reversals show it if not given.
        """
        from fricmodels.weakform.cell_loops import split_cells

        step, joined = cells_of(recording)
        moving, half, cell = ~resting, np.empty(len(step)), np.empty(len(step), dtype=np.int64)
        cell = cell[: split_cells(step, joined, velocity, resting, half, cell)].copy()
        earlier, later = velocity[cell], velocity[cell + 1]
        beyond = np.clip([[cell - 1, cell + 2], [cell - 2, cell + 3]], 0, len(recording) - 1)
        shares, doubts = _share_to_zero(np.array([earlier, later]), *velocity[beyond])
        before, after = np.where(moving[[cell, cell + 1]], shares, 0.0)
        both_parts = before + after
        turning = moving[cell] & moving[cell + 1] & (1.0 - both_parts <= doubts[0] + doubts[1])
        both_parts[~turning] = np.maximum(both_parts[~turning], 1.0)
        before, after = before / both_parts, after / both_parts
        tiny = 1e-9 * float(np.max(np.abs(velocity), initial=1e-300))
        channels, jumps = {}, np.zeros(len(cell))
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
        before, after, cubic = before * half_step, after * half_step, _cubic(recording)
        return cls(at, cell, before, after, half_step, half, jumps, jump or 0.0, cubic)

    def at_velocity(self, velocity: Array, acceleration: Array) -> Quadrature:
        """Return it with another velocity and acceleration at the samples, shape (N,); cells stay cut as they are."""
        beside = np.concatenate([acceleration[self.cell], acceleration[self.cell + 1]])
        points = self.recording.with_channels(
            velocity=np.concatenate([velocity, self.recording.velocity[len(velocity) :]]),
            acceleration=np.concatenate([acceleration, beside]),
        )
        return replace(self, recording=points)

    @property
    def turns(self) -> Array:
        """By how much the sign of the velocity changes in each cell, shape (N,): ±2 where the drive turns."""
        side, turns = np.sign(self.recording.velocity), np.zeros(len(self.half) + 1)
        turns[self.cell] = side[self.cell + 1] - side[self.cell]
        return turns

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

    def sums_along_cubics(self, rows: Array, begins: Index, lengths: Index, parts: Array, count: int) -> Array:
        """Return the sums under test functions of the integral of each row over each cell, shape (k, test functions).

        By cubics where four samples lie in one stretch of motion.

        Args:
            rows: evaluated at :attr:`recording`, shape (k, N + two for each split cell).
            begins, lengths, parts: the test functions, see :func:`.cells.weighted_sums`.
            count: how many there are.
        """
        from fricmodels.weakform.cells import sums_along_cubics

        sums = np.empty((len(rows), count))
        rows = np.ascontiguousarray(rows, dtype=float)
        cells = self.half, self.cell, self.before, self.after, self.bending
        sums_along_cubics(rows, *cells, begins, lengths, parts, sums)
        return sums

    def under_hats(self, rows: Array) -> Array:
        """Return the integral of each row under a hat over the two cells about each sample, shape (k, N).

        By cubics as :meth:`sums_along_cubics`.
        """
        from fricmodels.weakform.cells import under_hats

        values = np.empty((len(rows), len(self.half) + 1))
        rows = np.ascontiguousarray(rows, dtype=float)
        under_hats(rows, self.half, self.cell, self.before, self.after, self.half_step, self.bending, values)
        return values

    def bent_at_reversals(self, torque: Array) -> Array:
        """Return what the driving torque bends by at reversals, shape (N,), which :meth:`sums_along_cubics` leaves out.

        What a drive is driven by goes on through a reversal, but for the jump that it may have there; friction and all
        that a model is made of may have a bend there. So the cells of a reversal and beside it, where the acceleration
        is largest, get their cubic as all others do, if the torque is seen to go on: by straight lines in them an
        inertia came out too small by up to 0.25 % at 100 Hz.

        Args:
            torque: motor torque less load torque at the samples, shape (N,).
        """
        from fricmodels.weakform.cell_loops import bent_about

        through = (self.half_step > 0.0) & (self.before + self.after > (1.0 - 1e-9) * self.half_step)
        if self.jump:
            through &= self.jumps != 0.0
        half, change, bent = self.half.copy(), np.diff(torque), np.zeros(len(torque))
        half[self.cell[through]] = self.half_step[through]
        change[self.cell] -= self.jumps
        bent_about(self.cell[through], half, self.half, self.cubic, change, bent)
        return bent

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
    def bending(self) -> Array:
        """What is added of :attr:`cubic`: nothing where the cell or a neighbour is split, rests or is missing."""
        from fricmodels.weakform.cell_loops import where_whole

        weights = np.empty_like(self.cubic)
        where_whole(self.half, self.cubic, weights)
        return weights


@once
def _cubic(recording: Recording) -> Array:
    r"""Return what a cubic adds to the straight line: :math:`-\frac{h^3}{12} f''`, shape (3, N − 3).

    With the mean of the second derivatives at both ends of the cell. The middle weight is zero where all cells are
    equal, but for rounding.
    """
    from fricmodels.weakform.cell_loops import bending_of

    step, _ = cells_of(recording)
    weights = np.empty((3, max(len(step) - 2, 0)))
    bending_of(0.5 * step, weights)
    return weights


def _share_to_zero(velocity: Array, next_one: Array, one_further: Array) -> tuple[Array, Array]:
    """Return the share of a cell in which a velocity reaches zero, and by how much the change of its slope moves it.

    Args:
        velocity: at the sample beside the cell, before it or after it, shape (2, c).
        next_one, one_further: at the two samples beyond it, away from the cell, likewise.
    """
    change, bend = next_one - velocity, one_further - 2 * next_one + velocity
    first = _share(velocity, change)
    mean_change = change - 0.5 * (1.0 + first) * bend
    share = np.where(mean_change * change > 0.0, _share(velocity, mean_change), first)
    return share, np.abs(share - first)


def _share(velocity: Array, change: Array) -> Array:
    """Return the share of a cell after which a velocity that changes so much in a cell is zero, at most 1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(change != 0.0, velocity / change, velocity != 0.0)
    return np.where((share >= 0.0) & (share <= 1.0), share, 1.0)
