"""What may pass: three gates, and a candidate that velocity noise does not hide."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fricmodels.diagnosis.rules.rule import Rules, rule


@dataclass(frozen=True)
class PassingRules(Rules):
    """What may pass: three gates, and a candidate that velocity noise does not hide."""

    significance: float = rule(
        0.01,
        "probability",
        "An effect or a channel predictor passes only with a corrected p-value below this. A law is held at a bound, "
        "where no effect passed and it would lie beyond it with one below this.",
        "Statistic: the chance of any false name in one diagnosis (Holm 1979).",
        off=1.1,
    )
    significance_once: float = rule(
        0.01,
        "probability",
        "So must a name with what repeats with the motion counted once; the search for it goes without.",
        "Statistic: the chance of any false name, too. "
        "Without it 14 of 88 names on 90 logs of another engineer were wrong, with it 6 of 80.",
        off=1.1,
    )
    least_gain: float = rule(
        0.05,
        "share of the residual",
        "On blocks that are kept back an effect must lower by this share what the residual has above noise; a channel "
        "that is to make a drive unknown, the residual itself. What leaves less than this leaves nothing to the past. "
        "With an effect a squared printed test error of some window must be lower by this share. "
        "An effect is named, too, with which no more than this is left of squared printed errors far above noise.",
        "Judgement: what an effect must be worth to have a place in a model. Printed errors have to fall by it since a "
        "drive with nothing hidden had a name with 1.45 % before and after; of 113 rough drives no answer changes.",
        off=-math.inf,
    )
    effect_gain_significance: float = rule(
        0.1,
        "probability",
        "p-value below which the gain of an effect on those blocks counts, of all or beside the largest.",
        "Statistic: a second test; the first gate holds the chance of a false name.",
        off=1.1,
    )
    predictor_gain_significance: float = rule(
        0.05,
        "probability",
        "p-value below which the gain of a channel predictor counts; as a rival of an effect, that of effects does.",
        "Statistic: as for effects; a predictor has more coefficients to fit by chance.",
        off=1.1,
    )
    least_torque: float = rule(
        0.003,
        "share of the RMS torque",
        "It must explain this torque. So much is also counted as floor beside the noise of the velocity.",
        "Found on our rig: with nothing hidden, sampling and differentiation leave 0.0003 to 0.003.",
        off=0.0,
    )
    least_torque_all_motion: float = rule(
        0.04,
        "share of the RMS torque",
        "An effect below least_torque passes if it takes away this much over all motion, standstill included.",
        "Found on rough drives: up to 0.016 with nothing hidden, 160 of them; from 0.02 on what is not there passes.",
        off=math.inf,
    )
    noise_share: float = rule(
        0.05,
        "squared share",
        "An effect cannot be tested if noise of the velocity makes up more than this of the torque that it adds.",
        "Physical: the same noise is in the inertia torque, so that noise explains up to this share of a residual.",
        off=math.inf,
    )
    noise_share_of_explained: float = rule(
        0.5,
        "factor",
        "Or more than so many times the share of the squared residual that it explains.",
        "Judgement: at least half of what is explained cannot come from noise.",
        off=math.inf,
    )

    driving_friction: float = rule(
        0.05,
        "share of the samples in motion",
        "A part of the friction is refused if the friction that is fitted with it drives the joint in more than this, "
        "and by more than its error (at the level significance).",
        "Physical: friction drives by nothing; the rest is for forms that are not quite right. Without it a torque of "
        "the size of the acceleration, on one sine, is an asymmetry (34 to 38 % on another motion). Of 64 models of "
        "rough drives with such a part no true one drives anywhere.",
        off=math.inf,
    )
    own_torque: float = rule(
        10.0,
        "times the RMS torque",
        "An effect is refused whose own torque, beyond what the law's terms could be, is more than this: another one "
        "cancels it, and only their sum is known.",
        "Physical: a spring may balance gravity ten to one. Of 82 effects of rough drives the largest has 1.8. Without "
        "it one of 408 ladders ended with two waves of 4000 that cancel, and eight times the error on another motion.",
        off=math.inf,
    )
