"""One measured recording from a base law to an improved one, and how it fares on recordings that took no part."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis import Comparison, Diagnosis, Ladder, compare_model, diagnose, improve, ready
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.explain import explain
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import headline_window, torque_error_over
from fricmodels.split import Split
from fricmodels.tournament import load_config, run

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Story:
    """What the program said of one recording.

    Attributes:
        recording: prepared.
        ladder: from the base law to the improved model.
        checks: recordings that took no part, prepared, by name.
        seconds: that `improve` took.
    """

    recording: Recording
    ladder: Ladder
    checks: Mapping[str, Recording] = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def final(self) -> Comparison:
        """The improved model on its recording."""
        return self.ladder.rungs[-1].comparison

    @property
    def base(self) -> Comparison:
        """The base law on the recording."""
        return self.ladder.rungs[0].comparison


def tell(
    recording: Recording,
    model: str,
    inertia: float | None = None,
    checks: Mapping[str, Recording] | None = None,
    how: Split | None = None,
) -> Story:
    """Improve a model on a recording; ``how`` says what of it is kept back."""
    start = time.process_time()
    ladder = improve(recording, Model.parse(model), inertia, how=how)
    seconds = time.process_time() - start
    others = {name: ready(check) for name, check in (checks or {}).items()}
    return Story(ready(recording), ladder, others, seconds)


def percent(comparison: Comparison, recording: Recording) -> float:
    """Return the RMS torque error of a fitted model on another recording, in % of its RMS motor torque."""
    window = headline_window(comparison.train, comparison.drive.inertia)
    error = torque_error_over(comparison.drive, comparison.estimate.parameters, recording, window)
    return 100 * float(np.sqrt(np.mean(error**2) / np.mean(recording.torque**2)))


# ---- tables -------------------------------------------------------------------------------------------------------


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def ladder_table(story: Story) -> str:
    """Return the error after each step: fitted, kept back, and on the recordings that took no part."""
    rows = []
    for rung in story.ladder.rungs:
        errors = rung.comparison.errors
        step = f"+ {rung.added}" if rung.added else (f"− {rung.removed}" if rung.removed else "")
        others = [f"{percent(rung.comparison, check):.2f} %" for check in story.checks.values()]
        rows.append([step, f"`{rung.model}`", f"{errors.percent:.2f} %", f"{errors.held_out_percent:.2f} %", *others])
    return table(["step", "model", "fit error", "test error", *story.checks], rows)


def where_table(comparison: Comparison, most: int = 6) -> str:
    """Return the regimes in which a model fails most."""
    rows = [
        [row.regime, f"{100 * row.share_of_squared_error:.0f} %", f"{100 * row.share_of_samples:.0f} %"]
        for row in comparison.where[:most]
    ]
    return table(["regime", "share of the squared error", "share of the samples"], rows)


def evidence_table(story: Story) -> str:
    """Return what spoke for each effect when it was named, with its class."""
    rows = []
    for diagnosis in (*story.ladder.steps, story.ladder.last):
        if not diagnosis.findings:
            continue
        finding = diagnosis.findings[0]
        evidence = finding.tested.evidence
        rows.append(
            [
                f"`{diagnosis.comparison.drive.model.name}`",
                ", ".join(f"`{name}`" for name in finding.names),
                f"{finding.tested.adjusted:.1e}",
                f"{100 * evidence.explained:.0f} %",
                f"{100 * evidence.gain:.0f} %",
            ]
        )
    head = ["model under test", "named, with its look-alikes", "p", "share of the residual", "gain on unused blocks"]
    return table(head, rows) if rows else "Nothing was named."


def parameter_table(comparison: Comparison, published: Mapping[str, str] | None = None) -> str:
    """Return the parameters of a model with standard errors, beside published ones where there are any."""
    motion = comparison.drive.motion
    units = {p.key: p.declared.unit_for(motion) for p in comparison.drive.parameters}
    rows = []
    for key, value in comparison.estimate.parameters.items():
        if key not in units:
            continue
        error = comparison.estimate.standard_errors.get(key, 0.0)
        row = [key, f"{value:.4g} ± {error:.2g}", units[key]]
        rows.append([*row, published.get(key, "")] if published else row)
    return table(["parameter", "found", "unit", *(["published"] if published else [])], rows)


def visibility_table(diagnosis: Diagnosis) -> str:
    """Return what was not found: from which size on it would have been, or why it could not be."""
    rows = []
    for name, row in diagnosis.visibility.items():
        size = "" if row.missing else f"{row.smallest_percent:.2g} % of the RMS torque"
        rows.append([f"`{name}`", size, row.missing or ""])
    return table(["not found", "would have been seen from", "could not have been seen, because"], rows)


def independent_table(recordings: Mapping[str, Recording], model: str, inertia: float | None = None) -> str:
    """Diagnose the same base law on other recordings, each by itself."""
    rows = []
    for name, recording in recordings.items():
        diagnosis = diagnose(recording, Model.parse(model), inertia)
        errors = diagnosis.comparison.errors
        first = diagnosis.findings[0] if diagnosis.findings else None
        values = "" if first is None else ", ".join(f"{k} = {v:.3g}" for k, v in first.tested.parameters.items())
        rows.append(
            [
                name,
                f"{errors.percent:.2f} %",
                diagnosis.verdict,
                ", ".join(f"`{n}`" for n in first.names) if first else "",
                values,
                ", ".join(f"`{n}`" for f in diagnosis.findings[1:] for n in f.names),
            ]
        )
    return table(["recording", "error", "verdict", "named", "parameters (SI)", "further"], rows)


def blocks(story: Story, published: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return the parts of a page that are the same for every story."""
    ladder = story.ladder
    return {
        "words": "> " + explain(ladder.first, ladder).replace("\n", "\n> "),
        "ladder": ladder_table(story),
        "where_before": where_table(story.base),
        "where_after": where_table(story.final),
        "evidence": evidence_table(story),
        "parameters": parameter_table(story.final, published),
        "visibility": visibility_table(ladder.last),
        "verdict": ladder.last.verdict,
        "floor": f"{story.final.noise_floor_percent:.2g}",
        "seconds": f"{story.seconds:.0f}",
        "note": f"{ladder.note}." if ladder.note else "",
    }


