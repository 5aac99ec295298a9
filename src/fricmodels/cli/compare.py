"""``fricmodels compare``: model against measurement, and where it fails."""

from __future__ import annotations

from fricmodels.cli.measurement import (
    Column,
    Data,
    Fixed,
    Format,
    GapsOption,
    Inertia,
    Linear,
    ModelName,
    Out,
    Report,
    TorqueConstant,
    Trust,
    check,
    gaps_option,
    load,
)


def command(
    data: Data,
    model: ModelName,
    inertia: Inertia = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    linear: Linear = False,
    trust: Trust = False,
    gaps: GapsOption = None,
    fixed: Fixed = False,
    out: Out = None,
    report: Report = None,
) -> None:
    """Fit a model to a recording and show where it fails.

    The model of a file of `fit` is fitted anew from its numbers; with --fixed it is compared as it is.
    """
    given = load(data, model, column, torque_constant, reader, linear, None, inertia, trust, gaps, fixed)
    recording, chosen = given.recording, given.model
    check(report)
    from rich.console import Console

    from fricmodels.cli.answers import answered
    from fricmodels.diagnosis import compare
    from fricmodels.diagnosis.overlay import write_overlay
    from fricmodels.diagnosis.present import show_comparison

    with answered(recording, chosen):
        comparison = compare(recording, chosen, given.inertia)
        console = Console()
        show_comparison(console, comparison)
        if out is not None:
            console.print(f"wrote {write_overlay(comparison, out)}")
        if report is not None:
            from fricmodels.report import story
            from fricmodels.report import write as write_report

            page = story.of_comparison(comparison, ["--trust"] * trust + gaps_option(gaps))
            console.print(f"wrote {write_report(page, report)}")
