"""``fricmodels diagnose``: which effect is missing."""

from __future__ import annotations

from fricmodels.cli.measurement import Measurement, measured


@measured
def command(given: Measurement) -> None:
    """Name the effect that a model is missing, with its evidence, or say that the data cannot tell."""
    from rich.console import Console

    from fricmodels.diagnosis import diagnose
    from fricmodels.diagnosis.document import document, write
    from fricmodels.diagnosis.present import show_comparison, show_diagnosis

    console = Console()
    with console.status("testing effects"):
        diagnosis = diagnose(given.recording, given.model, given.inertia, leave_out=given.leave_out)
    show_comparison(console, diagnosis.comparison)
    show_diagnosis(console, diagnosis)
    if given.out is not None:
        console.print(f"wrote {write(document(diagnosis), given.out)}")
    if given.report is not None:
        from fricmodels.report import story
        from fricmodels.report import write as write_report

        console.print(f"wrote {write_report(story.of_diagnosis(diagnosis, given.options), given.report)}")
