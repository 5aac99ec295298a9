"""``fricmodels compare``: model against measurement, and where it fails."""

from __future__ import annotations

from fricmodels.cli.measurement import Measurement, measured
from fricmodels.cli.motion import Score


@measured("leave_out", writes=("overlay.csv", "motion.json"))
def command(given: Measurement) -> None:
    """Fit a model to a recording and show where it fails.

    The model of a file of `fit` is fitted anew from its numbers; with --fixed it is compared as it is. With --score
    position its motion is simulated too.
    """
    from fricmodels.cli.printing import console, working
    from fricmodels.diagnosis import compare
    from fricmodels.diagnosis.overlay import write_overlay
    from fricmodels.diagnosis.present import show_comparison
    from fricmodels.progress import watched
    from fricmodels.report.console import show_answer_of_comparison

    shown = console()
    with working(f"fitting {given.model.name}") as say, watched(say):
        comparison = compare(given.recording, given.model, given.inertia)
    if given.verbose:
        show_comparison(shown, comparison)
    show_answer_of_comparison(shown, comparison)
    if given.out is not None:
        shown.print(f"wrote {write_overlay(comparison, given.out)}", markup=False, soft_wrap=True)
    judged = []
    if given.score is Score.POSITION:
        from fricmodels.cli.motion import by_motion

        known = given.of_controller
        judged = by_motion(shown, [comparison], given.horizon, given.loop, given.out, known=known)
    given.write_report(shown, lambda story: story.of_comparison(comparison, given.options, judged))
