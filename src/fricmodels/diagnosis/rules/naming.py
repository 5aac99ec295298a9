"""Which of the effects that pass is named, and with which look-alikes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fricmodels.diagnosis.rules.rule import Rules, rule


@dataclass(frozen=True)
class NamingRules(Rules):
    """Which of the effects that pass is named, and with which look-alikes."""

    parameter_price: float = rule(
        0.025,
        "relative residual",
        "Each further parameter must lower the residual by this share for an effect to come first.",
        "Judgement (Occam): half of least_gain.",
        off=0.0,
    )
    worse_over_all_motion: float = rule(
        2.0,
        "factor of the RMS torque left",
        "An effect is dropped if the model with it leaves so many times as much over all motion.",
        "Judgement: standstill is known roughly only, so that nothing less than a doubling counts.",
        off=math.inf,
    )
    sampling_leaves: float = rule(
        0.0003,
        "share of the RMS torque",
        "So much counts as left by every effect: less decides no order, and less than half its square is not sought.",
        "Found on our rig, with nothing hidden. Without it a clean drive takes 1.7 times the time and ends the same.",
        off=0.0,
    )
    alike_of_model: float = rule(
        0.02,
        "share of the residual",
        "A look-alike leaves more than the first effect by less than this share of what the model leaves.",
        "Judgement.",
        off=0.0,
    )
    alike_significance: float = rule(
        0.05,
        "probability",
        "Or if it is not worse at this level (Diebold and Mariano 1995).",
        "Statistic.",
        off=1.1,
    )
    far_worse: float = rule(
        1.5,
        "factor of the residual, or of the test error",
        "No effect with so many times the residual of the best one is a look-alike, passes over all motion only, "
        "stands in for one with which the test error does not fall, or is fitted as a simpler one in its place. Nor is "
        "one a look-alike that leaves so many times the test error, fitted beside all others, or of noise.",
        "Judgement: with little data no test tells even such a difference. Where every simpler effect is fitted, "
        "the ladder of `fricmodels demo` takes a quarter more time and ends the same.",
        off=math.inf,
    )
    contained: float = rule(
        0.01,
        "squared share",
        "An effect with more parameters is no look-alike if less than this share of the first lies outside of it.",
        "Judgement.",
        off=0.0,
    )
