"""``fricmodels improve``: add what is missing, refit, repeat."""

from __future__ import annotations

from fricmodels.cli.measurement import (
    Column,
    Data,
    Format,
    Inertia,
    LeaveOut,
    Linear,
    ModelName,
    Out,
    Report,
    TorqueConstant,
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
    leave_out: LeaveOut = None,
    out: Out = None,
    report: Report = None,
) -> None:
    """Add the missing effect, refit everything, and repeat until nothing is missing: the ladder."""
    recording, chosen = load(data, model, column, torque_constant, reader, linear, leave_out)
    if report is not None:
        from fricmodels.report import check

        check(report)
    from rich.console import Console

    from fricmodels.diagnosis import improve
    from fricmodels.diagnosis.document import document, write
    from fricmodels.diagnosis.present import show_comparison, show_diagnosis, show_ladder

    console = Console()
    with console.status("improving") as status:
        ladder = improve(recording, chosen, inertia, leave_out=leave_out or (), progress=status.update)
    show_comparison(console, ladder.first.comparison)
    show_diagnosis(console, ladder.first, ladder)
    show_ladder(console, ladder)
    show_comparison(console, ladder.rungs[-1].comparison)
    if out is not None:
        console.print(f"wrote {write(document(ladder.first, ladder), out)}")
    if report is not None:
        from fricmodels.report import story
        from fricmodels.report import write as write_report

        options = [part for name in leave_out or () for part in ("--leave-out", name)]
        console.print(f"wrote {write_report(story.of_ladder(ladder, options), report)}")
