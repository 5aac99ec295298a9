r"""Rows of runs whose noise is unlike: what a fit leaves of them says how much no model explains.

What looks like noise of a run may be its torque: that of a stiff controller, or of a fast motion. And what a model does
not explain is in all runs alike. The more that is, the more alike rows count.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.row_noise import alike_samples, row_counts, row_sizes
from fricmodels.weakform.test_functions import TestFunctions


class Rows(Protocol):
    """The rows of a weak-form problem."""

    @property
    def drive(self) -> Drive:
        """The model under test."""

    @property
    def recording(self) -> Recording:
        """Whose rows they are."""

    @property
    def bumps(self) -> TestFunctions:
        """The test functions."""

    @property
    def target(self) -> Array:
        """Left side of each row, shape (rows,)."""

    @property
    def momentum(self) -> Array:
        """∫φ dω, shape (rows,)."""

    @property
    def sign_change(self) -> Array:
        """What a shift of every reversal would add, shape (rows,)."""

    @property
    def torque_rate(self) -> Array:
        """What a shift in time would add, shape (rows,)."""

    def columns(self, drive: Drive, nonlinear: Sequence[float] = ()) -> tuple[Array, Array]:
        """What linear parameters multiply, shape (k, rows), and what none does."""


def counts_as_left(rows: Rows, parameters: Mapping[str, float], inertia: float) -> Array | None:
    r"""Return by how much rows count, by their noise and by what least squares leave of them beside it, shape (N,).

    Of the file of which they leave least: :math:`u^2 = s^2 / r^2 - v^2 / r^2 - t^2`, with s the RMS of what is left and
    r, v and t as in :func:`fricmodels.weakform.rates.weights_of_rows`. ``None`` where all files have alike noise.

    Args:
        rows: that count by the noise of their files.
        parameters: an estimate, by key, of which those count that are not linear.
        inertia: of the drive.
    """
    recording, counts, at, drive = rows.recording, rows.bumps.counts, rows.bumps.begins, rows.drive
    of, sizes = alike_samples(recording), row_sizes(recording, inertia, rows.bumps.width)
    if counts is None or of is None or sizes is None or not len(at):
        return None
    every, relative = zip(drive.model.parameters, drive.model.linear, strict=True), relative_intervals(recording)
    own = [] if drive.inertia is not None else [rows.momentum]
    columns, _ = rows.columns(drive, [parameters[p.key] for p, linear in every if not linear])
    design = np.vstack([columns, rows.sign_change, rows.torque_rate, *own])
    design /= np.maximum(np.linalg.norm(design, axis=1, keepdims=True), 1e-300)
    left = rows.target - np.linalg.lstsq(design.T, rows.target, rcond=None)[0] @ design
    squares = (left / counts[at] / relative[at]) ** 2 - (sizes[0] / relative)[at] ** 2 - sizes[1][at] ** 2
    number = np.bincount(of[at], minlength=of.max() + 1)
    known = number > len(design)
    if not known.any():
        return None
    unexplained = np.min(np.maximum(np.bincount(of[at], squares, len(number))[known] / number[known], 0.0))
    return row_counts(recording, inertia, rows.bumps.width, float(np.sqrt(unexplained)))
