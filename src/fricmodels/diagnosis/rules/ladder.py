"""Which effects a ladder adds, removes and exchanges."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fricmodels.diagnosis.rules.rule import Rules, rule


@dataclass(frozen=True)
class LadderRules(Rules):
    """Which effects a ladder adds, removes and exchanges."""

    most_steps: int = rule(
        6,
        "effects",
        "The ladder adds no more effects.",
        "Judgement: a model that lacks more is better thought about than extended.",
    )
    step_trials: int = rule(
        4,
        "effects",
        "So many effects that pass are tried before a step is given up.",
        "Judgement: each costs a fit.",
    )
    superfluous_gain: float = rule(
        0.025,
        "share of the residual",
        "An added effect is removed if, with all others in the model, it gains no more than this, or the test error is "
        "no higher without it.",
        "Judgement: half of least_gain, since it has passed that once.",
        off=-math.inf,
    )
    removal_loss: float = rule(
        0.05,
        "share of the test error",
        "But not if the test error without it rises by more than this.",
        "Judgement: equal to least_gain.",
        off=math.inf,
    )
    constancy_significance: float = rule(
        0.001,
        "probability",
        "It is said of an effect that it is not the same throughout, if its size differs between halves of the motion "
        "with a corrected p-value below this.",
        "Statistic. Nothing is named or given up by it.",
        off=0.0,
    )
    constancy_change: float = rule(
        0.5,
        "share of the effect",
        "And if it differs by more than this.",
        "Judgement: what is half as large again elsewhere is doubtful.",
        off=math.inf,
    )
    exchange_margin: float = rule(
        0.025,
        "share of the test error",
        "A model with more parameters takes the place of another if its test error is lower by this share; one with as "
        "many or fewer, or a simpler effect within it, if it is no more than this higher. A look-alike of no more "
        "parameters comes first if its test error is lower by this, one with more if it is lower by refit_share.",
        "Judgement: half of least_gain.",
        off=0.0,
    )
    exchange_for_adequate: float = rule(
        1.1,
        "factor of the test error",
        "An adequate model may have so many times the test error of one that leaves something unknown.",
        "Judgement.",
        off=0.0,
    )
