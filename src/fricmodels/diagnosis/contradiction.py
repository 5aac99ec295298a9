"""What speaks against a listed effect that comes near to what a model leaves, and was not named."""

from __future__ import annotations

from fricmodels.diagnosis.basis_functions import STRETCH, STRETCH_ALONG
from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.recording import OTHER

_TORQUES = frozenset({"motor_torque", "load_torque"})
"""A load is in the motor torque as well: what goes with one of them goes with the other."""
_SIGNALS = {
    "position": frozenset({"position"}),
    "acceleration": frozenset({"acceleration"}),
    "temperature": frozenset({"temperature"}),
    "time": frozenset({"time"}),
    "motor torque": _TORQUES,
    "load torque": _TORQUES,
}
"""Channel in words → signals of effects that are functions of it. Every effect is one of the speed, or has its sign."""


def contradiction(comparison: Comparison, candidate: CandidateTest, channel: str) -> str:
    """Return in words what speaks against an effect; empty where nothing is known to.

    Args:
        comparison: the model without it.
        candidate: the effect, as it explains most.
        channel: what predicts the residual, in words; empty where nothing does.
    """
    effect = candidate.effect
    delays = [p.symbol for p in effect.parameters if p.delay]
    if delays and _is_not_to_be_shifted(comparison):
        return "the log check says not to shift the torque"
    if candidate.found.at_search_bound:
        return "it explains most at the end of what was sought"
    if channel in (STRETCH, STRETCH_ALONG) and any(p.periodic for p in effect.parameters):
        return "it has waves all over the way, and what remains lies in one stretch"
    model = comparison.problem.alone(effect).model
    wanted = _signals(comparison, channel)
    if wanted and not model.states and not delays and not wanted & {*model.needs, *effect.channels}:
        return f"it is no function of the {channel.partition(',')[0]}"
    return ""


def _signals(comparison: Comparison, channel: str) -> frozenset[str]:
    """Return the signals that a channel in words stands for; none of a history, of the speed, or of several."""
    name = channel.partition(",")[0]
    further = {known.removeprefix(OTHER).replace("_", " "): known for known in comparison.train.channels}
    return _SIGNALS.get(name, frozenset({further[name]} if further.get(name, "").startswith(OTHER) else ()))


def _is_not_to_be_shifted(comparison: Comparison) -> bool:
    findings = comparison.train.provenance.get("findings", ())
    return any(one["kind"] == "torque-delay" and "do not shift" in one["remedy"] for one in findings)
