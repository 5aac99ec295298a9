"""Jumps of the motor torque where the drive turns, between two samples.

A drive whose friction is compensated, or a computed torque, jumps where the drive turns, between two samples. A
straight line over that cell is wrong by up to the Coulomb torque times half the cell, each time by another amount.
The lines through the two samples before and after a reversal differ at it by the jump, or by noise alone if the
torque goes on. The jump is the median over all reversals, if it is three times its standard error (that of a normal
distribution), the same in all cells that show it rather than none: where noise hides the instant, the torque jumps
in another cell.

Where each sample is the mean torque over a sampling interval, as a current sensor may give it, straight lines are
right. A jump at a share m of a cell from the nearer sample then is seen as :math:`(1 + m + 2m^2)/2` of its size.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index

_FEWEST_REVERSALS, _CERTAIN = 6, 3.0
"""A jump is seen at so many reversals, and is so many times its standard error; six by chance have one sign once in 32
times."""


def jumps_at_reversals(
    torque: Array, cell: Index, before: Array, after: Array, half: Array, sides: Array, usual: float | None = None
) -> tuple[Array, float]:
    """Return by how much [N m or N] the motor torque jumps in each split cell, shape (c,), and usually.

    Args:
        torque: at the samples, shape (N,).
        cell, before, after: split cells, and the shares of each before and after the zero, shape (c,).
        half: half the duration of each cell that is not split, shape (N − 1,).
        sides: change of the sign of the velocity in each of them; two at a reversal.
        usual: the jump with the sign of the velocity, half of that at a reversal; as these reversals show it if not
            given.
    """
    inner = (cell > 0) & (cell < len(half) - 1) & (np.abs(sides) == 2.0)
    inner[inner] = (half[cell[inner] - 1] > 0.0) & (half[cell[inner] + 1] > 0.0)
    at = cell[inner]
    until = torque[at] + before[inner] * (torque[at] - torque[at - 1])
    since = torque[at + 1] - after[inner] * (torque[at + 2] - torque[at + 1])
    seen = (since - until) / sides[inner]
    if usual is None:
        usual = _usual(seen, np.minimum(before[inner], after[inner]))
    jumps = np.zeros(len(cell))
    jumps[inner] = np.where(np.abs(seen - usual) < np.abs(seen), usual, 0.0) * sides[inner]
    return jumps, usual


def _usual(seen: Array, nearer: Array) -> float:
    """Return the jump that reversals show; 0 where it may be none, or samples are means.

    Args:
        seen: by how much the lines on both sides of each reversal differ there, shape (n,).
        nearer: share of the cell from the reversal to the nearer sample, shape (n,).
    """
    if len(seen) < _FEWEST_REVERSALS:
        return 0.0
    usual = _median(seen)
    apart = np.abs(seen - usual)
    of_means = 0.5 * (1.0 + nearer + 2.0 * nearer**2)
    # Of a normal distribution: the standard error of a median, by the median deviation.
    error = 1.2533 * 1.4826 * _median(apart) / np.sqrt(len(seen))
    instant = apart.sum() < np.abs(seen - _median(seen / of_means) * of_means).sum()
    return usual if instant and abs(usual) > _CERTAIN * error else 0.0


def _median(values: Array) -> float:
    """Return the median of at least one value; not a number where one of them is none, which is sorted to the end."""
    ordered, middle = np.sort(values), len(values) // 2
    if np.isnan(ordered[-1]):
        return float("nan")
    return float(ordered[middle] if len(values) % 2 else (ordered[middle - 1] + ordered[middle]) / 2.0)
