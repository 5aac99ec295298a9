r"""Rows of files whose noise is unlike: what a fit leaves of them says how much no model explains.

What looks like noise of a file may be its torque: that of a stiff controller, or of a fast motion. And what a model
does not explain is in all files alike. The more that is, the more alike rows count.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording
from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.row_noise import alike_samples, counts_of, row_sizes
from fricmodels.weakform.test_functions import TestFunctions


def counts_as_left(
    recording: Recording, test_functions: TestFunctions, inertia: float, target: Array, design: Array
) -> Array | None:
    r"""Return by how much rows count, by their noise and by what least squares leave of them beside it, shape (N,).

    Of the file of which they leave least: :math:`u^2 = s^2 / r^2 - v^2 / r^2 - t^2`, with s the RMS of what is left and
    r, v and t as in :func:`fricmodels.weakform.rates.weights_of_rows`. ``None`` where all files have alike noise.

    Args:
        recording: whose rows they are.
        test_functions: of which rows count by the noise of their files.
        inertia: of the drive.
        target: of the rows, shape (rows,).
        design: what may explain it, shape (k, rows).
    """
    of, at, counts = alike_samples(recording), test_functions.begins, test_functions.counts
    sizes = None if of is None else row_sizes(recording, inertia, test_functions.width)
    if counts is None or of is None or sizes is None or not len(at):
        return None
    relative = relative_intervals(recording)
    design = design / np.maximum(np.linalg.norm(design, axis=1, keepdims=True), 1e-300)
    left = target - np.linalg.lstsq(design.T, target, rcond=None)[0] @ design
    squares = (left / counts[at] / relative[at]) ** 2 - (sizes[0] / relative)[at] ** 2 - sizes[1][at] ** 2
    number = np.bincount(of[at], minlength=of.max() + 1)
    known = number > len(design)
    if not known.any():
        return None
    unexplained = np.min(np.maximum(np.bincount(of[at], squares, len(number))[known] / number[known], 0.0))
    return counts_of(recording, sizes, float(np.sqrt(unexplained)))
