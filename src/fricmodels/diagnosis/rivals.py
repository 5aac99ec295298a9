"""Whether something else predicts clearly more than an effect in its place: a description of the rest, or a channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.basis_functions import OF_TIME, OF_WAVES
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.effect_set import Gain, passing_beside, visible_of
from fricmodels.diagnosis.one_cause import credited, is_simpler, predicts_beside
from fricmodels.diagnosis.own_channel import may_be_of
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor
from fricmodels.diagnosis.verdict import LookAlikes
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


@dataclass(frozen=True)
class Outpredicted:
    """By how much something else predicts clearly more than an effect in its place.

    Attributes:
        ratio: least ratio of what the effect explains to what is explained in its place; infinite if nothing is better.
        by_another_signal: whether something is better that neither the effect nor a look-alike is a function of, and
            explains more, with no more terms, than the best channel of their own signals. Where the form of an effect
            that is there is a little wrong, a channel of its own signals explains as much.
    """

    ratio: float = float("inf")
    by_another_signal: bool = False

    def or_by(self, other: Outpredicted) -> Outpredicted:
        """Return this with what another one says besides."""
        return Outpredicted(min(self.ratio, other.ratio), self.by_another_signal or other.by_another_signal)


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
    result: CandidateTests, gain: Gain, found: LookAlikes, beside: Array, together: Array | None = None
) -> Outpredicted:
    """Return whether a channel predicts clearly more than an effect in its place.

    The past of the residual or of the torque is no such channel: it shows all that lasts, whatever its form. A
    channel beside which the effect still does most of what it does is another cause. Against an effect of the time
    itself, which happens once, other courses of time test the form: a comparison that was planned, not one of many.

    Args:
        result: the residual.
        gain: what the effect does beside the given columns.
        found: the effect with its look-alikes.
        beside: these columns, shape (k, rows).
        together: columns of the effect and of a description of the rest. Then only a channel counts that explains as
            much as both do, with fewer terms.
    """
    policy, first, least = result.policy, found.first, Outpredicted()
    planned = OF_TIME if first.effect.depends_on_time else ()
    passing = passing_beside(result, gain.without, as_rivals=True, planned=planned)
    channels = [p for p in passing if p.channels not in AUTOREGRESSIVE]
    own_best = min((p for p in channels if _may_be_of(result, found, p)), key=_left, default=None)
    for predictor in channels:
        own, theirs = credited(result, gain.before, gain.fall, gain.before - _left(predictor))
        if own >= theirs:
            continue
        is_other = not _may_be_of(result, found, predictor)
        here = Outpredicted(own / theirs, is_other and _is_simpler_and_better(predictor, own_best))
        if here.ratio >= least.ratio and here.by_another_signal <= least.by_another_signal:
            continue
        if together is not None and not is_simpler(result, gain.without, beside, together, predictor):
            continue
        both = gain.without.test(visible_of(gain.without, np.vstack([predictor.columns, gain.columns])))
        kept = _left(predictor) - float(np.sum(both.loss))
        if kept >= policy.kept * gain.fall:
            continue
        other = regression_of(result.problem, result.parameters, np.vstack([beside, predictor.columns]))
        instead = Instead(predictor.columns, frozenset({predictor.channels}), predictor.tried, predictor.terms)
        if is_better(result, first, gain, here.ratio, other, predictor.evidence.loss, instead):
            least = least.or_by(here)
    return least


def _left(predictor: ChannelPredictor) -> float:
    """Return the squared residual that a channel leaves."""
    return float(np.sum(predictor.evidence.loss))


def _may_be_of(result: CandidateTests, found: LookAlikes, predictor: ChannelPredictor) -> bool:
    """Whether an effect or one of its look-alikes may be a function of a channel."""
    return any(may_be_of(result.problem, tested.effect, predictor.channels) for tested in found.members)


def _is_simpler_and_better(one: ChannelPredictor, other: ChannelPredictor | None) -> bool:
    """Whether a channel explains more than another one with no more terms; not if there is no other one."""
    return other is not None and one.terms <= other.terms and _left(one) < _left(other)
