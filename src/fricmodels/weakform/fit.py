"""One fit of a whole model to a recording, from one place to begin: steps 2 to 6 of :mod:`.estimate`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.results.words import MORE_MOTION, stretches_of_motion, without_gaps
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.signals.segments import stretches
from fricmodels.weakform.acting import acting
from fricmodels.weakform.friction_limits import limits_of_friction
from fricmodels.weakform.identification import FAR_WORSE, identified
from fricmodels.weakform.inference import is_contradicted
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.model_velocity import at_model_velocity
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.reversals import clear_of_reversals
from fricmodels.weakform.ripple import carriers_of
from fricmodels.weakform.sharpened import at_sharpened_velocity
from fricmodels.weakform.solve import WITHIN, Solved, begins_where, solve

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


def clear_stretches(drive: Drive, recording: Recording) -> tuple[str, int, str] | None:
    """Return in how many stretches a prepared recording moves clearly, in words, how many a fit asks for, and how to
    get more; ``None`` where it has enough."""
    problem, asked = WeakFormProblem.of(drive, recording, _guess(drive, recording, {}), guessed=True), _asked(drive)
    return (_clear(problem), asked, _way_out(problem)) if problem.rows < asked else None


def _asked(drive: Drive) -> int:
    return _ROWS * len(drive.parameters) + 1


def _clear(problem: WeakFormProblem) -> str:
    return stretches_of_motion(problem.rows, problem.test_functions.width * problem.recording.interval)


def _way_out(problem: WeakFormProblem) -> str:
    """Return what would give more rows: a record without gaps, where most of this one lies in pieces too short for any.

    Else more motion. Blocks that are kept back are no gaps of the record.
    """
    origin = problem.recording.origin
    whole = problem.recording if origin is None else origin.whole
    lengths = np.array([piece.stop - piece.start for piece in stretches(whole.time, whole.run)])
    short = lengths[lengths < problem.test_functions.width]
    if 2 * short.sum() <= lengths.sum():
        return MORE_MOTION
    return without_gaps(int(short.max()), problem.test_functions.width)


@dataclass(frozen=True)
class Begun:
    """A fit from some nonlinear parameters, before what the recording does not determine is named.

    Attributes:
        recording: the whole of it.
        start: the nonlinear parameters that it began from.
        plain: rows at the smoothed velocity, without carriers. problem: these with them.
        found: the fit. whole: that to all rows, where there may be one to a part of them.
        model_velocity: whether friction may be evaluated at the velocity that the model predicts.
    """

    recording: Recording
    start: Mapping[str, float]
    plain: WeakFormProblem
    problem: WeakFormProblem
    found: Solved
    whole: Solved | None
    model_velocity: bool

    @cached_property
    def left(self) -> float:
        """Sum of squares that it leaves of the whole recording."""
        return left_of(self.recording, self.found)


def begun_at(
    drive: Drive, recording: Recording, start: Mapping[str, float], width: int | None, *, model_velocity: bool
) -> Begun:
    """Return the fit that begins from some nonlinear parameters."""
    left = partial(left_of, recording)
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
    return Begun(recording, start, plain, problem, found, whole, model_velocity)


def settled(begun: Begun) -> tuple[WeakFormProblem, Solved]:
    """Return the rows at the smoothed velocity without carriers, and the fit with what is not determined named."""
    drive, found, whole = begun.problem.drive, begun.found, begun.whole
    left = partial(left_of, begun.recording)
    by_recording = bool(drive.model.states or drive.model.delay)
    # What the whole recording has chosen it may also hold.
    final = identified(found, left if by_recording else None)
    if begun.model_velocity and final.plan.held and not by_recording:
        # With less to find, the rows clear of reversals may say more than all of them.
        held = final.changed(free=None, others=())
        clear = clear_of_reversals(held, left)
        if clear is not held:
            final = identified(solve(clear.problem, found.plan, timing=found.timing))
    if whole is not None and final.problem is not whole.problem and left(final) > FAR_WORSE * left(whole):
        final = identified(whole)
    if not by_recording and _may_be_extrapolated(drive, final):
        final = _whatever_the_direction(final, begun.problem, begun.start, left)
    limits = limits_of_friction(drive, begun.plain.recording, final.parameters)
    rows = replace(begun.plain, friction_limits=limits, estimated=dict(final.parameters), shift=_known(final))
    return rows, final


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
    if problem.rows < _asked(drive):
        raise InputError(
            f"recording '{problem.recording.name}' moves too little: {_clear(problem)}, where "
            f"{len(drive.parameters)} parameters ask for {_asked(drive)}; {_way_out(problem)}"
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
    same = before.test_functions is problem.test_functions and before.quadrature is problem.quadrature
    same = same and before.shift == problem.shift
    if not same and begins_where(problem, Plan(start=known(start)), found):
        return again  # these rows would begin where the others did, and have come from there
    scanned = replace(found, problem=problem) if same else fit(start)
    return scanned if scanned.solution.cost < (1.0 - _CLEARLY) * again.solution.cost else again


def _known(found: Solved) -> float:
    """Return the shift in time [s] that a fit has seen; none where it is at its bound, and of unknown size."""
    within = abs(found.shift) < WITHIN * found.problem.recording.interval
    return found.shift if within else 0.0


def left_of(recording: Recording, found: Solved) -> float:
    """Return the sum of squares that a fit leaves over all of a recording."""
    error = filtered_torque_error(found.problem.drive, found.parameters, recording, sliding_half_width(recording))
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
