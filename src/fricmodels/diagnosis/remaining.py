"""What a model leaves that no effect was named for: how much, in which channel, where, and what comes nearest to it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Mask
from fricmodels.diagnosis.basis_functions import STRETCH, STRETCH_ALONG
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.contradiction import contradiction
from fricmodels.diagnosis.places import Place
from fricmodels.diagnosis.predictability import ChannelPredictor
from fricmodels.diagnosis.refits import Refits
from fricmodels.diagnosis.sought_functions import ends_of_stretch
from fricmodels.diagnosis.where import in_words
from fricmodels.dimension import DISPLACEMENT, FORCE, Motion
from fricmodels.recording import Recording
from fricmodels.results.words import ALONG, END_STOP, HELD_AT_REST
from fricmodels.signals import resting
from fricmodels.split import WHOLE_RUNS
from fricmodels.weakform.regression import to_order_by

_NEAREST = 3
_SLOW, _MOST, _MUCH = 1e-9, 0.99, 0.2
"""Speed of a drive that begins to move, as a share of its peak; the quantile of what it holds beyond its model that is
said, and from which share of its friction on. Judgements, of what is said beside a verdict; they name nothing."""
_AT_END, _NEARLY_ALL = 0.02, 0.9
"""Share of the travel that is its end, and of the rests with much torque that are there. Judgements, as these."""


@dataclass(frozen=True)
class Nearest:
    """A listed effect that was not named, and the model fitted with it.

    Attributes:
        name: of the effect.
        model: the model with it.
        held_out_percent: its test error, in % of the RMS motor torque.
        against: what speaks against it, in words; empty where nothing is known to.
    """

    name: str
    model: str
    held_out_percent: float
    against: str = ""


@dataclass(frozen=True)
class Remaining:
    """What remains unexplained.

    Attributes:
        percent, SI: RMS test error beyond what sensor noise leaves, in % of the RMS motor torque and in N m or N.
        channel: the channel that predicts it best, in words; empty where none does.
        where: the place in that channel, its width and the mean torque there, or else from when to when it is there, or
            the regime of motion in which most of it lies.
        place: the same place as numbers; ``None`` where it lies in none.
        nearest: the listed effects that come nearest to it, the one with the least test error first; of those that are
            as good but for the least gain that counts the simplest.
    """

    percent: float
    SI: float
    channel: str
    where: str
    place: Place | None
    nearest: tuple[Nearest, ...]


def remaining(
    comparison: Comparison,
    channel: str,
    place: Place | None,
    refits: Refits,
    tested: Sequence[CandidateTest],
    when: str = "",
    refuted: Collection[str] = (),
) -> Remaining:
    """Return what a fitted model leaves.

    Args:
        comparison: the model.
        channel: the channel that predicts its residual, or an empty text.
        place: where the residual has a mean of its own.
        refits: fits of this model with one effect more.
        tested: the effects that were not named, the nearest first.
        when: between which instants it is there, in words, if that is told.
        refuted: names of effects that the rows show and all motion does not.
    """
    errors = comparison.errors
    percent = float(np.sqrt(max(errors.held_out_percent**2 - comparison.noise_floor_percent**2, 0.0)))
    size = percent / 100 * comparison.test.rms_torque
    worst = comparison.where[0]
    held = held_at_rest(comparison) if place is None and worst.regime == "rest" else ""
    shown, whole = [t for t in tested if np.any(t.found.kept)], bool(comparison.test.provenance.get(WHOLE_RUNS))

    def may_be_near(tested: CandidateTest) -> bool:
        """Whether no row may show it: a friction at rest, or what a run that is kept back has by itself."""
        return bool(held and tested.effect.friction) or (whole and bool(tested.effect.fitted_runs))

    chosen = shown[:_NEAREST] + [t for t in shown[_NEAREST:] if may_be_near(t)]
    near, parameters = [], dict[str, int]()
    for candidate in chosen:
        other = refits.with_effect(candidate)
        if other is not None:
            against = contradiction(comparison, candidate, channel, refuted)
            near.append(Nearest(candidate.name, other.drive.model.name, other.errors.held_out_percent, against))
            parameters[candidate.name] = len(candidate.effect.parameters)
    least = (1 + refits.policy.least_gain) * min((one.held_out_percent for one in near), default=0.0)

    def rank(one: Nearest) -> tuple[int, float]:
        """Of those that are as good as the best the simplest comes first."""
        as_good = one.held_out_percent <= least
        simple = parameters[one.name] if as_good else max(parameters.values()) + 1
        return simple, to_order_by(one.held_out_percent)

    near = sorted(near, key=rank)[:_NEAREST]
    if when:
        where = when
    elif place is None:
        where = f"{100 * worst.share_of_squared_error:.0f} % of the squared error lies {in_words(worst.regime)}{held}"
    else:
        where = at_place(place, comparison.drive.motion)
        channel = channel or place.channel.replace("_", " ")
    return Remaining(percent, size, channel, where, place, tuple(near))


def held_at_rest(comparison: Comparison) -> str:
    """Return in words by how much a drive holds more at rest than its model; empty where that is not known, or nothing.

    A friction that acts at rest only, or in the first sample of a motion, is in no equation of the motion: what a
    controller had to give in vain tells of it.
    """
    drive, prepared = comparison.drive, comparison.train
    if drive.model.states:
        return ""
    still, slow = resting(prepared), np.full(len(prepared), _SLOW * (prepared.peak_speed or 1.0))
    forward, backward = (
        drive.friction(prepared, comparison.estimate.parameters, velocity=side * slow)[still] for side in (1.0, -1.0)
    )
    torque = prepared.driving_torque[still]
    beyond = np.maximum(torque - forward, backward - torque)
    held, friction = np.quantile(beyond, _MOST), float(np.median(0.5 * np.abs(forward - backward)))
    if held <= friction * _MUCH:
        return ""
    unit = FORCE.unit(drive.motion)
    why = f"its friction at rest is larger than in motion, or something else holds it, {HELD_AT_REST}"
    ends = _ends(prepared, still, beyond > 0.5 * held)
    if ends:
        length = DISPLACEMENT.unit(drive.motion)
        at = " and ".join(f"{end:.4g}" for end in ends)
        why = f"it rests at the end of its travel, {at} {length}, as at {END_STOP}"
    return f", where the drive holds up to {held:.2g} {unit} more than the {friction:.2g} {unit} of the model: {why}"


def _ends(recording: Recording, still: Mask, much: Mask) -> list[float]:
    """Return the ends of the travel at which nearly all rests with much torque are; none where they are elsewhere, too.

    Args:
        recording: with or without a position. still: its samples at rest. much: those of them with much torque.
    """
    if "position" not in recording or not np.any(much):
        return []
    position, place = recording["position"], recording["position"][still][much]
    low, high = float(position.min()), float(position.max())
    near = _AT_END * (high - low)
    if np.mean(np.minimum(place - low, high - place) < near) < _NEARLY_ALL:
        return []
    return [end for end in (low, high) if np.mean(np.abs(place - end) < near) > 1.0 - _NEARLY_ALL]


def place_of_stretch(result: CandidateTests, predictor: ChannelPredictor) -> Place | None:
    """Return the stretch of the way in which a predictor has one torque; ``None`` if it is of another channel."""
    if predictor.channels not in (STRETCH, STRETCH_ALONG):
        return None
    along = predictor.channels == STRETCH_ALONG
    problem = result.problem
    low, high = ends_of_stretch(problem, result.regression, along=along)
    position = problem.recording["position"]
    inside = (position >= low) & (position <= high)
    passes = np.count_nonzero(np.diff(np.concatenate([[False], inside]).astype(int)) == 1)
    return Place(
        "position",
        ALONG if along else "both",
        low,
        high,
        float(predictor.evidence.coefficients[0]),
        int(passes),
        predictor.p_value,
        predictor.evidence.explained,
    )


def at_place(place: Place, motion: Motion) -> str:
    """Return a place in words, with its width and the mean torque there."""
    length, torque = DISPLACEMENT.unit(motion), FORCE.unit(motion)
    unit = {"position": length, "speed": f"{length}/s", "load_torque": torque}.get(place.channel, "")
    middle, width = 0.5 * (place.low + place.high), place.high - place.low
    direction = "" if place.direction == "both" else f", {place.direction}"
    name = place.channel.replace("_", " ")
    return f"at {name} {middle:.3g} {unit}, {width:.2g} {unit} wide{direction}: {place.torque:+.2g} {torque} on average"
