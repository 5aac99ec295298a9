"""Comparisons, diagnoses and ladders as text for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.table import Table

from fricmodels.diagnosis.diagnose import Comparison, Diagnosis
from fricmodels.diagnosis.explain import explain
from fricmodels.diagnosis.ladder import Ladder

_MOST_REGIMES = 8


def show_comparison(console: Console, comparison: Comparison) -> None:
    """Print parameters, errors, and where the model fails."""
    drive, estimate = comparison.drive, comparison.estimate
    units = {p.key: p.declared.unit_for(drive.motion) for p in drive.parameters}
    table = Table("parameter", "value", "± (standard error)", "unit", title=drive.model.name, title_justify="left")
    for key, value in estimate.parameters.items():
        error = estimate.standard_errors.get(key)
        given = "given" if error is None else f"{error:.2g}"
        table.add_row(key, f"{value:.5g}", given, units.get(key, "kg m^2" if key == "J" else "kg"))
    console.print(table)
    errors = comparison.errors
    console.print(
        f"RMS torque error: {errors.SI:.4g} {'N m' if drive.motion == 'rotary' else 'N'}, {errors.percent:.3g} % of "
        f"the RMS motor torque; on data kept back {errors.held_out_percent:.3g} %; noise alone about "
        f"{comparison.noise_floor_percent:.2g} %"
    )
    where = Table("regime", "share of squared error", "share of samples", title="Where it fails", title_justify="left")
    for row in comparison.where[:_MOST_REGIMES]:
        where.add_row(row.regime, f"{100 * row.share_of_squared_error:.1f} %", f"{100 * row.share_of_samples:.1f} %")
    console.print(where)


def show_diagnosis(console: Console, diagnosis: Diagnosis, ladder: Ladder | None = None) -> None:
    """Print the verdict in words, the parameters found, and what could not have been seen."""
    console.print(f"Verdict: {diagnosis.verdict}", style="bold")
    console.print(explain(diagnosis, ladder), highlight=False)
    for finding in diagnosis.findings:
        motion = diagnosis.comparison.drive.motion
        values = finding.tested.parameters
        listed = ", ".join(
            f"{p.symbol} = {values[p.symbol]:.4g} {p.unit_for(motion)}" for p in finding.tested.effect.parameters
        )
        console.print(f"  {finding.tested.name}: {listed}", highlight=False)
    blind = {name: row.missing for name, row in diagnosis.visibility.items() if row.missing}
    seen = {name: row.smallest_percent for name, row in diagnosis.visibility.items() if not row.missing}
    _show_visibility(console, seen, blind)


def _show_visibility(console: Console, seen: Mapping[str, float], blind: Mapping[str, str]) -> None:
    if seen:
        table = Table("not found", "would have been from", title="Not found, though it could have been seen")
        for name, percent in seen.items():
            table.add_row(name, f"{percent:.2g} % of the RMS torque")
        console.print(table)
    if blind:
        table = Table("effect", "why this recording cannot show it", title="Could not have been seen")
        for name, reason in blind.items():
            table.add_row(name, reason)
        console.print(table)


def show_ladder(console: Console, ladder: Ladder) -> None:
    """Print the error after each step."""
    rows: Sequence[tuple[str, str, float, float]] = [
        (
            rung.model,
            f"+ {rung.added}" if rung.added else (f"- {rung.removed}" if rung.removed else ""),
            rung.comparison.errors.percent,
            rung.comparison.errors.held_out_percent,
        )
        for rung in ladder.rungs
    ]
    table = Table("step", "model", "error fitted", "error kept back", "", title="The ladder", title_justify="left")
    most = max(row[3] for row in rows) or 1.0
    for model, step, percent, held_out in rows:
        table.add_row(step, model, f"{percent:.3g} %", f"{held_out:.3g} %", "█" * max(1, round(24 * held_out / most)))
    console.print(table)
