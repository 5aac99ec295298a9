"""The search for the effects that a model lacks: what is added, removed and exchanged on the ladder."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.comparison import Comparison, from_scratch, numbered, refitted
from fricmodels.diagnosis.diagnose import Diagnosis, Finding, comes_near, examine, is_predictable, seems_missing
from fricmodels.diagnosis.ladder import Ladder, Rung, added
from fricmodels.diagnosis.look_alikes import separated_by
from fricmodels.diagnosis.necessity import necessity
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.refits import Refits, is_undetermined, is_void
from fricmodels.diagnosis.verdict import LookAlikes
from fricmodels.progress import stage

_NO_BETTER = "the test error does not fall with it"


class Search:
    """The search for the effects that a model lacks.

    Args:
        given: names of the effects that stay.
        leave_out: as given to :func:`improve`.
        policy: the constants that decide.
        first: diagnosis of the model that was given.
    """

    def __init__(self, given: set[str], leave_out: set[str], policy: Policy, first: Diagnosis) -> None:
        self._given, self._out, self._policy, self._first = given, leave_out, policy, first
        self.rungs, self.diagnosis, self.note = [Rung(first.comparison)], first, ""
        self.steps: list[Diagnosis] = []
        self._superfluous: set[str] = set()
        self._smaller: tuple[Comparison, dict[str, Comparison]] = (first.comparison, {})

    def to_the_end(self) -> None:
        """Add what is missing, then remove or exchange what others made superfluous, and look once more."""
        self.extend()
        pruned, exchanged, simplified = self.prune(), self.exchange(), self.simplify()
        if pruned or exchanged or simplified:
            self.diagnose()
            before = len(self.rungs)
            self.extend()
            if len(self.rungs) > before and self.prune():  # what is new may do all that another one did
                self.diagnose()

    def ladder(self, *, partial: bool = False) -> Ladder:
        """Return the rungs so far, with the diagnoses that led to them."""
        steps, first = [_beside(step, set(self._added)) for step in self.steps], self._first
        if steps and not first.findings:  # two effects together
            first = replace(steps[0], verdict="missing-effect")
        last = self.diagnosis
        if first.findings and len(self.rungs) == 1 and not partial:  # what was found was given up: it is not missing
            refused = first.findings[0].tested
            first = replace(first, verdict=last.verdict, findings=(), view=last.view, place=last.place, refused=refused)
        if partial and last.comparison is not self._here:  # what remains here was not looked at
            last = Diagnosis(self._here, "missing-effect", (), None, {}, policy=self._policy)
        found = Ladder(first, tuple(self.rungs), last, tuple(steps), self.note, partial)
        return replace(found, first=first.judged_by(added(found))) if first.findings else found

    @property
    def _here(self) -> Comparison:
        return self.rungs[-1].comparison

    @property
    def _added(self) -> list[str]:
        return [e.name for e in self._here.drive.model.effects if e.name not in self._given]

    def _examine(self, comparison: Comparison, also_out: Iterable[str] = ()) -> Diagnosis:
        return examine(comparison, leave_out=self._out.union(also_out), policy=self._policy)

    def diagnose(self) -> None:
        """Diagnose the model that was reached; an effect that the others made superfluous is not considered again."""
        self.diagnosis = self._examine(self._here, self._superfluous)

    def extend(self) -> None:
        """Add what is missing until nothing is, or nothing lowers the test error."""
        while len(self.steps) < self._policy.most_steps:
            step = self._step()
            if not step:
                refused = self.diagnosis.refused
                if refused is not None:
                    self.note = f"'{refused.name}' was found, but {_NO_BETTER}"
                return
            for diagnosis, rung in self._lowering(step):
                self.rungs.append(rung)
                self.steps.append(diagnosis)
            self.diagnose()

    def _lowering(self, step: list[tuple[Diagnosis, Rung]]) -> list[tuple[Diagnosis, Rung]]:
        """Return the rungs, fitted as `compare` fits them, up to the one with the lowest printed test error.

        The effect after it is not considered again; what was found with it may be found once more. Of effects that
        show only beside each other all are added, or none. One that comes out as nothing lowers no error, whatever else
        the fit has changed: with an inertia that no motion tells the noise of the acceleration is another one.
        """
        fitted = [(diagnosis, replace(rung, comparison=from_scratch(rung.comparison))) for diagnosis, rung in step]
        void = [is_void(rung.comparison, rung.added) for _, rung in fitted]
        lowered = [rung.comparison.errors.held_out_percent for _, rung in fitted]
        rungs = (float("inf") if none else error for error, none in zip(lowered, void, strict=True))
        errors = [self._here.errors.held_out_percent, *rungs]
        kept = errors.index(min(errors))
        judgement = self.diagnosis.judgement
        if kept < len(fitted) and judgement is not None and judgement.only_jointly:
            kept = 0
        if kept < len(fitted):
            name = fitted[kept][1].added
            self._superfluous.add(name)
            why = "fitted to all of the motion it is nothing" if void[kept] else _NO_BETTER
            self.note = f"'{name}' was found, but {why}"
        return fitted[:kept]

    def _step(self) -> list[tuple[Diagnosis, Rung]]:
        """Add the effects that were found, one after the other; where no test error falls with one, two together.

        Returns:
            The diagnoses that led to the new rungs, and these; empty where nothing helps.
        """
        diagnosis = self.diagnosis
        if diagnosis.findings:
            return self._chain(diagnosis.findings[: self._policy.most_steps - len(self.steps)])
        return self._pair() if diagnosis.refused is not None else []

    def _chain(self, findings: Iterable[Finding]) -> list[tuple[Diagnosis, Rung]]:
        """Return the rungs of a diagnosis's findings, each beside those before it."""
        refits, rungs = self.diagnosis.refits, []
        for finding in findings:
            stage(f"adding {finding.tested.name}")
            comparison = None if refits is None else refits.with_effect(finding.tested)
            if comparison is None or refits is None:
                break
            here = replace(self.diagnosis, comparison=refits.comparison, findings=(finding,))
            rungs.append((here, Rung(comparison, added=finding.tested.name)))
            refits = refits.beside(finding.tested)
        return rungs

    def _pair(self) -> list[tuple[Diagnosis, Rung]]:
        """Add two effects of which neither helps alone: what one brings may be lost in what is still missing.

        They are the first two of the set that the residual suggests, each found beside the other; not one that has
        another form than what is missing, or only imitates an unknown cause together with others.
        """
        judgement = self.diagnosis.judgement
        if judgement is None:
            return []
        firsts = [found.first for found, _ in judgement.members if not judgement.imitates(found.first)]
        possible = [t for t in firsts if not judgement.contradicts(t, self._policy)]
        pair = self._chain([Finding(tested, (tested.name,), "") for tested in possible[:2]])
        return pair if len(pair) == 2 and _test_error(pair[1][1].comparison) < _test_error(self._here) else []

    def _with(self, diagnosis: Diagnosis, tested: CandidateTest) -> Rung | None:
        """Return the diagnosed model with one more effect, refitted; ``None`` where that fails."""
        stage(f"adding {tested.name}")
        comparison = None if diagnosis.refits is None else diagnosis.refits.with_effect(tested)
        return None if comparison is None else Rung(comparison, added=tested.name)

    def _without(self, comparison: Comparison, name: str) -> Comparison:
        """Return a model without one of its effects, refitted: once as long as the model stays."""
        larger, known = self._smaller
        if larger is not comparison:
            known = {}
            self._smaller = (comparison, known)
        if name not in known:
            known[name] = refitted(comparison, comparison.drive.model.minus(name), comparison.estimate.parameters)
        return known[name]

    def prune(self) -> bool:
        """Remove every added effect that the others have made superfluous, or to nothing; whether any was."""
        comparison, policy = self._here, self._policy
        removed: list[str] = []
        while len(self._added) - len(removed) > 1:
            left = [name for name in self._added if name not in removed]
            void = next((name for name in left if is_void(comparison, name)), None)
            if void is not None:
                comparison = self._without(comparison, void)
                removed.append(void)
                continue
            tested = {name: necessity(comparison, name) for name in left}
            order = sorted(tested, key=lambda name: tested[name].gain)
            weakest, printed = order[0], comparison.errors.held_out_percent
            needed = tested[weakest].gain > policy.superfluous_gain and tested[weakest].p_value < policy.significance
            if needed or _rises(self._without(comparison, weakest), comparison, policy.removal_loss):
                # As on the way up: with every effect the printed test error falls, whatever the rows say.
                idle = (name for name in order if self._without(comparison, name).errors.held_out_percent <= printed)
                weakest = next(idle, "")
            if not weakest:
                break
            comparison = self._without(comparison, weakest)
            removed.append(weakest)
        if removed:
            comparison, before = numbered(comparison), self._added
            removed = [name for name in before if name not in {e.name for e in comparison.drive.model.effects}]
            self._superfluous.update(removed)
            self.rungs.append(Rung(from_scratch(comparison), removed="+".join(removed)))
        return bool(removed)

    def exchange(self) -> bool:
        """Look once more for each added effect, now that the others are there; whether another one took a place.

        The effect that was found first may have stood for the sum of what was missing then. If it is found again, its
        look-alikes are those that it has now.
        """
        changed = False
        for name in self._added if len(self._added) > 1 else []:
            smaller = self._without(self._here, name)
            stage(f"looking again for what is missing without {name}")
            seems = seems_missing(smaller, self._out_beside(), self._policy)
            if seems is None:
                continue
            refits = Refits(smaller, self._policy)
            if seems.first.name == name:
                self._update_look_alikes(name, self._as_near(name, seems, refits))
                continue
            trial = refits.with_effect(seems.first)
            if trial is None or not self._may_replace(trial, smaller):
                if name in seems.names:
                    self._update_look_alikes(name, self._as_near(name, seems, refits))
                continue
            diagnosis = self._examine(smaller)
            if not diagnosis.findings:
                continue
            found = diagnosis.findings[0]
            other = None if found.tested.name == name else self._with(diagnosis, found.tested)
            if other is not None and self._may_replace(other.comparison, smaller):
                self._replace(name, smaller, other, diagnosis)
                changed = True
            elif name in found.names:
                self._update_look_alikes(name, found.names)
        return changed

    def _out_beside(self) -> set[str]:
        """Return what is not considered in the place of an effect: nor what does not help the larger model."""
        refused = self.diagnosis.refused
        return self._out if refused is None else self._out | {refused.name}

    def simplify(self) -> bool:
        """Put an effect with fewer parameters in the place of one that, with all others there, does no more than it."""
        changed = False
        for name in self._added if len(self._added) > 1 else []:
            here, step = self._here, self.steps[self._place(name)]
            own = next(e for e in here.drive.model.effects if e.name == name)
            simpler = [t for t in step.passing if len(t.effect.parameters) < len(own.parameters)]
            simpler.sort(key=lambda t: len(t.effect.parameters))
            chosen = [t for t in simpler if t.name not in self._added][: self._policy.step_trials]
            smaller = self._without(here, name) if chosen else here
            near = comes_near(smaller, name, self._out_beside(), self._policy) if chosen else set()
            for tested in [t for t in chosen if t.name in near]:
                other = refitted(smaller, smaller.drive.model.plus(tested.effect), here.estimate.parameters)
                if self._may_replace(other, smaller) and not is_undetermined(other, tested.name):
                    self._replace(name, smaller, Rung(other, added=tested.name), step)
                    changed = True
                    break
        return changed

    def _replace(self, name: str, smaller: Comparison, other: Rung, diagnosis: Diagnosis) -> None:
        rungs = [Rung(smaller, removed=name), other]
        rungs = [replace(rung, comparison=from_scratch(rung.comparison)) for rung in rungs]
        self.rungs += rungs  # both or, where this is stopped, none
        self.steps.append(diagnosis)

    def _may_replace(self, other: Comparison, smaller: Comparison) -> bool:
        """Whether a model may take the place of the present one.

        Its effect lowers the printed test error of the model without either, as every effect of the ladder does.
        Its test error is as low, or clearly lower where it has more parameters. Or it leaves nothing that could be
        predicted where the present one does, with nearly the same test error.
        """
        here, policy = self._here, self._policy
        if other.errors.held_out_percent >= smaller.errors.held_out_percent:
            return False
        share = _test_error(other) / _test_error(here)
        larger = len(other.drive.model.parameters) > len(here.drive.model.parameters)
        if not (larger and share > 1 - policy.exchange_margin) and not _rises(other, here, policy.exchange_margin):
            return True
        if self.diagnosis.verdict != "unknown-effect" or share > policy.exchange_for_adequate:
            return False
        return not is_predictable(other, policy) and self._examine(other).verdict == "adequate"

    def _place(self, name: str) -> int:
        """Return which step last added an effect."""
        names = [rung.added for rung in self.rungs if rung.added]
        return len(names) - 1 - names[::-1].index(name)

    def _as_near(self, name: str, seems: LookAlikes, refits: Refits) -> list[str]:
        """Return which of a class explain as much as an effect of it, fitted in its place beside all others."""
        least = _test_error(self._here)
        return [t.name for t in seems.members if t.name == name or refits.leaves_as_much(t, least)]

    def _update_look_alikes(self, name: str, again: Iterable[str]) -> None:
        """Take the look-alikes that an effect has now that the others are there."""
        place = self._place(name)
        first, *others = self.steps[place].findings
        if first.tested.name == name:
            names = [name, *(other for other in again if other != name)]
            first = replace(first, names=tuple(names), separated_by=separated_by(names))
            self.steps[place] = replace(self.steps[place], findings=(first, *others))


def _beside(step: Diagnosis, added: set[str]) -> Diagnosis:
    """Return a step whose effect is no look-alike of those that were added beside it."""
    first, *others = step.findings
    names = [name for name in first.names if name == first.tested.name or name not in added]
    if len(names) == len(first.names):
        return step
    first = replace(first, names=tuple(names), separated_by=separated_by(names))
    return replace(step, findings=(first, *others))


def _test_error(comparison: Comparison) -> float:
    return comparison.sliding.held_out_percent


def _rises(simpler: Comparison, comparison: Comparison, share: float) -> bool:
    """Whether the test error of the simpler model is larger by more than a share, in any window."""
    pairs = zip(simpler.errors.bands, comparison.errors.bands, strict=True)
    windows = [(one.held_out_percent, other.held_out_percent) for one, other in pairs]
    windows.append((_test_error(simpler), _test_error(comparison)))
    return any(one > (1 + share) * other for one, other in windows)
