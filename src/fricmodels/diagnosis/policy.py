"""Every constant that decides what a diagnosis says: its value, its unit, the rule that uses it, and its evidence.

The functions of the diagnosis take a :class:`Policy` along; ``replace(POLICY, …)`` changes a rule or switches it off,
and a benchmark shows what it is worth. Constants of numerical methods decide nothing and stay where they are used.
"""

from __future__ import annotations

from dataclasses import dataclass

from fricmodels.diagnosis.rule import Rules, rule

_INF = float("inf")


@dataclass(frozen=True)
class Policy(Rules):
    """The decision constants of the diagnosis; :meth:`table` gives their units, rules and evidence.

    *Residual* means what a model leaves in the weak form; *test error* the RMS torque error on data that took no part
    in the fit. Shares of a residual are of its RMS, unless they are said to be squared.
    """

    # ---- What may pass: three gates, and a candidate that velocity noise does not hide ---------------------------
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
        "Statistic: as above. Without it 14 of 88 names on 90 logs of another engineer were wrong, with it 6 of 80.",
        off=1.1,
    )
    least_gain: float = rule(
        0.05,
        "share of the residual",
        "On blocks that are kept back an effect must lower by this share what the residual has above noise; a channel "
        "that is to make a drive unknown, the residual itself. What leaves less than this leaves nothing to the past.",
        "Judgement: what an effect must be worth to have a place in a model.",
        off=-_INF,
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
        off=_INF,
    )
    noise_share: float = rule(
        0.05,
        "squared share",
        "An effect cannot be tested if noise of the velocity makes up more than this of the torque that it adds.",
        "Physical: the same noise is in the inertia torque, so that noise explains up to this share of a residual.",
        off=_INF,
    )
    noise_share_of_explained: float = rule(
        0.5,
        "factor",
        "Or more than so many times the share of the squared residual that it explains.",
        "Judgement: at least half of what is explained cannot come from noise.",
        off=_INF,
    )

    driving_friction: float = rule(
        0.05,
        "share of the work that the friction takes",
        "A part of the friction is refused if the friction that is fitted with it drives the joint by more than this.",
        "Physical: friction drives by nothing; the rest is for errors of the estimate. It is zero on 45 rough drives.",
        off=_INF,
    )
    own_torque: float = rule(
        10.0,
        "times the RMS torque",
        "An effect is refused whose own torque is more than this: another one cancels it, and only their sum is known.",
        "Physical: a spring may balance gravity ten to one. Of 82 effects of rough drives the largest has 1.8. Without "
        "it one of 408 ladders ended with two waves of 4000 that cancel, and eight times the error on another motion.",
        off=_INF,
    )

    # ---- Which of those that pass is named, and with which look-alikes ------------------------------------------
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
        off=_INF,
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
        "factor of the residual",
        "No effect with so many times the residual of the best one is a look-alike, passes over all motion only, "
        "stands in for one with which the test error does not fall, or is fitted as a simpler one in its place.",
        "Judgement: with little data no test tells even such a difference. Where every simpler effect is fitted, "
        "the ladder of `fricmodels demo` takes a quarter more time and ends the same.",
        off=_INF,
    )
    contained: float = rule(
        0.01,
        "squared share",
        "An effect with more parameters is no look-alike if less than this share of the first lies outside of it.",
        "Judgement.",
        off=0.0,
    )

    # ---- Whether a name may be given: the effect against channel predictors --------------------------------------
    own_form: float = rule(
        0.1,
        "squared share",
        "An effect that explains most of what a description of the rest leaves is there beside it, if so much of what "
        "the effect is lies outside of what the description can be.",
        "Found on six drives: 0.27 to 0.92 where both are there, 0.003 and 0.02 where the effect lies within a channel "
        "but for a hat that is not seen. Without the rule two right names of 408 rough drives are lost, and one wrong "
        "name of 44 drives of our rig with the true effect off the list.",
        off=_INF,
    )
    outpredicted_significance: float = rule(
        0.1,
        "probability",
        "A channel predictor is better than an effect at this level, corrected for how many there are (Diebold and "
        "Mariano 1995).",
        "Statistic, twice alike_significance: a wrong name is worse than none.",
        off=-1.0,
    )
    form_significance: float = rule(
        0.01,
        "probability",
        "Or if it predicts at this level what the effect leaves, and the effect nothing of what it leaves (Chong and "
        "Hendry 1986); not of waves at numbers that were sought.",
        "Statistic, equal to significance. Of 310 rough drives of seed 1301 it keeps off seven wrong "
        "names, five of them torque-gain for a droop; of 167 others it cost three right ones and kept off none "
        "(docs/decisions/unknown.md).",
        off=-1.0,
    )
    walk_significance: float = rule(
        0.01,
        "probability",
        "An effect of the time itself must be there at this level though friction or zero may walk (`walk.py`).",
        "Statistic, equal to significance. Of 169 rough drives with such an effect or a walk it keeps off seven wrong "
        "names and no right one that matters.",
        off=1.1,
    )
    own_share: float = rule(
        0.5,
        "share of the squared residual above the floor",
        "An effect must explain this of what is left without it, beside other effects and a description of the rest; "
        "if nothing predicts that, of the printed error; a fast wave of any such; a look-alike of what the first does.",
        "Judgement: the threshold of naming against silence; docs/decisions/unknown.md draws its curve. Of fast waves "
        "off the list on 44 drives of the rig 3 got a wrong name without it, 1 with it; EMPS has 0.87 and 0.91.",
        off=-_INF,
    )
    of_channel: float = rule(
        0.97,
        "share",
        "An effect must explain this share of what a channel explains that predicts more in its place.",
        "Judgement: on 86 drives all true effects but one lie above it, most mimics of what is on no list below.",
        off=0.0,
    )
    wave_periods: float = rule(
        4.0,
        "periods in the travel",
        "Of one kind no more than one wave may pass fewer: several of them draw a shape over the position.",
        "Judgement: a bump got five waves without it, three with it; of 20 pairs of waves 15 are found either way.",
        off=0.0,
    )
    fewer_terms: float = rule(
        0.5,
        "share of the channel's terms",
        "Effects that explain as much as a channel with fewer terms than this are several causes, not one.",
        "Judgement (Occam). Without it an asymmetry and gravity are one cause: 12 terms of a position hold both.",
        off=0.0,
    )
    description_gain: float = rule(
        0.05,
        "share of the squared residual",
        "A channel joins the description of the rest if it lowers the residual by this.",
        "Judgement: equal to least_gain; never switched off alone in a benchmark.",
        off=_INF,
    )
    kept: float = rule(
        0.5,
        "share",
        "A channel is in the place of an effect if this leaves less than such a share of what it explains beside it.",
        "Judgement: most of it.",
        off=0.0,
    )
    most_together: int = rule(
        4,
        "effects",
        "So many effects are found one after the other in one diagnosis.",
        "Judgement: each costs a search.",
    )
    clean_torque: float = rule(
        0.1,
        "share of the residual",
        "The past of the motor torque is a predictor only where the noise of the torque is below this.",
        "Physical: else it predicts its own noise.",
        off=_INF,
    )

    # ---- The check by a refit, for effects with memory ------------------------------------------------------------
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
    far_above_noise: float = rule(
        5.0,
        "% of the RMS torque",
        "An error is far above noise if it exceeds the noise floor by this (root of a difference of squares), without "
        "what sampling hides. Without any finding the verdict is then unknown-effect, not adequate.",
        "Found on our rig: on 800 drives with nothing hidden standstill leaves up to 3.6.",
        off=_INF,
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
        "And to this share. So must its product with the printed one where it rises, or a delay within the free shift.",
        "Found on our rig: on the same drives none lowers it to less than 0.9.",
        off=_INF,
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
        "An effect found over all motion is not considered if more than this share of it lies within the weak form.",
        "Judgement: the weak form has tested it already.",
        off=_INF,
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

    # ---- The ladder -------------------------------------------------------------------------------------------------
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
        off=-_INF,
    )
    removal_loss: float = rule(
        0.05,
        "share of the test error",
        "But not if the test error without it rises by more than this.",
        "Judgement: equal to least_gain.",
        off=_INF,
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


POLICY = Policy()
"""The policy of every command."""
