"""What speaks against a listed effect that comes near to what a model leaves, and was not named."""

from __future__ import annotations

from collections.abc import Collection

from fricmodels.diagnosis.basis_functions import STRETCH, STRETCH_ALONG
from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.own_channel import may_be_of


def contradiction(comparison: Comparison, candidate: CandidateTest, channel: str, refuted: Collection[str] = ()) -> str:
    """Return in words what speaks against an effect; empty where nothing is known to.

    Args:
        comparison: the model without it.
        candidate: the effect, as it explains most.
        channel: what predicts the residual, in words; empty where nothing does.
        refuted: names of effects that the rows show and all motion does not.
    """
    if candidate.name in refuted:
        return "over all motion, reversals included, a channel predicts clearly more"
    effect = candidate.effect
    delays = [p.symbol for p in effect.parameters if p.delay]
    if delays and _is_not_to_be_shifted(comparison):
        return "the log check says not to shift the torque"
    if candidate.found.at_search_bound:
        return "it explains most at the end of what was sought"
    if channel in (STRETCH, STRETCH_ALONG) and any(p.periodic for p in effect.parameters):
        return "it has waves all over the way, and what remains lies in one stretch"
    if not may_be_of(comparison.problem, effect, channel):
        return f"it is no function of the {channel.partition(',')[0]}"
    return ""


def _is_not_to_be_shifted(comparison: Comparison) -> bool:
    findings = comparison.train.provenance.get("findings", ())
    return any(one["kind"] == "torque-delay" and "do not shift" in one["remedy"] for one in findings)
