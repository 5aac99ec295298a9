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
    Verbose,
    check,
    gaps_option,
    load,
)
from fricmodels.cli.motion import ControllerFile, Horizon, Score, ScoreOption, check_score, loop_of


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
    verbose: Verbose = False,
    score: ScoreOption = Score.TORQUE,
    horizon: Horizon = None,
    controller: ControllerFile = None,
) -> None:
    """Fit a model to a recording and show where it fails.

    The model of a file of `fit` is fitted anew from its numbers; with --fixed it is compared as it is. With --score
    position its motion is simulated too.
    """
    given = load(data, model, column, torque_constant, reader, linear, None, inertia, trust, gaps, fixed)
    recording, chosen = given.recording, given.model
    check(report)
    check_score(score, recording, horizon, controller)
    loop = loop_of(controller, recording, given.file if score is Score.POSITION else None)
    from fricmodels.cli.answers import answered
    from fricmodels.cli.printing import console, working
    from fricmodels.diagnosis import compare
    from fricmodels.diagnosis.overlay import write_overlay
    from fricmodels.diagnosis.present import show_comparison
    from fricmodels.progress import watched
    from fricmodels.report.console import show_answer_of_comparison

    with answered(recording, chosen):
        shown = console()
        with working(f"fitting {chosen.name}") as say, watched(say):
            comparison = compare(recording, chosen, given.inertia)
        if verbose:
            show_comparison(shown, comparison)
        show_answer_of_comparison(shown, comparison)
        if out is not None:
            shown.print(f"wrote {write_overlay(comparison, out)}", markup=False, soft_wrap=True)
        judged = []
        if score is Score.POSITION:
            from fricmodels.cli.motion import by_motion

            judged = by_motion(shown, [comparison], horizon, loop, out, fixed=fixed, known=given.of_controller)
        if report is not None:
            from fricmodels.report import story
            from fricmodels.report import write as write_report

            page = story.of_comparison(comparison, ["--trust"] * trust + gaps_option(gaps), judged)
            shown.print(f"wrote {write_report(page, report)}", markup=False, soft_wrap=True)
