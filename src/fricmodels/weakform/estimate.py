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

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.results.words import MORE_MOTION, is_combined, stretches_of_motion
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.signals.rest import once
from fricmodels.weakform.acting import acting
from fricmodels.weakform.friction_limits import limits_of_friction
from fricmodels.weakform.identification import FAR_WORSE, identified
from fricmodels.weakform.inference import is_contradicted
from fricmodels.weakform.kept_back_instants import told_by_kept_back
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.model_velocity import at_model_velocity
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.reversals import clear_of_reversals
from fricmodels.weakform.ripple import carriers_of
from fricmodels.weakform.sharpened import at_sharpened_velocity
from fricmodels.weakform.solve import WITHIN, Solved, begins_where, solve
from fricmodels.weakform.starting import starts_of
from fricmodels.weakform.without_motion import refuse_without_motion

Array = NDArray[np.float64]

_FAR_LESS = 0.1
"""Share of what a fit to all motion gains over the whole recording that it may lose in the rows of certain motion: it
was 0.4 % where one was refused. Of twelve sines with a Stribeck friction three have no name if it may lose nothing."""
_PERIODS = 4.0
"""Periods in the travel from which on a wave is no gain. A cart that was recorded on one period was explained down to
0.0 % by waves times its recorded torque; the drives that need the recorded one passed 12 to 143."""
_WELL = 0.1
"""Standard error of a parameter that is known well, as a share of it: with all of them so, no second fit is made."""
_ROWS = 4
"""Rows for each parameter that a fit needs more of."""
_CLEARLY = 1e-4
"""Share by which a new scan must leave less than the fit that began from an earlier one: less is no reason to go where
parameters stand for each other in another way."""
_STAGES = 3
"""Fits in which the motor torque of a column is the one that the last fit explains, and the record at its delay."""


@dataclass(frozen=True)
class Estimate:
    """Parameters of a model by key, the inertia among them, with standard errors.

    Attributes:
        parameters, standard_errors: by key; what was given has no standard error.
        covariance: of what was estimated, in the order of :attr:`standard_errors`; ``None`` where only those are known.
        not_identified: key → reason, of what the recording does not determine.
        shift: time [s] by which motion was recorded after the torque, as far as the fit saw it; not of a delay.
        residual_percent: RMS of what is left of the rows, of the RMS driving torque in the rows.
        message: why the fit did not end well; empty where it did.
        told_by_kept_back: keys of instants that lie in data kept back, see :mod:`.kept_back_instants`.
    """

    parameters: Mapping[str, float]
    standard_errors: Mapping[str, float]
    covariance: Array | None = field(default=None, compare=False)
    not_identified: Mapping[str, str] = field(default_factory=dict)
    shift: float = 0.0
    residual_percent: float = float("nan")
    message: str = ""
    told_by_kept_back: tuple[str, ...] = ()

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
    told = told_by_kept_back(drive, recording, found.parameters)
    if told:
        found = replace(found, parameters={**found.parameters, **told}, told_by_kept_back=tuple(told))
        rows = replace(rows, estimated=dict(found.parameters))
    if model_velocity:
        _known_fits(recording)[_asked(drive, start, width)] = _Fit(ref(rows), dict(rows.made_for), rows.shift, found)
    return rows, found


def clear_stretches(drive: Drive, recording: Recording) -> tuple[int, int]:
    """Return in how many stretches a prepared recording moves clearly, and how many a fit of a drive asks for."""
    rows = WeakFormProblem.of(drive, recording, _guess(drive, recording, {}), guessed=True).rows
    return rows, _ROWS * len(drive.parameters) + 1


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
    fits = [_begun_at(drive, recording, begin, width, model_velocity=model_velocity) for begin in starts]
    return fits[0] if len(fits) == 1 else min(fits, key=lambda fit: _left(drive, recording, fit[1].parameters))


