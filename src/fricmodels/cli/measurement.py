"""What compare, diagnose and improve have in common: a recording, a model, an inertia."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricmodels.model import Model
    from fricmodels.recording import Recording

Data = Annotated[Path, typer.Argument(metavar="DATA", help="Recording: .csv, .parquet, .mat, .bag.")]
ModelName = Annotated[str, typer.Option("--model", metavar="LAW+EFFECT+…", help="Model to compare with the recording.")]
Inertia = Annotated[
    float | None,
    typer.Option("--inertia", help="Inertia [kg m²], or mass [kg] of a linear axis; estimated if left out."),
]
Column = Annotated[
    list[str] | None, typer.Option("--column", metavar="CHANNEL=COLUMN[:UNIT]", help="Map a column; repeatable.")
]
TorqueConstant = Annotated[
    float | None, typer.Option("--torque-constant", help="Torque per current [N m/A], for logs of current.")
]
Format = Annotated[str | None, typer.Option("--reader", help="Read the file as this format.")]
Linear = Annotated[bool, typer.Option("--linear", help="A linear axis: forces and metres.")]
Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Write diagnosis.json there.")]
Report = Annotated[
    Path | None, typer.Option("--report", metavar="FILE.html", help="Write the report there: one page, with figures.")
]
LeaveOut = Annotated[
    list[str] | None, typer.Option("--leave-out", metavar="EFFECT", help="Do not consider; repeatable.")
]


def load(
    data: Path,
    model: str,
    columns: list[str] | None,
    torque_constant: float | None,
    reader: str | None,
    linear: bool,
    leave_out: list[str] | None = None,
) -> tuple[Recording, Model]:
    """Read the recording and the model that the options name; warn where the recording's units are doubtful.

    Raises:
        InputError: for anything that cannot be read or is not known.
    """
    from fricmodels import plugins
    from fricmodels.cli.printing import warn
    from fricmodels.dimension import Motion
    from fricmodels.model import Model
    from fricmodels.readers import doubts, read

    chosen = Model.parse(model)
    for effect in leave_out or ():
        plugins.load().effects.entry(effect)
    motion = Motion.LINEAR if linear else None
    recording = read(data, columns=columns or (), motion=motion, reader=reader, torque_constant=torque_constant)
    warn(doubts(recording))
    return recording, chosen
