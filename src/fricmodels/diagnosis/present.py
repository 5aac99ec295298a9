"""Comparisons, diagnoses and ladders as text for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console
from rich.table import Table

from fricmodels.diagnosis.diagnose import Comparison, Diagnosis
from fricmodels.diagnosis.explain import explain
from fricmodels.diagnosis.ladder import Ladder, added

_MOST_REGIMES = 8
_LONGEST_BAR = 20


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
    for finding in diagnosis.findings if ladder is None else added(ladder):
        motion = diagnosis.comparison.drive.motion
        values = finding.tested.parameters
        listed = ", ".join(
            f"{p.symbol} = {values[p.symbol]:.4g} {p.unit_for(motion)}".removesuffix(" 1")
            for p in finding.tested.effect.parameters
        )
        console.print(f"  {finding.tested.name}: {listed}", highlight=False)
    final = diagnosis if ladder is None else ladder.last
    blind = {name: row.missing for name, row in final.visibility.items() if row.missing}
    seen = {name: row.smallest_percent for name, row in final.visibility.items() if not row.missing}
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
    most = max(rung.comparison.errors.held_out_percent for rung in ladder.rungs) or 1.0
    table = Table(title="The ladder", title_justify="left")
    table.add_column("model", overflow="fold")
    for heading in ("error fitted", "error kept back", ""):
        table.add_column(heading, no_wrap=True)
    for rung in ladder.rungs:
        errors = rung.comparison.errors
        bar = "█" * max(1, round(_LONGEST_BAR * errors.held_out_percent / most))
        table.add_row(rung.model, f"{errors.percent:.3g} %", f"{errors.held_out_percent:.3g} %", bar)
    console.print(table)