def _begun_at(
    drive: Drive, recording: Recording, start: Mapping[str, float], width: int | None, *, model_velocity: bool
) -> tuple[WeakFormProblem, Estimate]:
    """Return the fit that begins from some nonlinear parameters."""

    def left(found: Solved) -> float:
        return _left(drive, recording, found.parameters)

    first = WeakFormProblem.of(drive, recording, _guess(drive, recording, start), width, guessed=True)
    carriers = carriers_of(first, start)
    found = _solved(first.carrying(carriers), start)
    # Once the friction is known, so is where the drive may stick at a reversal.
    plain = WeakFormProblem.of(drive, recording, found.parameters, width, like=first)
    if plain.rows <= _ROWS * len(drive.parameters):
        plain = first  # a friction with which the drive would hardly have moved is not known yet
    plain = plain.at(shift=_known(found))
    problem = plain.carrying(carriers)
    found = _solved(problem, start, found)
    if drive.model.delay or _explains_torque_by_itself(problem, found.parameters):
        for _ in range(_STAGES):
            if drive.model.delay:
                plain = WeakFormProblem.of(drive, recording, found.parameters, width)
            problem = replace(plain, estimated=found.parameters).carrying(carriers)
            found = _solved(problem, {**start, **found.parameters})
    whole = None  # the fit to all rows, where there may be one to a part of them
    by_recording = bool(drive.model.states or drive.model.delay)
    if by_recording:
        # A memory or a delay has most to say where it is not certain how the drive moved; that may mislead it, too.
        other = _solved(problem.including_uncertain_motion, {**start, **found.parameters})
        found = min(found, other, key=left)
        if drive.model.states:
            found = at_sharpened_velocity(found)
    elif model_velocity:
        whole = at_model_velocity(found, widen=width is None)
        if whole.problem.smooth is problem.smooth:
            whole = at_sharpened_velocity(whole)
        found = clear_of_reversals(whole, left)
    # What the whole recording has chosen it may also hold.
    final = identified(found, left if by_recording else None)
    if model_velocity and final.plan.held and not by_recording:
        # With less to find, the rows clear of reversals may say more than all of them.
        held = final.changed(free=None, others=())
        clear = clear_of_reversals(held, left)
        if clear is not held:
            final = identified(solve(clear.problem, found.plan, timing=found.timing))
    if whole is not None and final.problem is not whole.problem and left(final) > FAR_WORSE * left(whole):
        final = identified(whole)
    if not by_recording and _may_be_extrapolated(drive, final):
        final = _whatever_the_direction(final, problem, start, left)
    limits = limits_of_friction(drive, plain.recording, final.parameters)
    rows = replace(plain, friction_limits=limits, estimated=dict(final.parameters), shift=_known(final))
    return rows, Estimate(
        final.parameters,
        final.standard_errors,
        final.covariance,
        final.not_identified,
        final.shift,
        final.residual_percent,
        final.message,
    )


def _may_be_extrapolated(drive: Drive, final: Solved) -> bool:
    """Whether some part of the torque may act at low speed alone, as none of a linear law does, and is not known well.

    With parameters that are all known to a tenth no fit to other rows is worth its time.
    """
    if not drive.model.effects and all(p.linear for p in drive.parameters):
        return False
    return any(error > _WELL * abs(final.parameters[key]) for key, error in final.standard_errors.items())


def _whatever_the_direction(
    final: Solved, problem: WeakFormProblem, start: Mapping[str, float], left: Callable[[Solved], float]
) -> Solved:
    """Return the fit to all motion in the place of one that the whole recording contradicts.

    Where it is not certain how a drive moved, a row may have an error that no equation has. But a friction that falls
    with speed acts there most, and without these rows it is extrapolated. The fit to all motion is taken where the
    other leaves more of the whole recording than chance explains, and it leaves no more of the certain rows than chance
    does (F tests). It is made only where some parameter is not known well.

    Args:
        final: the fit to rows whose direction is certain.
        problem: these rows, at the smoothed velocity.
        start: nonlinear parameters to begin from.
        left: sum of squares that a fit leaves of the whole recording.
    """

    def too_much(left: float, by_another: float) -> bool:
        more = left / by_another - 1.0 if by_another > 0.0 else math.inf
        return left > by_another and is_contradicted(more, len(final.values), final.problem.independent)

    every = problem.including_uncertain_motion
    if every.rows == problem.rows:
        return final
    again, scanned = (_solved(every, begin) for begin in ({**start, **final.parameters}, start))
    other = scanned if scanned.solution.cost < (1.0 - _CLEARLY) * again.solution.cost else again
    everywhere, certain = (left(final), left(other)), (final.solution.cost, final.left_by(other.values))
    if not too_much(*everywhere):
        return final
    gained = (everywhere[0] - everywhere[1]) / float(np.sum(problem.recording.driving_torque**2))
    lost = (certain[1] - certain[0]) / float(np.sum(acting(problem) ** 2))
    return final if too_much(certain[1], certain[0]) and lost > _FAR_LESS * gained else identified(other, left)


