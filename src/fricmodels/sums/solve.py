"""From sums to parameters: the least squares of all rows, with standard errors from what parts of them differ by."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, deviations
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.results.words import stretches_of_motion
from fricmodels.signals.coasting import PER_INERTIA
from fricmodels.sums.summed import Sums
from fricmodels.weakform.estimate import Estimate
from fricmodels.weakform.identification import not_identified
from fricmodels.weakform.inference import jackknife_covariance
from fricmodels.weakform.nonlinear import linear_constraints
from fricmodels.weakform.separable import separable
from fricmodels.weakform.test_functions import HOPS
from fricmodels.weakform.variable_projection import Equations, Projection

_ROWS = 4
"""Rows for each parameter that a fit needs more of, as one recording does."""
_FILES = 16
"""Files from which on what they differ by is a standard error, too."""


def solved(sums: Sums, inertia: float | None = None) -> Estimate:
    """Return the parameters that all rows together have, as if they were solved at once.

    The rows may be shifted in time, and their reversals, as those of one recording may (see
    :func:`fricmodels.weakform.equations.timing_nuisances`). Standard errors are those of the jackknife over parts of
    the files' time, or over the files, whichever are larger.

    Args:
        sums: of one file or of many.
        inertia: given [kg m² or kg]; estimated if not.

    Raises:
        InputError: where there are too few rows, or a drive coasts whose inertia is not given.
    """
    drive = Drive(sums.plan.drive.model, inertia, sums.plan.motion)
    if sums.rows <= _ROWS * len(drive.parameters):
        clear = stretches_of_motion(sums.rows, sums.plan.width * sums.plan.interval)
        raise InputError(
            f"these sums have {clear}, where {len(drive.parameters)} parameters ask for "
            f"{_ROWS * len(drive.parameters) + 1}; add files with more motion"
        )
    squares = float(sums.whole[0, 0]) or float((inertia or 0.0) ** 2 * sums.whole[1, 1])  # of the push, or the inertia
    if not squares:
        raise InputError(f"the torque of these sums is zero throughout: {PER_INERTIA}; give --inertia")
    rows = _rows_of(sums.whole)
    equations = _equations(sums, drive, rows)
    linear = [p for p in drive.parameters if p.linear]
    found = Projection(equations, *linear_constraints(linear)).at(np.zeros(0))
    count = len(drive.parameters)
    inverse = found.normal.inverse
    spread = _spread(sums, drive, sums.stretches, found.theta, inverse)
    if len(sums.files) >= _FILES:
        by_files = _spread(sums, drive, sums.apart, found.theta, inverse)
        before, other = (np.clip(np.diag(each), 0.0, None) for each in (spread, by_files))
        grown = np.sqrt(np.maximum(np.divide(other, before, out=np.ones_like(other), where=before > 0.0), 1.0))
        spread = spread * np.outer(grown, grown)
    covariance = spread[:count, :count]
    values = found.theta[:count]
    free = (np.full(count, -np.inf), np.full(count, np.inf))
    reasons = not_identified(drive, values, covariance, found.normal.null[:count], free)
    parameters = dict(zip(drive.keys, values.tolist(), strict=True))
    errors = deviations(covariance)
    return Estimate(
        {**parameters, drive.inertia_key: inertia if inertia is not None else parameters[drive.inertia_key]},
        dict(zip(drive.keys, errors.tolist(), strict=True)),
        covariance,
        reasons,
        float(found.theta[-1]),
        100.0 * float(np.sqrt(found.cost / squares)),
    )


def _equations(sums: Sums, drive: Drive, rows: Array) -> Equations:
    """Return rows, shape (columns, any number), as the equations that every fit in weak form solves."""
    interval = sums.plan.interval
    target = rows[0] if drive.inertia is None else rows[0] - drive.inertia * rows[1]
    split = separable(drive.model)
    fixed = np.zeros((len(split.fixed), rows.shape[1]))
    for place, row in enumerate(split.fixed):  # what no parameter multiplies is taken from the push already
        if row < len(split.linear):
            fixed[place] = rows[2 + row]
    return Equations(
        split,
        rows[0],
        target,
        rows[1] if drive.inertia is None else None,
        fixed,
        lambda alpha, slopes: (),
        rows[-2:],
        np.array([(-np.inf, np.inf), (-interval, interval)]),
        sums.plan.row_noise * sums.rows if drive.inertia is None else 0.0,
    )


def _rows_of(products: Array) -> Array:
    """Return as many rows as there are columns, with the same products, shape (columns, columns)."""
    size = np.sqrt(np.diag(products))
    size = np.where(size > 0.0, size, 1.0)
    values, vectors = np.linalg.eigh(products / np.outer(size, size))
    return np.asarray((vectors * np.sqrt(np.clip(values, 0.0, None))) * size[:, None])


def _spread(sums: Sums, drive: Drive, parts: Array, theta: Array, inverse: Array) -> Array:
    """Return the covariance of the estimates by leaving out one part after the other."""
    independent = 2.0 * sums.rows / HOPS
    some = parts[np.any(parts != 0.0, axis=(1, 2))]
    chosen = [1, *range(2, parts.shape[1])] if drive.inertia is None else [*range(2, parts.shape[1])]
    columns, residuals = [], []
    for part in some:
        rows = _rows_of(part)
        target = rows[0] if drive.inertia is None else rows[0] - drive.inertia * rows[1]
        columns.append(rows[chosen].T)
        residuals.append(target - theta @ rows[chosen])
    return jackknife_covariance(np.concatenate(columns), np.concatenate(residuals), inverse, independent, len(some))
