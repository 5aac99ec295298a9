"""What the fits of a model with an effect more say to what the rows name: which is left, and which comes beside it.

The rows say whether an effect is there; whether it is missing says the test error of the model that is fitted with it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.diagnosis.candidate_tests import CandidateTests
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.floor import is_far_above_noise
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.refits import Refits, falls_from
from fricmodels.diagnosis.supported import Judgement, judge
from fricmodels.diagnosis.verdict import LookAlikes, passing_all_gates, select_effect


def that_can_be_fitted(refits: Refits, result: CandidateTests) -> CandidateTests:
    """Return the tests without those that explain the rows best and cannot be fitted, see :class:`Refits`.

    Of these the form is not known; whether one that explains the rows nearly as well is there is asked next. One that
    explains far less has another form, and does not come in their place.
    """
    possible, most, trials = result, float("inf"), result.policy.step_trials
    while (best := select_effect(possible)) is not None and np.sum(best.first.evidence.loss) <= most:
        tried = {t.name: t for t in best.members[:trials]}
        if any(refits.with_effect(t) is not None for t in tried.values()):
            return possible
        most = min(most, result.policy.far_worse**2 * float(np.sum(best.first.evidence.loss)))
        possible = replace(possible, tested=tuple(t for t in possible.tested if t.name not in tried))
    return result


def most_of_the_error(refits: Refits, judgement: Judgement) -> list[LookAlikes]:
    """Return the effect that only lacks its share in the rows, if it takes away that share of the printed test error.

    What noise leaves of that is not counted.
    """
    found = judgement.unsure_of_its_share(refits.policy)
    fitted = None if found is None else refits.with_effect(found.first)
    if found is None or fitted is None:
        return []
    before, after = (c.errors.held_out_percent**2 for c in (refits.comparison, fitted))
    above = before - refits.comparison.errors.headline.noise_floor_percent**2
    return [found] if before - after >= refits.policy.own_share * above > 0.0 else []


def all_of_the_error(refits: Refits, judgement: Judgement) -> list[LookAlikes]:
    """Return the effect of a set with which nothing is left of a printed test error that was far above noise.

    The rows judge an effect beside a fitted model to first order. Where that has the wrong values without the effect,
    as a resonance has beside another inertia, a channel predicts more in its place; with the effect fitted nothing is
    left that any could predict. Nothing is what would be no gain, see ``least_gain``. What explains less than its share
    to first order is not tried, nor what a channel outpredicts that it is no function of: no fit makes it one.
    """
    policy, before = refits.policy, refits.comparison
    if not is_far_above_noise(before, policy):
        return []
    possible = [found for found, support in judgement.members if not support.by_another_signal]
    large = [found for found in possible if found.first.evidence.explained >= policy.own_share]
    tried = [found for found in large if found.first.once < policy.significance_once]
    fitted = [(found, refits.with_effect(found.first)) for found in tried[: policy.step_trials]]
    there = [found for found, after in fitted if after is not None and _nothing_is_left(before, after, policy)]
    return [min(there, key=lambda found: refits.test_error(found.first))] if there else []


def _nothing_is_left(before: Comparison, after: Comparison, policy: Policy) -> bool:
    """Whether a fit takes away nearly all of the printed errors above noise, where they were fitted and where not."""
    one, two = before.errors.headline, after.errors.headline
    parts = (
        (one.percent, two.percent, one.fit_noise_percent**2),
        (one.held_out_percent, two.held_out_percent, one.noise_floor_percent**2),
    )
    return all(left**2 - noise <= policy.least_gain * (whole**2 - noise) for whole, left, noise in parts)


def confirmed(
    refits: Refits,
    found: LookAlikes | None,
    result: CandidateTests,
    leave_out: set[str],
    together: list[LookAlikes],
) -> LookAlikes | None:
    """Return what was found if the test error falls with it, or else another effect with which it falls furthest.

    Of several that are there ``together`` the first may be nothing by itself, as it stands for the others too; then
    another one of them comes first. Else it is one that passes by itself. Nothing is said to be missing that does not
    lower the error on data that took no part in finding it, nor what has another form than that, or explains far less
    of the rows than what was found.
    """
    if found is None or refits.lowers_test_error(found.first):
        return found
    there = [one for one in together if one.first.name not in found.names and refits.lowers_test_error(one.first)]
    if there:
        return min(there, key=lambda one: refits.test_error(one.first))
    most = result.policy.far_worse**2 * float(np.sum(found.first.evidence.loss))
    near = [t for t in passing_all_gates(result) if t.name != found.first.name and np.sum(t.evidence.loss) <= most]
    others = [t for t in near if t.once < result.policy.significance_once][: result.policy.step_trials - 1]
    helpful = [t for t in others if refits.lowers_test_error(t)]
    for tested in sorted(helpful, key=refits.test_error):
        best = LookAlikes(tested, (tested,))
        if not judge(result, leave_out, best).contradicts(best.first, result.policy):
            return best
    return None


def all_together(refits: Refits, first: LookAlikes, together: list[LookAlikes]) -> list[LookAlikes]:
    """Return the first effect, and the others that are there beside it if the test error falls further with them."""
    others = [one for one in together if one.first.name not in first.names]
    there = any({*one.names} <= {*first.names} for one in together)
    further = refits.beside(first.first) if others and there else None
    found = [first]
    for other in others:
        if further is not None and further.lowers_test_error(other.first):
            further = further.beside(other.first)
            found.append(other)
    return found


def as_a_whole(refits: Refits, together: list[LookAlikes]) -> list[LookAlikes]:
    """Return effects that are there together if the test error falls with all of them, though it does with none alone.

    Each is added where the fit error falls most with it: by itself it may stand for others, and fit nothing.
    """
    here, found, left = refits, list[LookAlikes](), [*together]
    while left:
        errors = {i: here.fit_error(one.first) for i, one in enumerate(left)}
        best = left.pop(min(errors, key=lambda i: errors[i]))
        further = here.beside(best.first)
        if further is None:
            break
        here, found = further, [*found, best]
    return found if len(found) > 1 and falls_from(refits.comparison, here.comparison, refits.policy) else []


def that_stay(refits: Refits, effects: list[LookAlikes]) -> list[LookAlikes]:
    """Return of effects that were named beside others what is missing without these: the test error falls with it."""
    first = next((one for one in effects if refits.lowers_test_error(one.first)), None)
    return as_a_whole(refits, effects) if first is None else all_together(refits, first, effects)
