"""Whether something else predicts clearly more than an effect in its place: a description of the rest, or a channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.basis_functions import OF_TIME, OF_WAVES
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.effect_set import Gain, passing_beside, visible_of
from fricmodels.diagnosis.one_cause import credited, is_simpler, predicts_beside
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of


@dataclass(frozen=True)
class Instead:
    """What may be in the place of an effect.

    Attributes:
        columns: shape (k, rows); none where nothing is.
        channels: names of the channels that they are of.
        tried: number of predictors among which these were chosen.
        terms: number of their coefficients, and of what was sought beside these.
    """

    columns: Array
    channels: frozenset[str]
    tried: int
    terms: int


def is_better(
    result: CandidateTests,
    effect: CandidateTest,
    gain: Gain,
    ratio: float,
    other: Regression,
    loss: Array,
    instead: Instead,
) -> bool:
    """Whether what is in the place of an effect predicts clearly more than it.

    It does if it has no more terms: of two such forms the one that explains more is the better one, and no chance is to
    be allowed for. Otherwise it does if the errors, compared as those of two forecasts, say so (Diebold and Mariano
    1995). It also does if it predicts what the effect leaves, and the effect nothing of what it leaves, or next to
    nothing beside that (Chong and Hendry 1986): where an effect lies within what a channel can be, that is the test of
    its form, of which the errors tell little. Not so of waves at numbers that were sought: of several in one channel
    one may be the effect's, and the next another cause's.

    Args:
        result: the residual.
        effect: with its nonlinear parameters, each of which is a term.
        gain: what the effect does.
        ratio: of what it explains to what is explained in its place.
        other: the regression with that in its place.
        loss: its squared residuals, shape (rows,).
        instead: what is in its place.
    """
    policy = result.policy
    if instead.terms <= len(effect.found.columns) + len(effect.found.nonlinear):
        return True
    _, p_more = compare(gain.regression.loss, loss, gain.without.terms)
    if p_more * instead.tried <= policy.outpredicted_significance:
        return True
    if ratio >= policy.of_channel or instead.channels & OF_WAVES:
        return False
    if not predicts_beside(result, gain.regression, instead.columns, instead.tried, policy.form_significance):
        return False
    if not predicts_beside(result, other, gain.columns):
        return True
    both = float(np.sum(other.test(visible_of(other, gain.columns)).loss))
    added, own = float(np.sum(gain.regression.loss)) - both, float(np.sum(loss)) - both
    return own <= (1.0 - policy.of_channel) * added


def against_channels(
    result: CandidateTests, gain: Gain, first: CandidateTest, beside: Array, together: Array | None = None
) -> float:
    """Return the least ratio of what an effect explains to what a channel explains that predicts clearly more.

    The past of the residual or of the torque is no such channel: it shows all that lasts, whatever its form. A
    channel beside which the effect still does most of what it does is another cause. Against an effect of the time
    itself, which happens once, other courses of time test the form: a comparison that was planned, not one of many.

    Args:
        result: the residual.
        gain: what the effect does beside the given columns.
        first: the effect.
        beside: these columns, shape (k, rows).
        together: columns of the effect and of a description of the rest. Then only a channel counts that explains as
            much as both do, with fewer terms.
    """
    policy, least = result.policy, float("inf")
    planned = OF_TIME if first.effect.depends_on_time else ()
    for predictor in passing_beside(result, gain.without, as_rivals=True, planned=planned):
        if predictor.channels in AUTOREGRESSIVE:
            continue
        own, theirs = credited(result, gain.before, gain.fall, gain.before - float(np.sum(predictor.evidence.loss)))
        if own >= theirs:
            continue
        if together is not None and not is_simpler(result, gain.without, beside, together, predictor):
            continue
        both = gain.without.test(visible_of(gain.without, np.vstack([predictor.columns, gain.columns])))
        kept = float(np.sum(predictor.evidence.loss)) - float(np.sum(both.loss))
        if kept >= policy.kept * gain.fall or own / theirs >= least:
            continue
        other = regression_of(result.problem, result.parameters, np.vstack([beside, predictor.columns]))
        channels = frozenset({predictor.channels})
        instead = Instead(predictor.columns, channels, predictor.tried, predictor.terms)
        if is_better(result, first, gain, own / theirs, other, predictor.evidence.loss, instead):
            least = own / theirs
    return least
