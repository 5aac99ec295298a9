"""Adds what is missing, refits, and repeats: the ladder on which the error falls."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.comparison import Comparison, compare, refitted, with_effect
from fricmodels.diagnosis.diagnose import Diagnosis, Finding, examine
from fricmodels.diagnosis.verdict import LEAST_GAIN, SIGNIFICANCE
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.shown import Shown
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Evidence, Regression

MOST_TRIALS = 4
"""So many of the effects that pass are tried before a step is given up."""
_NEARLY = 1.1
"""A model that explains all that can be predicted may leave so many times the error of one that does not."""
MOST_STEPS = 6
"""A model that lacks more effects than this is better thought about than extended."""


@dataclass(frozen=True)
class Rung:
    """One step of the ladder: the model, its comparison, and what was added or removed to come here."""

    comparison: Comparison
    added: str = ""
    removed: str = ""

    @property
    def model(self) -> str:
        """Name of the model."""
        return self.comparison.drive.model.name


@dataclass(frozen=True, repr=False)
class Ladder(Shown):
    """From the model that was given to the best one.

    Attributes:
        first: diagnosis of the model that was given.
        rungs: every model on the way, the given one first.
        last: diagnosis of the final model.
        steps: the diagnoses that led to each added effect.
        note: why the ladder ended where it did, if not because the model became adequate.
    """

    first: Diagnosis
    rungs: tuple[Rung, ...]
    last: Diagnosis
    steps: tuple[Diagnosis, ...]
    note: str = ""


def improve(
    recording: Recording,
    model: Model | str,
    inertia: float | None = None,
    *,
    leave_out: Iterable[str] = (),
    progress: Callable[[str], None] | None = None,
) -> Ladder:
    """Add the missing effect, refit everything, repeat until nothing is missing; then try to remove or exchange each.

    An effect stays only if it lowers the error on data that took no part in finding it.

    Args:
        recording: as read.
        model: law plus effects to begin from, or its name.
        inertia: J [kg m²] or M [kg]; estimated if not given.
        leave_out: effects that are not considered.
        progress: called with one line at every step.
    """
    say = progress or (lambda line: None)
    model = Model.of(model)
    say(f"fitting {model.name}")
    comparison = compare(recording, model, inertia)
    say(f"testing effects on {model.name}")
    first = examine(comparison, leave_out=leave_out)
    climb = _Climb(set(leave_out), {e.name for e in model.effects}, say, comparison, first)
    climb.up()
    pruned, exchanged, simplified = climb.prune(), climb.exchange(), climb.simplify()
    if pruned or exchanged or simplified:
        climb.look()
    if exchanged:
        climb.up()
    return Ladder(first, tuple(climb.rungs), climb.diagnosis, tuple(climb.steps), climb.note)


class _Climb:
    """A ladder in the making.

    Args:
        leave_out: as given to :func:`improve`.
        given: names of the effects that stay.
        say: takes one line at every step.
        comparison, diagnosis: of the model that was given.
    """

    def __init__(
        self,
        leave_out: set[str],
        given: set[str],
        say: Callable[[str], None],
        comparison: Comparison,
        diagnosis: Diagnosis,
    ) -> None:
        self._out, self._given, self._say = leave_out, given, say
        self.rungs, self.diagnosis, self.note = [Rung(comparison)], diagnosis, ""
        self.steps: list[Diagnosis] = []

    @property
    def _comparison(self) -> Comparison:
        return self.rungs[-1].comparison

    @property
    def _added(self) -> list[str]:
        return [e.name for e in self._comparison.drive.model.effects if e.name not in self._given]

    def look(self) -> None:
        """Diagnose the model that was reached; what it lost is not sought again."""
        self._say(f"testing effects on {self._comparison.drive.model.name}")
        lost = {name for rung in self.rungs for name in rung.removed.split("+") if name} - set(self._added)
        self.diagnosis = examine(self._comparison, leave_out=self._out | lost)

    def up(self) -> None:
        """Add what is missing until nothing is, or nothing helps."""
        while self.diagnosis.findings and len(self.steps) < MOST_STEPS:
            step = self._step()
            if not step:
                found = self.diagnosis.findings[0].tested.name
                self.note = f"'{found}' was found, but the error on data kept back does not fall with it"
                return
            for diagnosis, rung in step:
                self.steps.append(diagnosis)
                self.rungs.append(rung)
            self.look()

    def _step(self) -> list[tuple[Diagnosis, Rung]]:
        """Add the effect that was found; where it does not help on data kept back, the one that does so most, or two.

        Returns:
            The diagnoses that led to the new rungs, and these; empty where nothing helps.
        """
        diagnosis, here = self.diagnosis, self._comparison
        found = diagnosis.findings[0].tested
        tried = [Rung(self._with(here, found), added=found.name)]
        if _held_out(tried[0].comparison) >= _held_out(here):
            others = [t for t in diagnosis.passing if t.name != found.name][: MOST_TRIALS - 1]
            tried += [Rung(self._with(here, t), added=t.name) for t in others]
        best = min(tried, key=lambda rung: _held_out(rung.comparison))
        return [(diagnosis, best)] if _held_out(best.comparison) < _held_out(here) else self._two(tried)

    def _two(self, tried: Sequence[Rung]) -> list[tuple[Diagnosis, Rung]]:
        """Add two effects of which neither helps alone: what the first one brings may be lost in what is still missing.

        Args:
            tried: the model with one effect more, one for each that was tried.
        """
        pairs = []
        for rung in tried:
            following = examine(rung.comparison, leave_out=self._out)
            if following.findings:
                second = following.findings[0].tested
                pairs.append((rung, following, Rung(self._with(rung.comparison, second), added=second.name)))
        best = min(pairs, key=lambda pair: _held_out(pair[2].comparison), default=None)
        if best is None or _held_out(best[2].comparison) >= _held_out(self._comparison):
            return []
        return [(self.diagnosis, best[0]), (best[1], best[2])]

    def _with(self, comparison: Comparison, tested: CandidateTest) -> Comparison:
        """Return the model with one more effect, refitted; as it is where that fails."""
        self._say(f"adding {tested.name}")
        try:
            return with_effect(comparison, tested.effect, tested.parameters)
        except FricmodelsError:
            return comparison

    def _without(self, comparison: Comparison, name: str) -> Comparison:
        return refitted(comparison, comparison.drive.model.minus(name), comparison.estimate.parameters)

    def prune(self) -> bool:
        """Remove every added effect that the others have made superfluous; whether any was."""
        comparison = self._comparison
        removed: list[str] = []
        while len(self._added) - len(removed) > 1:
            tested = {name: without(comparison, name) for name in self._added if name not in removed}
            weakest = min(tested, key=lambda name: tested[name].gain)
            if tested[weakest].gain > LEAST_GAIN / 2 and tested[weakest].p_value < SIGNIFICANCE:
                break
            simpler = self._without(comparison, weakest)
            if _held_out(simpler) > (1 + LEAST_GAIN) * _held_out(comparison):
                break
            comparison = simpler
            removed.append(weakest)
        if removed:
            self.rungs.append(Rung(comparison, removed="+".join(removed)))
        return bool(removed)

    def exchange(self) -> bool:
        """Look once more for each added effect, now that the others are there; whether another one took a place.

        What was found first may have stood for the sum of what was missing then. Where it is found again, its
        look-alikes are those that it has now.
        """
        changed = False
        for name in self._added if len(self._added) > 1 else []:
            here = self._comparison
            smaller = self._without(here, name)
            self._say(f"looking again for what is missing without {name}")
            diagnosis = examine(smaller, leave_out=self._out)
            if not diagnosis.findings:
                continue
            found = diagnosis.findings[0]
            other = self._with(smaller, found.tested) if found.tested.name != name else here
            if other is here or not self._as_good(other):
                if name in found.names:
                    self._named_again(name, found)
                continue
            self.rungs += [Rung(smaller, removed=name), Rung(other, added=found.tested.name)]
            self.steps.append(diagnosis)
            changed = True
        return changed

    def simplify(self) -> bool:
        """Put an effect with fewer parameters in the place of one that, with all others there, does no more than it."""
        changed = False
        for name in self._added if len(self._added) > 1 else []:
            step = self.steps[self._place(name)]
            here = self._comparison
            own = next(e for e in here.drive.model.effects if e.name == name)
            simpler = [t for t in step.passing if len(t.effect.parameters) < len(own.parameters)]
            for tested in [t for t in simpler if t.name not in self._added][:MOST_TRIALS]:
                smaller = self._without(here, name)
                other = refitted(smaller, smaller.drive.model.plus(tested.effect), here.estimate.parameters)
                if self._as_good(other):
                    self.rungs += [Rung(smaller, removed=name), Rung(other, added=tested.name)]
                    self.steps.append(step)
                    changed = True
                    break
        return changed

    def _as_good(self, other: Comparison) -> bool:
        """Whether a model may take the place of the present one.

        It leaves as little, with more parameters clearly less; or else nothing that could be predicted.
        """
        share = _held_out(other) / _held_out(self._comparison)
        larger = len(other.drive.model.parameters) > len(self._comparison.drive.model.parameters)
        if share <= 1 + (-LEAST_GAIN if larger else LEAST_GAIN) / 2:
            return True
        unknown = self.diagnosis.verdict == "unknown-effect"
        return unknown and share <= _NEARLY and examine(other, leave_out=self._out).verdict == "adequate"

    def _place(self, name: str) -> int:
        """Return which step last added an effect."""
        names = [rung.added for rung in self.rungs if rung.added]
        return len(names) - 1 - names[::-1].index(name)

    def _named_again(self, name: str, again: Finding) -> None:
        place = self._place(name)
        step = self.steps[place]
        if step.findings[0].tested.name == name:
            names_now = (name, *(other for other in again.names if other != name))
            finding = replace(step.findings[0], names=names_now, separated_by=again.separated_by)
            self.steps[place] = replace(step, findings=(finding, *step.findings[1:]))


def _held_out(comparison: Comparison) -> float:
    return comparison.errors.held_out_percent


def added(ladder: Ladder) -> list[Finding]:
    """Return the findings that the ladder added and kept, in order; where it kept none, what the first step found."""
    kept = {effect.name for effect in ladder.rungs[-1].comparison.drive.model.effects}
    chosen = []
    for step, rung in zip(ladder.steps, (rung for rung in ladder.rungs if rung.added), strict=True):
        first = step.findings[0]
        if rung.added not in kept:
            continue
        if rung.added == first.tested.name:
            chosen.append(first)
            continue
        own = next(t for t in step.passing if t.name == rung.added)
        chosen.append(Finding(own, (own.name,), ""))
    return chosen or list(ladder.first.findings)


def without(comparison: Comparison, effect: str) -> Evidence:
    """Test an effect of a fitted model, given all the rest of the model."""
    problem, parameters = comparison.problem, comparison.estimate.parameters
    drive = comparison.drive
    smaller = Drive(drive.model.minus(effect), drive.inertia, drive.motion)
    own = next(e for e in drive.model.effects if e.name == effect)
    alone = problem.alone(own)
    delay = 0.0
    if alone.model.delay:  # its own problem has the record without the delay
        problem, delay = WeakFormProblem.of(smaller, comparison.train, parameters), problem.delay
    rest = replace(problem, drive=smaller).base(parameters)
    flags = alone.model.linear
    nonlinear = [
        parameters[f"{effect}.{p.symbol}"] for p, linear in zip(own.parameters, flags, strict=True) if not linear
    ]
    columns, _ = problem.columns(alone, nonlinear, delay)
    nuisances = np.vstack([problem.sign_change, problem.torque_rate])
    target = problem.target
    base = np.vstack([rest, nuisances[:1] if delay else nuisances])
    regression = Regression(base, target, problem.independent)
    visible = regression.visible(columns)
    if not np.any(visible):
        nothing = np.zeros(0)
        return Evidence(nothing, np.zeros((0, 0)), 1.0, 0.0, 0.0, 1.0, regression.loss, regression.residual)
    return regression.test(columns[visible])
