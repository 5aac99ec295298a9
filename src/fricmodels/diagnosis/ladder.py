"""The ladder on which the test error falls: every model on the way, and the diagnoses that led there."""

from __future__ import annotations

from dataclasses import dataclass

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.diagnose import Diagnosis, Finding
from fricmodels.display import Displayed


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
class Ladder(Displayed):
    """From the model that was given to the best one.

    Attributes:
        first: diagnosis of the model that was given.
        rungs: every model on the way, the given one first.
        last: diagnosis of the final model.
        steps: the diagnoses that led to each added effect.
        note: why the ladder ended where it did, if not because the model became adequate.
        partial: whether it was stopped before its end: what remains on the last rung was not looked at.
    """

    first: Diagnosis
    rungs: tuple[Rung, ...]
    last: Diagnosis
    steps: tuple[Diagnosis, ...]
    note: str = ""
    partial: bool = False


def added(ladder: Ladder) -> list[Finding]:
    """Return the findings that the ladder added and kept, in order; where it kept none, what the first step found."""
    kept = {effect.name for effect in ladder.rungs[-1].comparison.drive.model.effects}
    chosen: dict[str, Finding] = {}
    for step, rung in zip(ladder.steps, (rung for rung in ladder.rungs if rung.added), strict=True):
        first = step.findings[0]
        if rung.added not in kept:
            continue
        chosen.pop(rung.added, None)  # what was removed and found again is there since then
        if rung.added == first.tested.name:
            chosen[rung.added] = first
            continue
        own = next(t for t in step.passing if t.name == rung.added)
        chosen[rung.added] = Finding(own, (own.name,), "")
    return list(chosen.values()) or list(ladder.first.findings)
