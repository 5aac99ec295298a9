"""``fricmodels diagnose``: which effect is missing."""

from __future__ import annotations

from fricmodels.cli.measurement import OF_MOTION, Measurement, measured


@measured(*OF_MOTION, writes=("diagnosis.json",))
def command(given: Measurement) -> None:
    """Name the effect that a model is missing, with its evidence, or say that the data cannot tell."""
    from fricmodels.cli.answers import so_far
    from fricmodels.cli.printing import console, working
    from fricmodels.diagnosis import diagnose
    from fricmodels.diagnosis.document import document, write
    from fricmodels.diagnosis.present import show_diagnosis
    from fricmodels.progress import Cancelled
    from fricmodels.report.console import show_answer_of_diagnosis

    shown = console()
    try:
        with working("testing effects") as say:
            diagnosis = diagnose(given.recording, given.model, given.inertia, leave_out=given.leave_out, progress=say)
    except Cancelled as stopped:
        so_far(shown, stopped)
        raise
    if given.verbose:
        show_diagnosis(shown, diagnosis)
    show_answer_of_diagnosis(shown, diagnosis, given.options)
    if given.out is not None:
        shown.print(f"wrote {write(document(diagnosis), given.out)}", markup=False, soft_wrap=True)
    given.write_report(shown, lambda story: story.of_diagnosis(diagnosis, given.options))
