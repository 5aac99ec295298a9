"""Fits a whole model to a recording: the one engine of `batch`, `compare`, `diagnose` and `improve`.

1. A start for what is nonlinear in an effect: searched for in what the model without the effect leaves.
2. The rows of the weak form at a smoothed velocity; linear parameters by least squares within their bounds, the others
   by Gauss–Newton; once more with the friction known, which tells where the drive may stick at a reversal.
3. The same at the velocity that the fitted model itself predicts, where that is more certain than a smoothed one;
   else at the smoothed one with what smoothing took away given back.
4. Where the whole recording contradicts that, the fit to all motion, also where its direction is not certain.
5. With or without a shift in time, whichever is more probable; standard errors for autocorrelated residuals.
6. What the recording does not determine is named, and held where that costs nothing.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, replace
from weakref import ref

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.results.words import is_combined
from fricmodels.weakform.equations import equations
from fricmodels.weakform.fit import begun_at, settled
from fricmodels.weakform.friction_limits import limits_of_friction
from fricmodels.weakform.kept_back_instants import told_by_kept_back
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.solve import Solved
from fricmodels.weakform.starting import starts_of
from fricmodels.weakform.unclear import CERTAIN
from fricmodels.weakform.variable_projection import Projection
from fricmodels.weakform.without_motion import refuse_without_motion


@dataclass(frozen=True)
class Estimate:
    """Parameters of a model by key, the inertia among them, with standard errors.

    Attributes:
        parameters, standard_errors: by key; what was given, and a constant, has no standard error.
        covariance: of what was estimated, in the order of :attr:`standard_errors`; ``None`` where only those are known.
        not_identified: key → reason, of what the recording does not determine.
        shift: time [s] by which motion was recorded after the torque, as far as the fit saw it; not of a delay.
        residual_percent: RMS of what is left of the rows, of the RMS driving torque in the rows.
        message: why the fit did not end well; empty where it did.
        told_by_kept_back: keys of instants that lie in data kept back, see :mod:`.kept_back_instants`.
        beyond: what parameters at a bound would be without bounds, where that is certainly another value.
    """

    parameters: Mapping[str, float]
    standard_errors: Mapping[str, float]
    covariance: Array | None = field(default=None, compare=False)
    not_identified: Mapping[str, str] = field(default_factory=dict)
    shift: float = 0.0
    residual_percent: float = float("nan")
    message: str = ""
    told_by_kept_back: tuple[str, ...] = ()
    beyond: Mapping[str, float] = field(default_factory=dict)

    @property
    def own_errors(self) -> dict[str, float]:
        """Standard errors as they are shown: 0, which is not known, of what is determined only in a combination."""
        errors, reasons = self.standard_errors, self.not_identified
        return {key: 0.0 if is_combined(reasons.get(key, "")) else error for key, error in errors.items()}


def estimate(
    drive: Drive,
    recording: Recording,
    start: Mapping[str, float] | None = None,
    *,
    width: int | None = None,
    model_velocity: bool = True,
) -> tuple[WeakFormProblem, Estimate]:
    """Fit a drive to a recording in weak form.

    Args:
        drive: model and inertia, ``None`` to estimate it.
        recording: with ``velocity``.
        start: values of nonlinear parameters to begin from; those not given are searched for.
        width: samples that a test function spans; as the noise asks for if not given.
        model_velocity: whether friction may be evaluated at the velocity that the model predicts.

    Returns:
        The rows at the smoothed velocity without carriers, on which candidates are tested, and the estimate.

    Raises:
        InputError: when the recording moves too little to fit the model, has a torque that friction explains without
            any motion, or lacks a channel that the model needs.
    """
    recording.require(drive.model.required - {"velocity", "acceleration"}, drive.model.name)
    rows, found = _estimated(drive, recording, start or {}, width, model_velocity=model_velocity)
    refuse_without_motion(drive, rows.recording, found.parameters, found.residual_percent)
    told = told_by_kept_back(drive, recording, found.parameters, found.standard_errors)
    if told:
        found = replace(found, parameters={**found.parameters, **told}, told_by_kept_back=tuple(told))
        rows = replace(rows, estimated=dict(found.parameters))
    if model_velocity:
        _known_fits(recording)[_asked(drive, start, width)] = _Fit(ref(rows), dict(rows.made_for), rows.shift, found)
    return rows, found


def rows_again(
    drive: Drive,
    recording: Recording,
    made_for: Mapping[str, float],
    found: Estimate,
    shift: float,
    width: int | None = None,
) -> WeakFormProblem:
    """Return the rows of an earlier :func:`estimate`, made anew.

    Args:
        drive, recording, width: as there.
        made_for, shift: of those rows.
        found: the estimate.
    """
    made = WeakFormProblem.of(drive, recording, made_for, width)
    limits = limits_of_friction(drive, made.recording, found.parameters)
    return replace(made, friction_limits=limits, estimated=dict(found.parameters), shift=shift)


@dataclass(frozen=True)
class _Fit:
    """A fit that was made: its rows, as long as another one keeps them, what they were made for, and the estimate."""

    rows: ref[WeakFormProblem]
    made_for: Mapping[str, float]
    shift: float
    found: Estimate


@once
def _known_fits(_: Recording) -> dict[Hashable, _Fit]:
    return {}


def _asked(drive: Drive, start: Mapping[str, float] | None, width: int | None) -> Hashable:
    return drive.model, drive.inertia, drive.motion, tuple(sorted((start or {}).items())), width


def _of_smaller(
    drive: Drive, recording: Recording, start: Mapping[str, float], width: int | None
) -> tuple[WeakFormProblem, Estimate]:
    """Return the estimate of a model without one of the effects; a ladder has mostly been there before."""
    fit = _known_fits(recording).get(_asked(drive, start, width))
    if fit is None:
        return estimate(drive, recording, start, width=width)
    rows = fit.rows()
    if rows is None:
        rows = rows_again(drive, recording, fit.made_for, fit.found, fit.shift, width)
    return rows, fit.found


def _estimated(
    drive: Drive, recording: Recording, start: Mapping[str, float], width: int | None, *, model_velocity: bool
) -> tuple[WeakFormProblem, Estimate]:
    """Return :func:`estimate`, which keeps what was found; of several places to begin from, what leaves least."""

    def fit(smaller: Drive, width: int | None) -> tuple[WeakFormProblem, Mapping[str, float]]:
        rows, found = _of_smaller(smaller, recording, start, width)
        return rows, found.parameters

    starts = starts_of(drive, start, fit)
    fits = [begun_at(drive, recording, begin, width, model_velocity=model_velocity) for begin in starts]
    rows, final = settled(fits[0] if len(fits) == 1 else min(fits, key=lambda begun: begun.left))
    free = [i for i, p in enumerate(drive.parameters) if not p.declared.constant]
    keys = [drive.keys[i] for i in free]
    return rows, Estimate(
        final.parameters,
        {key: final.standard_errors[key] for key in keys},
        final.covariance[np.ix_(free, free)],
        {key: reason for key, reason in final.not_identified.items() if key in keys},
        final.shift,
        final.residual_percent,
        final.message,
        beyond={key: value for key, value in _beyond_bounds(final).items() if key in keys},
    )


def _beyond_bounds(final: Solved) -> dict[str, float]:
    """Return what parameters at a bound would be without bounds, by key, if more than three standard errors from it.

    Of those that are linear, in the rows of the fit, which was made with the bounds.
    """
    linear = [p for p in final.problem.drive.parameters if p.linear]
    at_bound = [p for p in linear if final.parameters[p.key] in (p.declared.lower, p.declared.upper)]
    at_bound = [p for p in at_bound if p.declared.lower < p.declared.upper]
    if not at_bound:
        return {}
    rows = equations(final.problem, timing=final.timing)
    free = Projection(rows, np.zeros((0, len(linear))), np.zeros(0)).at(final.solution.alpha).theta
    found = {p.key: float(free[linear.index(p)]) for p in at_bound}
    errors = final.standard_errors
    return {k: v for k, v in found.items() if abs(v - final.parameters[k]) > CERTAIN * errors[k] > 0.0}
