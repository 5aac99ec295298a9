"""What the batch estimator asks of a drive and a recording, in the order of the drive's parameters."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.dimension import FORCE, INERTIA, VISCOUS
from fricmodels.drive import Drive, DriveParameter
from fricmodels.errors import InputError, suggestion
from fricmodels.recording import Recording
from fricmodels.weakform.ranges import natural_size, scan_size, scan_values, within_motion

MAX_STARTS = 320
"""Most combinations of starting values that are tried."""
LARGEST_RATIO = 1.5
"""Largest step of a parameter on a logarithmic scale: a factor of e^1.5."""


@dataclass(frozen=True)
class Outcome:
    """What a fit found, in the order of the drive's parameters, in SI units.

    Attributes:
        values, covariance: the estimates.
        undetermined: directions, in columns of unit length, that change nothing; shape (n, any number).
        succeeded, message: how it ended.
    """

    values: Array
    covariance: Array
    undetermined: Array
    succeeded: bool
    message: str


def linear_constraints(
    parameters: Sequence[DriveParameter],
    delay: float = 0.0,
    largest_push: float = np.inf,
    inertia: float | None = None,
) -> tuple[Array, Array]:
    """Return G and h with ``G θ ≥ h``: bounds of the linear parameters, and which is at least which other.

    A stick torque, which is at least the slip torque, is no larger than what has pushed the drive out of rest. Else,
    where hardly a sample is slow enough to see it, it could be anything. A part of the drive has no more inertia than
    all of it, and no more viscous friction than its law, in either direction: what is left of that does not drive. Nor
    does a drive lack more than a share of its inertia.

    Args:
        parameters: the linear ones.
        delay: time [s] by which the recording was shifted already; what is fitted of a delay comes on top of it.
        largest_push: largest torque that pushed the drive [N m or N].
        inertia: of the whole drive, where it is known and not one of them.
    """
    keys = [p.key for p in parameters]
    whole = [i for i, p in enumerate(parameters) if p.dimension == INERTIA and "." not in p.key]
    viscous = [i for i, p in enumerate(parameters) if p.dimension == VISCOUS and "." not in p.key]
    rows, limits = [], []
    for i, p in enumerate(parameters):
        row = np.zeros(len(keys))
        row[i] = 1.0
        gone = delay if p.declared.delay else 0.0
        bounded_by_another = p.at_least in keys
        if np.isfinite(p.declared.lower) and not bounded_by_another:
            rows.append(row)
            limits.append(p.declared.lower - gone)
        if np.isfinite(p.declared.upper):
            rows.append(-row)
            limits.append(gone - p.declared.upper)
        if bounded_by_another and p.dimension == FORCE and np.isfinite(largest_push):
            rows.append(-row)
            limits.append(-largest_push)
        if p.declared.part_of_drive and p.dimension == INERTIA and (whole or inertia is not None):
            least = -row
            least[whole] = 1.0
            rows.append(least)
            limits.append(-(inertia or 0.0))
        if p.declared.less_of_drive and (whole or inertia is not None):
            kept = row.copy()
            kept[whole] = p.declared.less_of_drive
            rows.append(kept)
            limits.append(-p.declared.less_of_drive * (inertia or 0.0))
        if p.declared.part_of_drive and p.dimension == VISCOUS:
            for j in viscous:
                least = -row
                least[j] = 1.0
                rows.append(least)
                limits.append(0.0)
        if bounded_by_another:
            row = row.copy()
            row[keys.index(str(p.at_least))] = -1.0
            rows.append(row)
            limits.append(0.0)
    return np.array(rows).reshape(-1, len(keys)), np.array(limits)


@dataclass(frozen=True)
class Nonlinear:
    """How the nonlinear parameters are searched.

    Attributes:
        starts: starting values of each.
        lower, upper: bounds.
        logarithmic: which are searched on a logarithmic scale.
        reach: largest step of each, of the logarithm where the scale is logarithmic; of an instant the spacing of those
            that are tried first.
        held: which stay at their start.
    """

    starts: Sequence[tuple[float, ...]]
    lower: Array
    upper: Array
    logarithmic: Mask
    reach: Array
    held: Mask

    def clip(self, alpha: Array) -> Array:
        """Return the nearest values within the bounds."""
        return np.minimum(np.maximum(alpha, self.lower), self.upper)

    def points(self) -> list[Array]:
        """Return the starting points within the bounds."""
        return [self.clip(point) for point in self.combinations()]

    def combinations(self) -> list[Array]:
        """Return the starting points: all combinations while they are few, else one parameter varied at a time."""
        total = np.prod([len(values) for values in self.starts])
        if total <= MAX_STARTS:
            return [np.array(values) for values in itertools.product(*self.starts)]
        middle = [values[len(values) // 2] for values in self.starts]
        points = [np.array(middle)]
        for i, values in enumerate(self.starts):
            points += [np.array([*middle[:i], value, *middle[i + 1 :]]) for value in values]
        return points


@dataclass(frozen=True)
class Plan:
    """What is laid down before a fit.

    Attributes:
        start: values of nonlinear parameters to start from, by key.
        held: values at which parameters are held that the recording does not determine, by key.
        nearly: whether the start is the optimum of nearly the same rows.
        shifts: coefficients at which the nuisances are held, in their order; free if there are none.
    """

    start: Mapping[str, float] = field(default_factory=dict)
    held: Mapping[str, float] = field(default_factory=dict)
    nearly: bool = False
    shifts: tuple[float, ...] = ()


def nonlinear_search(drive: Drive, recording: Recording, plan: Plan = Plan()) -> Nonlinear:
    """Return where to look for the nonlinear parameters: their scans in the recording's own sizes."""
    chosen = [p for p in drive.parameters if not p.linear]
    starts, logarithmic, reach, lower, upper = [], [], [], [], []
    for p in chosen:
        within = within_motion(recording, p.declared)
        first = plan.held.get(p.key, plan.start.get(p.key))
        scan = (first,) if first is not None else tuple(scan_values(recording, p.declared))
        starts.append(scan or (p.declared.initial,))
        signed = p.declared.periodic or p.declared.place or p.declared.instant  # of an instant the clock says nothing
        ratio = not signed and p.declared.lower >= 0.0 and min(starts[-1]) > 0.0
        logarithmic.append(ratio)
        span = natural_size(recording, p.dimension**-1) if p.declared.periodic else 0.0
        reach.append(LARGEST_RATIO if ratio else np.pi / span if span > 0.0 else _between_instants(recording, p))
        # A wave of which less than a period is passed is any slow shape, and stands for the Coulomb friction as well.
        lower.append(max(p.declared.lower, 2 * reach[-1]) if span > 0.0 else within.lower)
        upper.append(within.upper)
    return Nonlinear(
        starts,
        np.array(lower, dtype=float),
        np.array(upper, dtype=float),
        np.array(logarithmic, dtype=bool),
        np.array(reach, dtype=float),
        np.array([p.key in plan.held or p.declared.constant for p in chosen], dtype=bool),
    )


def _between_instants(recording: Recording, p: DriveParameter) -> float:
    """Return the spacing [s] of the instants that are tried first; infinite for a parameter of another kind."""
    return scan_size(recording, p.declared) / (len(p.declared.scan) + 1) if p.declared.instant else np.inf


def check_start(drive: Drive, start: Mapping[str, float]) -> None:
    """Check that starting values are for nonlinear parameters and within their bounds.

    Raises:
        InputError: naming the key that is not.
    """
    nonlinear = {p.key: p.declared for p in drive.parameters if not p.linear}
    for key, value in start.items():
        if key not in nonlinear:
            what = "enters linearly and needs no starting value" if key in drive.keys else "is not a parameter"
            raise InputError(f"start: '{key}' {what} of '{drive.model.name}'{suggestion(key, nonlinear)}")
        if not nonlinear[key].lower <= value <= nonlinear[key].upper:
            low, high = nonlinear[key].lower, nonlinear[key].upper
            raise InputError(f"start: '{key}' is {value:g}; its bounds are {low:g} to {high:g}")
