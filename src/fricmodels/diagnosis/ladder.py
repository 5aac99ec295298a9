"""Adds what is missing, refits, and repeats: the ladder on which the error falls."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from fricmodels import plugins
from fricmodels.diagnosis.diagnose import Comparison, Diagnosis, Finding, compare, compare_model, examine
from fricmodels.diagnosis.evidence import Evidence, Regression
from fricmodels.diagnosis.problem import Problem
from fricmodels.diagnosis.survey import Tested
from fricmodels.diagnosis.verdict import LEAST_GAIN, SIGNIFICANCE
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.shown import Shown

MOST_TRIALS = 4
"""So many of the effects that pass are tried before a step is given up."""
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
    """Add the missing effect, refit everything, repeat until nothing is missing; then try to remove each effect.

    An effect stays only if it lowers the error on data that took no part in finding it.

    Args:
        recording: as read.
        model: law plus effects to begin from, or its name.
        inertia: J [kg m²] or M [kg]; estimated if not given.
        leave_out: effects that are not considered.
        progress: called with one line at every step.
    """
    say = progress or (lambda line: None)
    out = set(leave_out)
    model = Model.of(model)
    say(f"fitting {model.name}")
    comparison = compare(recording, model, inertia)
    say(f"testing effects on {model.name}")
    first = diagnosis = examine(comparison, leave_out=out)
    rungs, steps, note = [Rung(comparison)], [diagnosis], ""
    while diagnosis.findings and len(steps) <= MOST_STEPS:
        trial, finding, refused = _step(comparison, diagnosis, recording, inertia, say)
        if trial is None or finding is None:
            note = f"'{refused}' was found, but the error on data kept back does not fall with it"
            break
        comparison = trial
        rungs.append(Rung(comparison, added=finding))
        say(f"testing effects on {comparison.drive.model.name}")
        diagnosis = examine(comparison, leave_out=out)
        steps.append(diagnosis)
    comparison, removed = _pruned(comparison, {e.name for e in model.effects}, recording, inertia)
    if removed:
        rungs.append(Rung(comparison, removed="+".join(removed)))
        diagnosis = examine(comparison, leave_out=out | set(removed))
    return Ladder(first, tuple(rungs), diagnosis, tuple(steps), note)


def _step(
    comparison: Comparison,
    diagnosis: Diagnosis,
    recording: Recording,
    inertia: float | None,
    say: Callable[[str], None],
) -> tuple[Comparison | None, str | None, str]:
    """Add the effect that was found; where it does not help on data kept back, the one that does so most.

    Returns:
        The new comparison and the effect that was added, if any helps, and the effect that did not.
    """
    first = diagnosis.findings[0].tested

    def trial(tested: Tested) -> Comparison:
        say(f"adding {tested.name}")
        model = comparison.drive.model.plus(plugins.load().effects[tested.name]())
        start = {**comparison.estimate.parameters, **_keyed(tested.name, tested.parameters)}
        try:
            return compare_model(comparison.train, comparison.test, Drive(model, inertia, recording.motion), start)
        except FricmodelsError:
            return comparison

    bigger = trial(first)
    if bigger.errors.held_out_percent < comparison.errors.held_out_percent:
        return bigger, first.name, ""
    others = [t for t in diagnosis.passing if t.name != first.name][: MOST_TRIALS - 1]
    best = min(((trial(t), t.name) for t in others), key=lambda pair: pair[0].errors.held_out_percent, default=None)
    if best is None or not best[0].errors.held_out_percent < comparison.errors.held_out_percent:
        return None, None, first.name
    return best[0], best[1], first.name


def added(ladder: Ladder) -> list[Finding]:
    """Return the findings that the ladder added and kept, in order; where it kept none, what the first step found."""
    kept = {effect.name for effect in ladder.rungs[-1].comparison.drive.model.effects}
    chosen = []
    for step, rung in zip(ladder.steps, (rung for rung in ladder.rungs if rung.added), strict=False):
        first = step.findings[0]
        if rung.added not in kept:
            continue
        if rung.added == first.tested.name:
            chosen.append(first)
            continue
        own = next(t for t in step.passing if t.name == rung.added)
        chosen.append(Finding(own, (own.name,), ""))
    return chosen or list(ladder.first.findings)


def _keyed(effect: str, parameters: Mapping[str, float]) -> dict[str, float]:
    return {f"{effect}.{symbol}": value for symbol, value in parameters.items()}


def _pruned(
    comparison: Comparison, given: set[str], recording: Recording, inertia: float | None
) -> tuple[Comparison, list[str]]:
    """Remove every added effect that the others have made superfluous; those that were given stay."""
    removed: list[str] = []
    while True:
        candidates = [e.name for e in comparison.drive.model.effects if e.name not in given]
        if len(candidates) < 2:
            return comparison, removed
        tested = {name: without(comparison, name) for name in candidates}
        weakest = min(tested, key=lambda name: tested[name].gain)
        evidence = tested[weakest]
        if evidence.gain > LEAST_GAIN / 2 and evidence.p_value < SIGNIFICANCE:
            return comparison, removed
        smaller = comparison.drive.model.minus(weakest)
        drive = Drive(smaller, inertia, recording.motion)
        simpler = compare_model(comparison.train, comparison.test, drive, comparison.estimate.parameters)
        if simpler.errors.held_out_percent > (1 + LEAST_GAIN) * comparison.errors.held_out_percent:
            return comparison, removed
        comparison = simpler
        removed.append(weakest)


def without(comparison: Comparison, effect: str) -> Evidence:
    """Test an effect of a fitted model, given all the rest of the model."""
    problem, parameters = comparison.problem, comparison.estimate.parameters
    drive = comparison.drive
    smaller = Drive(drive.model.minus(effect), drive.inertia, drive.motion)
    own = next(e for e in drive.model.effects if e.name == effect)
    alone = problem.alone(own)
    delay = 0.0
    if alone.model.delay:  # its own problem has the record without the delay
        problem, delay = Problem.of(smaller, comparison.train, parameters), problem.delay
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
