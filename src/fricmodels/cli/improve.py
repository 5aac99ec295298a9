"""``fricmodels improve``: add what is missing, refit, repeat."""

from __future__ import annotations

from fricmodels.cli.measurement import Measurement, measured


@measured
def command(given: Measurement) -> None:
    """Add the missing effect, refit everything, and repeat until nothing is missing: the ladder."""
    from rich.console import Console

    from fricmodels.diagnosis import improve
    from fricmodels.diagnosis.document import document, write
    from fricmodels.diagnosis.present import show_comparison, show_diagnosis, show_ladder

    console = Console()
    with console.status("improving") as status:
        ladder = improve(given.recording, given.model, given.inertia, leave_out=given.leave_out, progress=status.update)
    show_comparison(console, ladder.first.comparison)
    show_diagnosis(console, ladder.first, ladder)
    show_ladder(console, ladder)
    show_comparison(console, ladder.rungs[-1].comparison)
    if given.out is not None:
        from fricmodels.saved import keep

        console.print(f"wrote {write(document(ladder.first, ladder), given.out)}")
        console.print(f"wrote {keep(ladder).save(given.out / 'model.json')}")
    if given.report is not None:
        from fricmodels.report import story
        from fricmodels.report import write as write_report

        console.print(f"wrote {write_report(story.of_ladder(ladder, given.options), given.report)}")
