"""``fricmodels report``: everything as one HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fricmodels.cli.measurement import (
    Column,
    Format,
    GapsOption,
    Inertia,
    LeaveOut,
    Linear,
    Reading,
    TorqueConstant,
    Trust,
    effects_left_out,
    load,
    options_again,
)


def command(
    target: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN|DATA…",
            help="Directory of results, or a recording; several files are one, each a run of it.",
            show_default=False,
        ),
    ],
    model: Annotated[
        str, typer.Option("--model", metavar="LAW+EFFECT+…", help="Model to improve on a recording.")
    ] = "coulomb-viscous",
    inertia: Inertia = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    linear: Linear = False,
    leave_out: LeaveOut = None,
    trust: Trust = False,
    gaps: GapsOption = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.html", help="File to write; RUN/report.html or DATA.html by default."),
    ] = None,
) -> None:
    """Write it all as one HTML page: verdict, figures, parameters, provenance.

    RUN is what `run`, `diagnose` or `improve` wrote with --out. DATA is a recording; it is diagnosed and the model
    improved as by `improve`. The page needs no network and no other file.
    """
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.cli.printing import working
    from fricmodels.progress import watched
    from fricmodels.report import check, files_of_run, of_run, story, write

    first = target[0]
    if len(target) == 1 and (first.is_dir() or first.suffix == ".json"):
        page = out or (first if first.is_dir() else first.parent) / "report.html"
        check_outputs([page], files_of_run(first))
        with working("writing the report") as say, watched(say):
            written = write(of_run(first), page)
        print(f"wrote {written}")
        return
    page = out or Path(f"{first.stem}.html")
    check_outputs([page], [*target, model])
    check(page)
    reading = Reading(column, torque_constant, reader, linear, gaps)
    given = load(target, model, reading, leave_out=leave_out, inertia=inertia, trust=trust)
    recording, chosen = given.recording, given.model
    from fricmodels.cli.answers import Stopped, answered, so_far
    from fricmodels.cli.printing import console
    from fricmodels.diagnosis import improve
    from fricmodels.progress import Cancelled

    left_out = effects_left_out(leave_out or ())
    with answered(recording, chosen):
        try:
            with working("improving") as say:
                ladder = improve(recording, chosen, given.inertia, leave_out=left_out, progress=say)
        except Cancelled as stopped:
            ladder = so_far(console(), stopped)
        with working("writing the report") as say, watched(say):
            written = write(story.of_ladder(ladder, options_again(left_out, trust, gaps)), page)
        print(f"wrote {written}")
        if ladder.partial:
            raise Stopped
