"""How the motor torque runs between samples: it goes on, is held, or is shifted in time; one fit for each case."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.shift_evidence import (
    STRONG,
    log_odds_of_a_shift,
    log_odds_of_exact,
    log_odds_of_held,
    nearly_exact,
    nearly_unshifted,
)
from fricmodels.weakform.solve import Solved, solve

_EXACT, _NEARLY, _SHIFTED, _HELD = range(4)
"""Cases: instants that are exact, or true to a twentieth of a sample; shifted by up to a sample; a held torque."""
_UNLIKELY = 1e-4
"""A choice of nuisances that is less probable than this is not reckoned with."""


def with_or_without_shift(found: Solved, plan: Plan) -> Solved:
    """Fit with exact instants, with nearly exact ones, held, and with any small shift; return the one to be taken.

    A torque goes on between samples or is held, as controllers do, its instants are exact, true to a twentieth of a
    sample, or shifted; all are equally probable before anything is known, and standard errors are over all cases, each
    as probable as it is. What is taken for the estimate has to have strong evidence if it is less simple: chance would
    shift every second recording that says nothing. In a model with a delay torque and motion are shifted anyway: there
    the most probable case is taken. Where the rows are at a velocity that the fit predicts, that velocity has already
    told where in its interval the torque acts.
    """
    plan = replace(plan, shifts=())
    shifted = found.with_shift if plan == found.again else found.once_more(plan, timing=True)
    odds = [log_odds_of_exact(shifted), 0.0, log_odds_of_a_shift(shifted)]
    if _may_be_held(shifted):
        odds.append(log_odds_of_held(shifted))
    delayed = found.problem.drive.model.delay is not None
    chosen = int(np.argmax(odds)) if delayed else _simplest(odds, at_model_velocity=found.feedback is not None)
    weights = np.exp(np.array(odds) - max(odds))
    weights /= weights.sum()

    def fit(case: int) -> Solved:
        if case == _SHIFTED:
            return shifted
        if case == _NEARLY:
            return nearly_unshifted(shifted, plan)
        if case == _EXACT:
            return found.once_more(plan, timing=False)
        return solve(found.problem.at(held=True), plan, timing=False)

    taken = fit(chosen)
    others = []
    for case, weight in enumerate(weights.tolist()):
        if weight > _UNLIKELY and case != chosen:
            beside = chosen == _EXACT and case == _NEARLY
            other = nearly_exact(shifted, taken) if beside else fit(case)
            others.append((other.changed(feedback=found.feedback), weight))
    return taken.changed(feedback=found.feedback, others=tuple(others))


def _simplest(odds: list[float], *, at_model_velocity: bool) -> int:
    """Return the simplest case against which there is no strong evidence, by the logarithm of how probable each is."""
    chosen = _EXACT
    for case in (_SHIFTED,) if at_model_velocity else (_NEARLY, *range(_HELD, len(odds)), _SHIFTED):
        simpler = [_EXACT] if case == _NEARLY else [_EXACT, _NEARLY, chosen]
        chosen = case if odds[case] - max(odds[other] for other in simpler) > STRONG else chosen
    return chosen


def fitted_as_held(found: Solved) -> Solved | None:
    """Return the fit with a held torque, if there is strong evidence for that and against any other shift.

    There is none for a shift that is nearer to none than to half a sample: with the least variances that instants may
    have the odds are ln 5 at most.
    """
    nearer_to_none = found.shift < 0.25 * found.problem.recording.interval
    if nearer_to_none or not _may_be_held(found) or log_odds_of_held(found, reversals=False) <= STRONG:
        return None
    if log_odds_of_a_shift(found, reversals=False, than=0.5) > STRONG:
        return None
    return solve(found.problem.at(held=True), found.plan)


def _may_be_held(found: Solved) -> bool:
    """Whether a held torque is a case of its own: not yet known, and not one of a delay that the model has."""
    return not found.problem.held and "motor_torque_rate" not in found.problem.drive.model.needs
