"""Names the effect that a fitted model is missing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeGuard

from fricmodels.diagnosis.at_bounds import beyond_bounds
from fricmodels.diagnosis.by_fit import (
    all_of_the_error,
    all_together,
    as_a_whole,
    confirmed,
    most_of_the_error,
    that_can_be_fitted,
    that_stay,
)
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests
from fricmodels.diagnosis.coloured_residual import ColouredNoise, coloured_residual
from fricmodels.diagnosis.comparison import Comparison, compare
from fricmodels.diagnosis.effect_set import as_predictor
from fricmodels.diagnosis.floor import is_far_above_noise, is_noticed
from fricmodels.diagnosis.in_words import as_told, from_when_to_when
from fricmodels.diagnosis.look_alikes import separated_by
from fricmodels.diagnosis.over_all_motion import that_all_motion_allows
from fricmodels.diagnosis.places import Place, largest_place, torque_of
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.diagnosis.power import Visibility, visibility
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor, passing_predictors
from fricmodels.diagnosis.refit_check import refit_check
from fricmodels.diagnosis.refits import Refits
from fricmodels.diagnosis.remaining import Remaining, place_of_stretch, remaining
from fricmodels.diagnosis.ripple import FastRipple, fast_ripple
from fricmodels.diagnosis.supported import Judgement, judge
from fricmodels.diagnosis.verdict import LookAlikes, passing_all_gates, select_effect, torque_share
from fricmodels.dimension import TIME
from fricmodels.display import Displayed
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.processes import give_back
from fricmodels.progress import Cancelled, Token, Watcher, stage, watched
from fricmodels.recording import Recording, check_recording
from fricmodels.results.diagnosis import Verdict
from fricmodels.split import Split
from fricmodels.weakform.lines import averaged_from
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.remembered import INTEGRALS

_AS_SHORT = 1.01
"""Factor within which a duration is the shortest one that is sought."""


@dataclass(frozen=True)
class Finding:
    """An effect that the data show, with its look-alikes."""

    tested: CandidateTest
    names: tuple[str, ...]
    separated_by: str


@dataclass(frozen=True, repr=False)
class Diagnosis(Displayed):
    """What is missing in a model, as far as a recording can tell.

    Attributes:
        comparison: the model against the recording.
        verdict: see the documentation of diagnosis.
        findings: the effect that explains the residual best, with its look-alikes; none where none passes. What else
            may be missing shows once this one is in the model (:func:`fricmodels.diagnosis.improve`).
        view: the channel that predicts the residual best, whatever the physics, or else its own past; ``None`` if
            nothing does. Without one an unknown effect acts about standstill, or shows in no recorded channel. It may
            predict so little that the verdict is ``adequate`` all the same.
        visibility: for every effect that was not found, the smallest that would have been, or what is missing.
        passing: every effect that passes the gates by itself, best first; most only resemble the first.
        policy: the constants that decided.
        place: where along a channel the residual has a mean of its own, or in which stretch of the way one torque
            predicts it best, if nothing was named.
        refits: fits of the model with one effect more, as far as they were asked for.
        refused: an effect that would have been named, but with which the test error does not fall.
        result: every candidate that was tested.
        noise: what is left, where it is noise with a colour that lies in no channel.
        judgement: what speaks for each effect of the set that the residual suggests; ``None`` where none passes.
        ripple: waves over position that are too fast for the rows; ``None`` where there are none.
        refuted: names of effects that the rows show, and than which something else predicts more over all motion.
    """

    comparison: Comparison
    verdict: Verdict
    findings: tuple[Finding, ...]
    view: ChannelPredictor | None
    visibility: Mapping[str, Visibility]
    passing: tuple[CandidateTest, ...] = ()
    policy: Policy = POLICY
    place: Place | None = None
    refits: Refits | None = None
    refused: CandidateTest | None = None
    result: CandidateTests | None = None
    judgement: Judgement | None = None
    noise: ColouredNoise | None = None
    ripple: FastRipple | None = None
    refuted: frozenset[str] = frozenset()

    def judged_by(self, findings: Sequence[Finding]) -> Diagnosis:
        """Return it with the verdict that findings have, as those that a ladder kept: their look-alikes are fewer."""
        return replace(self, verdict=naming_verdict(findings))

    @cached_property
    def remaining(self) -> Remaining | None:
        """What remains that no effect was named for; ``None`` unless the verdict is ``unknown-effect``."""
        if self.verdict != "unknown-effect" or self.refits is None or self.result is None:
            return None
        channel = "" if self.view is None else self.view.channels
        when = from_when_to_when(self.result, self.view) if self.place is None else ""
        return remaining(self.comparison, channel, self.place, self.refits, self.result.tested, when, self.refuted)


def diagnose(
    recording: Recording,
    model: Model | str,
    inertia: float | None = None,
    *,
    leave_out: Iterable[str] = (),
    policy: Policy = POLICY,
    how: Split | None = None,
    progress: Watcher | None = None,
    token: Token | None = None,
) -> Diagnosis:
    """Say which effect a model is missing.

    Args:
        recording: as read.
        model: law plus effects, or its name.
        inertia: J [kg m²] or M [kg]; estimated if not given.
        leave_out: effects that are not considered.
        policy: the constants that decide.
        how: what is kept back; blocks or runs spread over the record if not given.
        progress: called with a :class:`~fricmodels.progress.Progress` at every part of the work.
        token: stops the work.

    Raises:
        InputError: when the recording lacks what the model needs, or does not move enough, or an effect to be left out
            is not known.
        Cancelled: when it was stopped; with the fitted model, if it was that far.
    """
    check_recording(recording)
    leave_out, comparison = known_effects(leave_out), None
    with watched(progress, token):
        try:
            stage(f"fitting {Model.of(model).name}")
            comparison = compare(recording, model, inertia, how=how)
            return examine(comparison, leave_out=leave_out, policy=policy)
        except KeyboardInterrupt:
            raise Cancelled(comparison) from None
        finally:
            INTEGRALS.clear()  # what remains to be done is to show what was found, with arrays of its own
            give_back(len(recording))


def known_effects(named: Iterable[str]) -> tuple[str, ...]:
    """Return the names of effects.

    Raises:
        InputError: for one that is not known, or a text in the place of several.
    """
    if isinstance(named, str):
        raise InputError(f"leave_out takes several names, got '{named}'; write ['{named}']")
    names = tuple(named)
    for name in names:
        load().effects.entry(name)
    return names


def examine(comparison: Comparison, *, leave_out: Iterable[str] = (), policy: Policy = POLICY) -> Diagnosis:
    """Test every effect on what a fitted model leaves over.

    They are tested on what the model would leave if its parameters had no bounds. What a bound keeps from the fit does
    not show there. So where no effect is named they are tested once more beside a model that keeps its bounds.
    """
    refits = Refits(comparison, policy)
    diagnosis = _examined(refits, replace(comparison.problem), set(leave_out), policy)
    within = None if diagnosis.findings else beyond_bounds(comparison, policy)
    if within is None:
        return diagnosis
    other = _examined(refits, within, set(leave_out), policy)
    return other if other.findings or diagnosis.verdict == "adequate" else diagnosis


def _examined(refits: Refits, problem: WeakFormProblem, out: set[str], policy: Policy) -> Diagnosis:
    comparison, parameters = refits.comparison, refits.comparison.estimate.parameters
    result = candidate_tests(problem, parameters, leave_out=out, policy=policy)
    possible = that_can_be_fitted(refits, result)
    best = select_effect(possible)
    ripple = fast_ripple(result.problem, parameters, out, policy)
    if _is_larger(ripple, result, best) and (fast := _confirmed_ripple(refits, ripple)) is not None:
        return _beside_ripple(refits, fast, out, policy)
    predictors = passing_predictors(result)
    is_left = best is not None or predictors or is_far_above_noise(comparison, policy)
    judgement = judge(possible, out, best) if is_left else None
    together = [] if judgement is None else _supported(refits, judgement)
    imitating = () if judgement is None else [one.first.name for one in judgement.one_cause]
    found = refit_check(refits, possible, out, together[0] if together else None, imitating)
    named = confirmed(refits, found, possible, out, together)
    everything = as_a_whole(refits, together) if named is None else all_together(refits, named, together)
    if judgement is not None and judgement.only_jointly and len(everything) < len(together):
        # Each showed beside all the others only, and with one of them the error does not fall.
        everything = all_of_the_error(refits, judgement)
    allowed, refuted = that_all_motion_allows(possible, everything)
    if refuted:
        everything = that_stay(refits, allowed)
        found, named = (found, everything[0]) if everything else (None, None)
    place = _noticed_place(result, comparison) if named is None else None
    noise = None if place is not None else _noise(comparison, result, named, predictors)
    view = next((p for p in predictors if p.channels not in AUTOREGRESSIVE), predictors[0] if predictors else None)
    if noise is not None:
        view = None
    elif best is not None and found is None and not _within_sampling(result, best.first):
        own = as_predictor(result, best.first)
        view = own if view is None or own.evidence.left < view.evidence.left else view
    if everything:
        ripple = _beside(refits, everything, out, policy)
    fast = _confirmed_ripple(_with_all(refits, everything), ripple)
    everything += [fast.found] if fast is not None and fast.found is not None else []
    findings = tuple(map(_finding, everything))
    verdict: Verdict = "adequate"
    if findings:
        verdict = naming_verdict(findings)
    elif _is_seen(result, comparison, view) or place is not None or is_far_above_noise(comparison, policy):
        verdict = "unknown-effect"
        place = (None if view is None else place_of_stretch(result, view)) or place
    passing = tuple(passing_all_gates(result)) if found is not None else ()
    seen = visibility(result, {name for one in everything[:1] for name in one.names})
    refused = found.first if found is not None and not everything else None
    return Diagnosis(
        comparison,
        verdict,
        findings,
        as_told(result, view),
        seen,
        passing,
        policy,
        place,
        refits,
        refused,
        result,
        noise=noise,
        judgement=judgement,
        ripple=fast or ripple,
        refuted=refuted,
    )


def _supported(refits: Refits, judgement: Judgement) -> list[LookAlikes]:
    """Return the effects that are there by the rows, or else that which takes away most, or all, of the error."""
    there = judgement.supported(refits.policy)
    return there or most_of_the_error(refits, judgement) or all_of_the_error(refits, judgement)


def is_predictable(comparison: Comparison, policy: Policy) -> bool:
    """Whether what a fitted model leaves is far above noise, or a channel or a place predicts it.

    A model of which this is true is not adequate; no candidate need be tried to know it.
    """
    parameters = comparison.estimate.parameters
    result = candidate_tests(replace(comparison.problem), parameters, only=(), policy=policy)
    if is_far_above_noise(comparison, policy) or _noticed_place(result, comparison) is not None:
        return True
    found = [p for p in passing_predictors(result) if p.channels not in AUTOREGRESSIVE]
    return any(_is_seen(result, comparison, p) for p in found)


def _noticed_place(result: CandidateTests, comparison: Comparison) -> Place | None:
    """Return the place whose mean explains most of what is left, if that is a noticeable part of the error."""
    place = largest_place(result)
    noticed = place is not None and is_noticed(comparison, torque_of(place, result), result.policy)
    return place if noticed else None


def _is_seen(result: CandidateTests, comparison: Comparison, view: ChannelPredictor | None) -> bool:
    """Whether a channel predicts a noticeable part of the error."""
    return view is not None and is_noticed(comparison, 100 * torque_share(result, view.evidence), result.policy)


def seems_missing(comparison: Comparison, leave_out: Iterable[str], policy: Policy) -> LookAlikes | None:
    """Return the effect that by itself explains best what a fitted model leaves: a first look, without any check."""
    return select_effect(_first_look(comparison, leave_out, policy))


def comes_near(smaller: Comparison, name: str, leave_out: Iterable[str], policy: Policy = POLICY) -> set[str]:
    """Return the effects that come near to one in the rows, beside a model without it; all where it has no place there.

    One that leaves far more is not worth a fit.
    """
    tested = _first_look(smaller, leave_out, policy).tested
    own = [t.evidence.left for t in tested if t.name == name]
    most = policy.far_worse**2 * own[0] if own else float("inf")
    return {t.name for t in tested if t.evidence.left <= most}


def _first_look(comparison: Comparison, leave_out: Iterable[str], policy: Policy) -> CandidateTests:
    parameters = comparison.estimate.parameters
    return candidate_tests(replace(comparison.problem), parameters, leave_out=leave_out, policy=policy)


def _within_sampling(result: CandidateTests, tested: CandidateTest) -> bool:
    """Whether an effect explains most with a duration as short as sampling alone makes one: it tells no cause."""
    shortest = result.policy.within_sampling * result.problem.recording.interval
    durations = [p.symbol for p in tested.effect.parameters if p.dimension == TIME and not p.delay]
    return any(tested.parameters[symbol] <= _AS_SHORT * shortest for symbol in durations)


def _is_larger(ripple: FastRipple | None, result: CandidateTests, best: LookAlikes | None) -> TypeGuard[FastRipple]:
    """Whether a wave that the rows average away has more torque than the effect that explains most in them."""
    if ripple is None or ripple.waves.lines[0].k < averaged_from(result.problem):
        return False
    in_rows = 0.0 if best is None else torque_share(result, best.first.evidence)
    return ripple.torque > in_rows * result.problem.recording.rms_torque


def _beside_ripple(refits: Refits, ripple: FastRipple, leave_out: set[str], policy: Policy) -> Diagnosis:
    """Return the diagnosis of a model that lacks a fast wave, and what is missing beside that.

    The rows see some of the wave where the drive is slow, and would take it for anything.
    """
    assert ripple.found is not None
    fitted = refits.with_effect(ripple.found.first)
    assert fitted is not None
    rest = examine(fitted, leave_out=leave_out, policy=policy)
    names = set(ripple.found.names)
    return replace(
        rest,
        comparison=refits.comparison,
        verdict="missing-effect" if len(names) == 1 else "undecided",
        findings=(_finding(ripple.found), *(f for f in rest.findings if not names.intersection(f.names))),
        visibility={name: row for name, row in rest.visibility.items() if name not in names},
        passing=(ripple.found.first, *rest.passing),
        refits=refits,
        ripple=ripple,
    )


def _beside(refits: Refits, found: list[LookAlikes], leave_out: set[str], policy: Policy) -> FastRipple | None:
    """Return the fast waves that are left beside effects that were found."""
    beside = _with_all(refits, found)
    if beside is None:
        return None
    here = beside.comparison
    out = {*leave_out, *(name for one in found for name in one.names)}
    return fast_ripple(here.problem, here.estimate.parameters, out, policy)


def _with_all(refits: Refits, found: list[LookAlikes]) -> Refits | None:
    beside: Refits | None = refits
    for one in found:
        beside = beside and beside.beside(one.first)
    return beside


def _confirmed_ripple(refits: Refits | None, ripple: FastRipple | None) -> FastRipple | None:
    """Return fast waves over position if the test error falls with their effect, as far as it shows them.

    The rows that carry a wave may be explained better by what they get wrong. So an effect with fewer parameters leads,
    as gravity where the wave is a turn, if the test error is hardly higher with it, and one with as many if it is
    lower.
    """
    if refits is None or ripple is None or ripple.found is None:
        return None
    window, first = 1000 * ripple.waves.duration, ripple.found.first
    for other in ripple.others:
        if refits.is_better_within(other, first, window):
            first = other
    if first is not ripple.found.first:
        ripple = replace(ripple, found=LookAlikes(first, (first,)))
    return ripple if refits.lowers_error_within(first, window) else None


def _noise(
    comparison: Comparison, result: CandidateTests, named: LookAlikes | None, predictors: Sequence[ChannelPredictor]
) -> ColouredNoise | None:
    """Return what is left as noise, where its own past and no channel predicts it, and it is not large."""
    in_channels = named is not None or any(p.channels not in AUTOREGRESSIVE for p in predictors)
    if not predictors or in_channels or is_far_above_noise(comparison, result.policy):
        return None
    return coloured_residual(result)


def naming_verdict(findings: Sequence[Finding]) -> Verdict:
    """Return the verdict where effects were found: undecided if the first of them has look-alikes."""
    return "missing-effect" if len(findings[0].names) == 1 else "undecided"


def _finding(best: LookAlikes) -> Finding:
    return Finding(best.first, tuple(best.names), separated_by(best.names))
