"""Whether a name may be given: an effect against what channels predict."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fricmodels.diagnosis.rules.rule import Rules, rule


@dataclass(frozen=True)
class ChannelRules(Rules):
    """Whether a name may be given: an effect against what channels predict."""

    own_form: float = rule(
        0.1,
        "squared share",
        "An effect that explains most of what a description of the rest leaves is there beside it, if so much of what "
        "the effect is lies outside of what the description can be.",
        "Found on six drives: 0.27 to 0.92 where both are there, 0.003 and 0.02 where the effect lies within a channel "
        "but for a hat that is not seen. Without the rule two right names of 408 rough drives are lost, and one wrong "
        "name of 44 drives of our rig with the true effect off the list.",
        off=math.inf,
    )
    own_size: float = rule(
        0.1,
        "share of its size without the description",
        "And if it has so much of its size there, of either sign. So has one beside one of two channels in its place.",
        "Found on our rig: without it two more of 66 drives with the true effect off the list have a wrong name, with "
        "0.007 and 0.03 of its size. On 200 rough drives those that are there have 0.25 to 1.4, on five.",
        off=-math.inf,
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
        "An effect must be there at this level though friction or zero may walk (`walk.py`); with a channel that "
        "explains more than the waves of walks, or without it.",
        "Statistic, equal to significance. Of 169 rough drives with such an effect or a walk it keeps off seven wrong "
        "names and no right one that matters. The channel gives three right names and two wrong ones, and takes a "
        "wrong one, on 494 with a cause off the list (docs/decisions/unknown.md).",
        off=1.1,
    )
    walk_evidence: float = rule(
        2.71,
        "twice the logarithm of a ratio of likelihoods",
        "Beside an effect that is no course of time only a walk counts for which the record speaks so clearly.",
        "Statistic: 5 % where nothing walks. Without it, and with a walk that never comes back, two of 27 single "
        "effects were lost, an offset beside coloured noise and a contact that bends (docs/decisions/unknown.md).",
        off=-math.inf,
    )
    own_share: float = rule(
        0.5,
        "share of the squared residual above the floor",
        "An effect must explain this of what is left without it, beside other effects and a description of the rest; "
        "if nothing predicts that, of the printed error; a wave of any wave of its number; a look-alike of what the "
        "first does. What a wave leaves must not be, for the most part, that wave in another form.",
        "Judgement: the threshold of naming against silence; docs/decisions/unknown.md draws its curve. Of waves off "
        "the list on 24 drives of the rig 7 got a wrong name without the second part, none with it, and no wave lost "
        "its own; of EMPS's, which has 0.88 of any wave, that is a quarter (docs/decisions/fast-ripple.md).",
        off=-math.inf,
    )
    of_channel: float = rule(
        0.97,
        "share",
        "An effect must explain this share of what a channel explains that predicts more in its place, and as much as "
        "one of other signals that is simpler and better than any of its own; a wave, this share of what any wave of "
        "its number does, if that is most of what it leaves. A named one is asked once more over all motion.",
        "Judgement: on 86 drives all true effects but one lie above it, most mimics of what is on no list below. The "
        "second part has no number; of 440 rough drives with a name nine lose a wrong one by it and none a right one. "
        "Over all motion eight of 437 answers change: three lose their only, wrong name, "
        "and one a right one (docs/decisions/unknown.md).",
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
        "Effects that explain as much as a channel with fewer terms than this are several causes, not one. So are "
        "effects with fewer terms than the channel, if less than least_gain of what each explains is left above noise.",
        "Judgement (Occam). Without it an asymmetry and gravity are one cause: 12 terms of a position hold both. "
        "Without the second part gravity and cogging of a joint are one, on six of six short Fourier series; with it "
        "one more of 25 drives of our rig with the true effect off the list has a wrong name.",
        off=0.0,
    )
    description_gain: float = rule(
        0.05,
        "share of the squared residual",
        "A channel joins the description of the rest if it lowers the residual by this.",
        "Judgement: equal to least_gain. Switched off alone three and four right names go (docs/ablation.md).",
        off=math.inf,
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
        off=math.inf,
    )
    line_share: float = rule(
        0.02,
        "share of the squared residual",
        "A frequency over the time is a channel where the residual has so much of its power there.",
        "Judgement: below least_gain, of which it must explain the more once it is tested. Without the channel a pump "
        "at 1.7 Hz was an inertia of 2422 kg beside 600.",
        off=math.inf,
    )
    line_of_motion: float = rule(
        0.03,
        "share of its power",
        "But not where velocity or direction have so much of theirs, and stand out: what a model gets wrong of a "
        "motion has its frequencies.",
        "Found on three logs with a pump, which moves the drive itself with less, and one clean drive with more.",
        off=math.inf,
    )
    line_stands_out: float = rule(
        10.0,
        "times the median beside it",
        "They stand out where their power is so many times that of the frequencies about it.",
        "Statistic: of what is random one in a thousand is so high.",
        off=0.0,
    )
    said_with_sign: float = rule(
        1.5,
        "factor of what is explained",
        "A channel is said to turn its sign with the motion where it explains so many times as much with the sign.",
        "Judgement; it decides words only. Without it gusts of wind turned their sign with the motion.",
        off=0.0,
    )
