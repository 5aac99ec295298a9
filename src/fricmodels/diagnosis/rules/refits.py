"""The check by a refit, and what is left where no effect is named."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fricmodels.diagnosis.rules.rule import Rules, rule


@dataclass(frozen=True)
class RefitRules(Rules):
    """The check by a refit, and what is left where no effect is named."""

    residual_shows_error: float = rule(
        0.5,
        "share of the RMS torque error",
        "An effect with memory stands without a refit if it explains this much of the error in the weak form.",
        "Judgement: then its evidence is about most of the error.",
        off=-1.0,
    )
    replacement: float = rule(
        0.75,
        "factor of the RMS torque error",
        "Where a refit leaves more than this share of the error, one that leaves less than it of that comes instead.",
        "Judgement.",
        off=0.0,
    )
    fits_worse: float = rule(
        2.0,
        "factor of the squared RMS torque error",
        "An effect is not named if the model with it leaves more than this of what it was fitted to, by the headline.",
        "Found on a simulated bench test of a motor: with a stick torque of 148 N m, in samples that no row has, the "
        "fit error rose from 10 to 171 %. On 69 rough drives with a cause hidden it acts in three, and changes no "
        "answer.",
        off=math.inf,
    )
    refit_gain: float = rule(
        0.05,
        "share of the RMS torque error",
        "Where the error is far above noise, a refit with the named effect must lower it by this share.",
        "Judgement: equal to least_gain.",
        off=0.0,
    )
    within_sampling: float = rule(
        2.0,
        "samples",
        "What goes with the torque's rate tells no cause if it is a shift by at most so much: a sample either way, and "
        "the free shift of the rows. Nor does an effect without a name that explains most with a duration as short.",
        "Physical. Without it 2 of 238 rough drives with nothing hidden more were unknown.",
        off=-1.0,
    )
    noticed: float = rule(
        0.1,
        "share of the squared error",
        "What a channel predicts, and no effect explains, is called unknown only if it makes up so much of the squared "
        "error of the headline, mean of fit and test, and as much is above noise in some window. Else it is adequate.",
        "Judgement: without a tenth of its square the error is 5 % lower. Of 212 rough drives with nothing hidden six "
        "were unknown for 0.3 to 0.6 % of the torque beside errors of 1.3 to 8 % that sampling makes.",
        off=0.0,
    )
    noticed_torque: float = rule(
        1.0,
        "% of the RMS torque",
        "Or if it is as large as this, whatever else the error of single samples has.",
        "Judgement: the least size of what is looked for. Of 110 drives of the rig with the true effect off the list "
        "five were adequate, with 1.0 to 2.2 predicted (p < 1e-7) beside errors of 3 to 12 that sampling makes. With "
        "nothing hidden none of 200 rough drives is unknown for it (three have any such part, 0.5 to 1.04).",
        off=math.inf,
    )
    far_above_noise: float = rule(
        5.0,
        "% of the RMS torque",
        "An error is far above noise if it exceeds the noise floor by this (root of a difference of squares), without "
        "what sampling hides. Without any finding the verdict is then unknown-effect, not adequate.",
        "Found on our rig: on 800 drives with nothing hidden standstill leaves up to 3.6.",
        off=math.inf,
    )
    large_error: float = rule(
        10.0,
        "% of the RMS torque",
        "An error is far above noise, too, if it is larger than this in the window that users are shown, without what "
        "sampling hides.",
        "Found on 226 drives of two makes with nothing hidden: up to 7.5 is left there. Without it an axis whose scale "
        "has play is adequate at 39 %.",
        off=math.inf,
    )
    large_of_noise: float = rule(
        5.0,
        "factor of the noise there",
        "And larger than so many times the noise there.",
        "Found on the same drives: three have more, errors of up to 1.7 %.",
        off=0.0,
    )
    noise_known_to: float = rule(
        1.2,
        "factor",
        "The noise floor may be so many times as high as it was estimated; what falls below that counts for nothing.",
        "Found on 48 simulated drives: 0.96 to 1.07 of white noise is estimated, of lasting noise 0.92 to 1.27.",
        off=1.0,
    )
    refit_fall: float = rule(
        1.5,
        "% of the RMS torque",
        "An effect found over all motion, or too small in the rows, must lower the error by this (root of a difference "
        "of squares).",
        "Found on our rig: on 400 drives with nothing hidden none that passes lowers it by more than 0.8. Of 550 rough "
        "drives with nothing hidden none gets a name that is too small in the rows.",
        off=0.0,
    )
    refit_share: float = rule(
        0.9,
        "factor of the RMS torque error",
        "And to this share. So must its product with the printed one where it rises, or a delay within the free "
        "shift, or the test error with a constant that only a run that is kept back has.",
        "Found on our rig: on the same drives none lowers it to less than 0.9.",
        off=math.inf,
    )
    window_may_rise: float = rule(
        1.01,
        "factor of the RMS torque error",
        "Where the error falls far in single samples, that of the decisions, which averages more, may rise by this.",
        "Found on our rig: of six drives that ring too fast for the rows one has no name without it (a rise of 0.3 %).",
        off=1.0,
    )
    judged_by_weak_form: float = rule(
        0.5,
        "squared share",
        "An effect found over all motion is not considered if more than this share of it lies within the weak form, "
        "unless it is significant and explains there, too, with a gain that few events do not make certain.",
        "Judgement: the weak form has tested it already, and refused it (docs/decisions/rest.md).",
        off=math.inf,
    )
    refit_trials: int = rule(
        3,
        "effects",
        "So many effects that pass are fitted.",
        "Judgement: each costs a fit.",
    )
    alike_after_refit: float = rule(
        1.1,
        "factor of the RMS torque error",
        "Effects whose refits differ by less are look-alikes.",
        "Judgement.",
        off=1.0,
    )
