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
from fricmodels.cli.motion import ControllerFile, Horizon, Score, check_score, loop_of


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

    The fit is that of `compare`; with --objective position its parameters then bring the simulated motion nearest.
    Python reads the file with `fricmodels.load`; `compare`, `diagnose`, `improve` and `simulate` take it in place of a
    model's name, `export` writes it for other programs.
    """
    given = load(data, model, column, torque_constant, reader, linear, None, inertia, trust, gaps)
    check_score(objective, given.recording, horizon, controller, option="--objective")
    loop = loop_of(controller, given.recording)
    from fricmodels.cli.answers import answered
    from fricmodels.cli.printing import warn, working
    from fricmodels.diagnosis import compare
    from fricmodels.saved import keep

    with answered(given.recording, given.model), working(f"fitting {given.model.name}"):
        comparison = compare(given.recording, given.model, given.inertia)
        if objective is Score.POSITION:
            from fricmodels.cli.motion import refitted

            comparison = refitted(comparison, horizon, loop)
        kept = keep(comparison)
    print(kept)
    warn([f"the fit did not end well: {message}"] if (message := kept.document.provenance.message) else [])
    warn(f"'{key}' is not determined by this recording: {reason}" for key, reason in kept.not_identified.items())
    print(f"wrote {kept.save(out)}")
