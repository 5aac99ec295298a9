"""``fricmodels fit``: a fitted model as a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fricmodels.cli.measurement import (
    Column,
    Data,
    Format,
    GapsOption,
    Inertia,
    Linear,
    ModelName,
    TorqueConstant,
    Trust,
    load,
)
from fricmodels.cli.motion import ControllerFile, Horizon, Score, check_score, controller_for


def command(
    data: Data,
    model: ModelName,
    out: Annotated[Path, typer.Option("--out", metavar="FILE.model.json", help="File to write.", show_default=False)],
    inertia: Inertia = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    linear: Linear = False,
    trust: Trust = False,
    gaps: GapsOption = None,
    objective: Annotated[
        Score,
        typer.Option("--objective", help="What is made small: the error of torque, or of the simulated position."),
    ] = Score.TORQUE,
    horizon: Horizon = None,
    controller: ControllerFile = None,
) -> None:
    """Fit a model and keep it in a file, to call, simulate and export.

    The fit is that of `compare`; with --objective position its parameters then bring the simulated motion nearest, and
    the file keeps the --controller through which it was simulated.
    Python reads the file with `fricmodels.load`; `compare`, `diagnose`, `improve` and `simulate` take it in place of a
    model's name, `export` writes it for other programs.
    """
    given = load(data, model, column, torque_constant, reader, linear, None, inertia, trust, gaps)
    check_score(objective, given.recording, horizon, controller, option="--objective")
    by_position = objective is Score.POSITION
    control = controller_for(controller, given.recording, given.file if by_position else None)
    from fricmodels.cli.answers import answered
    from fricmodels.cli.printing import warn, working
    from fricmodels.diagnosis import compare
    from fricmodels.saved import keep

    with answered(given.recording, given.model), working(f"fitting {given.model.name}"):
        comparison = compare(given.recording, given.model, given.inertia)
        kept = keep(comparison)
        if by_position:
            from fricmodels.cli.motion import refitted
            from fricmodels.saved.controlled import found_of, with_controller

            known = {} if given.file is None else found_of(given.file)
            comparison, fit = refitted(comparison, horizon, None if control is None else control.loop(), known)
            kept = keep(comparison)
            kept = kept if control is None else with_controller(kept, control, fit)
    print(kept)
    warn([f"the fit did not end well: {message}"] if (message := kept.document.provenance.message) else [])
    warn(f"'{key}' is not determined by this recording: {reason}" for key, reason in kept.not_identified.items())
    print(f"wrote {kept.save(out)}")
