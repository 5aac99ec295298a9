"""``fricmodels improve``: add what is missing, refit, repeat."""

from __future__ import annotations

from fricmodels.cli.measurement import Measurement, measured
from fricmodels.cli.motion import Score


@measured(writes=("diagnosis.json", "model.json", "motion.json", ".improve.jsonl"))
def command(given: Measurement) -> None:
    """Add the missing effect, refit everything, and repeat until nothing is missing: the ladder.

    Stopped by Ctrl-C it shows, and writes, what was found so far. With --out, what was found is kept on the way: an
    improvement that was stopped or interrupted goes on from there, by the same command, to the same end.

    With --score position each rung is fitted to the simulated motion too, and the one is kept that simulates best what
    was not fitted.
    """
    from contextlib import ExitStack

    from fricmodels.cli.answers import Stopped, so_far
    from fricmodels.cli.printing import console, warn, working
    from fricmodels.diagnosis import improve
    from fricmodels.diagnosis.document import document, write
    from fricmodels.diagnosis.journal import FILE, Journal, identity, journal
    from fricmodels.diagnosis.present import show_comparison, show_diagnosis, show_ladder
    from fricmodels.progress import Cancelled
    from fricmodels.report.console import show_answer_of_ladder

    shown = console()
    with ExitStack() as stack:
        kept: Journal | None = None
        if given.out is not None:
            decides = (given.model.name, given.model.known, given.inertia, given.leave_out)
            kept = stack.enter_context(journal(given.out / FILE, identity(given.recording, *decides)))
            if len(kept):
                warn(
                    [f"going on after {len(kept)} step{'s' * (len(kept) != 1)} of an improvement that was interrupted"]
                )
        try:
            with working("improving") as say:
                ladder = improve(given.recording, given.model, given.inertia, leave_out=given.leave_out, progress=say)
        except Cancelled as stopped:
            if kept is not None:
                kept.close()  # it stays, so that the same command goes on from there
            ladder = so_far(shown, stopped)
        if given.verbose:
            show_comparison(shown, ladder.first.comparison)
            show_diagnosis(shown, ladder.first, ladder)
            show_ladder(shown, ladder)
            show_comparison(shown, ladder.rungs[-1].comparison)
        show_answer_of_ladder(shown, ladder, given.options)
        judged, best = [], ladder.rungs[-1].comparison
        if given.score is Score.POSITION and not ladder.partial:
            from fricmodels.cli.motion import by_motion, taken

            rungs = list({rung.model: rung.comparison for rung in ladder.rungs}.values())
            judged = by_motion(shown, rungs, given.horizon, given.loop, given.out, known=given.of_controller)
            best = taken(rungs, judged)
        if given.out is not None:
            from fricmodels.saved import keep

            shown.print(f"wrote {write(document(ladder.first, ladder), given.out)}", markup=False, soft_wrap=True)
            saved = keep(best).save(given.out / "model.json")
            shown.print(f"wrote {saved}", markup=False, soft_wrap=True)
    given.write_report(shown, lambda story: story.of_ladder(ladder, given.options, judged))
    if ladder.partial:
        raise Stopped