def _explains_torque_by_itself(problem: WeakFormProblem, parameters: Mapping[str, float]) -> bool:
    """Whether an effect goes with the motor torque, as a gain does: the recorded one it could explain by itself.

    A law whose friction goes with the load takes the recorded torque: what a fit explains of it is less true at
    reversals, where the acceleration jumps. So does a wave over position times the torque, τ·cos kq: noise n of the
    torque has no part in it, since n²·cos kq averages out. What a fit explains of the torque lacks what a controller
    does against the wave itself, and that times the wave does not average out: on rough drives K_v and K_c were off by
    up to 20 standard errors (`benchmarks/effect_coverage.py --effects torque-ripple`). But a wave of few periods in the
    travel is nearly a gain, and does not average out.
    """
    drive = problem.drive
    if not drive.model.effects or "motor_torque" in Model(drive.model.law).needs:
        return False
    for effect in drive.model.effects:
        if "motor_torque" not in Model(drive.model.law, [effect]).needs:
            continue
        waves = [parameters[f"{effect.name}.{p.symbol}"] for p in effect.parameters if p.periodic]
        if not waves or min(waves) * np.ptp(problem.recording["position"]) < 2.0 * np.pi * _PERIODS:
            return True
    return False


def _solved(problem: WeakFormProblem, start: Mapping[str, float], found: Solved | None = None) -> Solved:
    """Return the fit to the rows of a problem.

    Args:
        problem: drive and rows.
        start: nonlinear parameters to begin from; those not given are scanned.
        found: an earlier fit to other rows. A scan of these rows may know better where to begin.
    """
    drive = problem.drive
    if problem.rows <= _ROWS * len(drive.parameters):
        raise InputError(
            f"recording '{problem.recording.name}' moves too little: {stretches_of_motion(problem.rows)}, where "
            f"{len(drive.parameters)} parameters ask for {_ROWS * len(drive.parameters) + 1}; {MORE_MOTION}"
        )
    nonlinear = {p.key for p in drive.parameters if not p.linear}

    def known(begin: Mapping[str, float]) -> dict[str, float]:
        return {key: value for key, value in begin.items() if key in nonlinear}

    def fit(begin: Mapping[str, float], nearly: bool = False) -> Solved:
        return solve(problem, Plan(start=known(begin), nearly=nearly))

    if found is None:
        return fit(start)
    again = fit({**start, **found.parameters}, nearly=True)
    if drive.model.states or nonlinear <= set(start):
        return again
    before = found.problem
    same = before.bumps is problem.bumps and before.quadrature is problem.quadrature and before.shift == problem.shift
    if not same and begins_where(problem, Plan(start=known(start)), found):
        return again  # these rows would begin where the others did, and have come from there
    scanned = replace(found, problem=problem) if same else fit(start)
    return scanned if scanned.solution.cost < (1.0 - _CLEARLY) * again.solution.cost else again


def _known(found: Solved) -> float:
    """Return the shift in time [s] that a fit has seen; none where it is at its bound, and of unknown size."""
    within = abs(found.shift) < WITHIN * found.problem.recording.interval
    return found.shift if within else 0.0


def _left(drive: Drive, recording: Recording, parameters: Mapping[str, float]) -> float:
    """Return the sum of squares that a model leaves over all of a recording."""
    error = filtered_torque_error(drive, parameters, recording, sliding_half_width(recording))
    return float(error @ error)


def _guess(drive: Drive, recording: Recording, start: Mapping[str, float]) -> dict[str, float]:
    """Return parameters good enough to choose the width of the test functions: only the inertia matters."""
    values = {p.key: start.get(p.key, p.declared.initial) for p in drive.model.parameters}
    if drive.inertia is None:
        values[drive.inertia_key] = _rough_inertia(recording)
    return values


@once
def _rough_inertia(recording: Recording) -> float:
    """Return the inertia that goes with a coarse acceleration beside Coulomb and viscous friction."""
    acceleration = np.gradient(recording.velocity, recording.time)
    coarse = np.convolve(acceleration, np.ones(9) / 9, "same")
    force = np.convolve(recording.driving_torque, np.ones(9) / 9, "same")
    base = np.array([coarse, np.sign(recording.velocity), recording.velocity])
    return max(float(NormalEquations.of(base @ base.T, base @ force).solved[0]), 1e-12)
