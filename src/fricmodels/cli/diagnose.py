"""``fricmodels diagnose``: which effect is missing."""

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
    """Name the effect that a model is missing, with its evidence, or say that the data cannot tell."""
    recording, chosen = load(data, model, column, torque_constant, reader, linear, leave_out)
    if report is not None:
        from fricmodels.report import check

        check(report)
    from rich.console import Console

    from fricmodels.diagnosis import diagnose
    from fricmodels.diagnosis.document import document, write
    from fricmodels.diagnosis.present import show_comparison, show_diagnosis

    console = Console()
    with console.status("testing effects"):
        diagnosis = diagnose(recording, chosen, inertia, leave_out=leave_out or ())
    show_comparison(console, diagnosis.comparison)
    show_diagnosis(console, diagnosis)
    if out is not None:
        console.print(f"wrote {write(document(diagnosis), out)}")
    if report is not None:
        from fricmodels.report import story
        from fricmodels.report import write as write_report

        options = [part for name in leave_out or () for part in ("--leave-out", name)]
        console.print(f"wrote {write_report(story.of_diagnosis(diagnosis, options), report)}")
