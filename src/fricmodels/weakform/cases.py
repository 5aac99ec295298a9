"""How the motor torque runs between samples: it goes on, is held, or is shifted in time; one fit for each case."""

from __future__ import annotations

import numpy as np

from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.solve import STRONG, Solved, solve

_UNLIKELY = 1e-4
"""A choice of nuisances that is less probable than this is not reckoned with."""


def with_or_without_shift(found: Solved, plan: Plan) -> Solved:
    """Fit without a shift in time, with that of a held torque, and with any small one; return the one to be taken.

    A torque goes on between samples or is held, as controllers do; both are equally probable before anything is known,
    and standard errors are over all cases, each as probable as it is. What is taken for the estimate has to have strong
    evidence if it is a shift, that of a held torque too: chance would shift every second recording that says nothing.
    Where the rows are at a velocity that the fit predicts, that velocity has already told whether the torque is held.
    """
    shifted = found.with_shift if plan == found.again else found.once_more(plan, timing=True)
    odds = [0.0, shifted.log_odds_of_a_shift()]
    if _may_be_held(shifted):
        odds.append(shifted.log_odds_of_held())
    fixed = 2 if len(odds) > 2 and found.feedback is None and odds[2] > STRONG else 0
    chosen = 1 if odds[1] - odds[fixed] > STRONG else fixed
    weights = np.exp(np.array(odds) - max(odds))
    weights /= weights.sum()

    def fit(case: int) -> Solved:
        if case == 1:
            return shifted
        if case == 0:
            return found.once_more(plan, timing=False)
        return solve(found.problem.at(held=True), plan, timing=False)

    reckoned = [case for case, w in enumerate(weights.tolist()) if w > _UNLIKELY and case != chosen]
    others = [(fit(case).changed(feedback=found.feedback), float(weights[case])) for case in reckoned]
    return fit(chosen).changed(feedback=found.feedback, others=tuple(others))


def as_held(found: Solved) -> Solved | None:
    """Return the fit with a held torque, if there is strong evidence for that and against any other shift.

    There is none for a shift that is nearer to none than to half a sample: with the least variances that instants may
    have the odds are ln 5 at most.
    """
    nearer_to_none = found.shift < 0.25 * found.problem.recording.interval
    if nearer_to_none or not _may_be_held(found) or found.log_odds_of_held(reversals=False) <= STRONG:
        return None
    if found.log_odds_of_a_shift(reversals=False, than=0.5) > STRONG:
        return None
    return solve(found.problem.at(held=True), found.plan)


def _may_be_held(found: Solved) -> bool:
    """Whether a held torque is a case of its own: not yet known, and not one of a delay that the model has."""
    return not found.problem.held and "motor_torque_rate" not in found.problem.drive.model.needs