def leaderboard(config: Path) -> list[dict[str, Any]]:
    """Run a tournament in a temporary directory and return its rows, the best first."""
    with tempfile.TemporaryDirectory() as out:
        return [dict(row) for row in run(load_config(config), out, directory=config.parent).rows]


def leaderboard_table(config: Path) -> str:
    """Return a tournament's figures: another estimator's fit of the same models."""
    rows = []
    for row in leaderboard(config):
        keys = ("rms_torque_error_percent", "held_out_rms_torque_error_percent")
        errors = [f"{row[key]:.2f} %" if row[key] is not None else row["status"] for key in keys]
        rows.append([row["dataset"], f"`{row['model']}`", f"`{row['estimator']}`", *errors])
    return table(["recording", "model", "estimator", "fit error", "test error"], rows)


def by_hand_table(story: Story, model: str, additions: Sequence[str]) -> str:
    """Add effects to a model, whatever the diagnosis said of them, and return the errors.

    Args:
        story: gives the data and the checks.
        model: to add to.
        additions: effects, or several joined by ``+``. Their nonlinear parameters start where the survey of ``model``
            finds them.
    """
    inertia, train, test = story.base.drive.inertia, story.base.train, story.base.test
    before = compare_model(train, test, Drive(Model.parse(model), inertia, story.recording.motion))
    rows = [_errors_row(model, before, story.checks)]
    for addition in additions:
        name = f"{model}+{addition}"
        drive = Drive(Model.parse(name), inertia, story.recording.motion)
        try:
            comparison = compare_model(train, test, drive, _start(before, addition.split("+")))
        except FricmodelsError as error:
            rows.append([f"`{name}`", f"not fitted: {error}", "", *[""] * len(story.checks)])
            continue
        rows.append(_errors_row(name, comparison, story.checks))
    return table(["model", "fit error", "test error", *story.checks], rows)


def _start(comparison: Comparison, effects: Sequence[str]) -> dict[str, float]:
    """Return where the survey of a fitted model finds the effects' parameters."""
    found = candidate_tests(comparison.problem, comparison.estimate.parameters, only=effects)
    own = {f"{t.name}.{symbol}": value for t in found.tested for symbol, value in t.parameters.items()}
    return {**comparison.estimate.parameters, **own}


def _errors_row(name: str, comparison: Comparison, checks: Mapping[str, Recording]) -> list[str]:
    errors = comparison.errors
    others = [f"{percent(comparison, check):.2f} %" for check in checks.values()]
    return [f"`{name}`", f"{errors.percent:.2f} %", f"{errors.held_out_percent:.2f} %", *others]


def summary_table(stories: Mapping[str, Story]) -> str:
    """Return one line a story: from which error to which, and by what."""
    checks = next(iter(stories.values())).checks
    rows = []
    for name, story in stories.items():
        first, last = story.base.errors, story.final.errors
        steps = [d for d in (*story.ladder.steps, story.ladder.last) if d.findings]
        named = "; ".join(", ".join(f"`{n}`" for n in d.findings[0].names) for d in steps)
        p_values = "; ".join(f"{d.findings[0].tested.adjusted:.0e}" for d in steps)
        others = [f"{percent(story.base, c):.1f} → {percent(story.final, c):.1f} %" for c in story.checks.values()]
        rows.append(
            [
                name,
                f"`{story.ladder.rungs[-1].model}`",
                f"{first.percent:.1f} → {last.percent:.1f} %",
                f"{first.held_out_percent:.1f} → {last.held_out_percent:.1f} %",
                *others,
                named,
                p_values,
                story.ladder.last.verdict + (f"; {story.ladder.note}" if story.ladder.note else ""),
            ]
        )
    head = [
        "",
        "model at the end",
        "fit error",
        "test error",
        *checks,
        "named, step by step",
        "p",
        "verdict at the end",
    ]
    return table(head, rows)
