"""``fricmodels export``: a fitted model for another program."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from fricmodels.cli.measurement import Column, Format, GapsOption, Linear, Reading, TorqueConstant, linear_of


def command(
    model: Annotated[
        Path, typer.Argument(metavar="FILE.model.json", help="Model that `fit` wrote.", show_default=False)
    ],
    to: Annotated[str, typer.Option("--to", help="c, mjcf, urdf, isaac, drake, ros2 or json.", show_default=False)],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="File to write; printed if left out.")
    ] = None,
    name: Annotated[str, typer.Option("--name", help="Name of the joint; in C, how every name begins.")] = "joint",
    data: Annotated[
        list[Path] | None,
        typer.Option("--data", metavar="DATA", help="Recording to refit what the target can express; repeatable."),
    ] = None,
    into: Annotated[
        Path | None,
        typer.Option("--into", metavar="ROBOT.xml", help="MJCF or URDF to write the friction into."),
    ] = None,
    armature: Annotated[
        float | None,
        typer.Option("--armature", min=0.0, help="Armature to write into that MJCF [kg m²]."),
    ] = None,
    online: Annotated[
        str | None,
        typer.Option(
            "--online",
            metavar="ekf",
            help="In C, also a filter that runs beside the drive: ekf, detchmendy-sridhar or rls.",
        ),
    ] = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    linear: Linear = False,
    gaps: GapsOption = None,
) -> None:
    """Write a fitted model for a program: C, MuJoCo, URDF, Isaac Lab, Drake, ROS 2.

    What the target cannot express is listed with what it costs, and the nearest model that it can is refitted to the
    recording of --data; without one it is projected over the range in which the model is valid.
    """
    from fricmodels.cli.boundary import one_line
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.cli.printing import warn
    from fricmodels.errors import InputError
    from fricmodels.export.targets import export_model
    from fricmodels.files import write_text
    from fricmodels.saved import load

    if armature is not None and (to != "mjcf" or into is None):
        raise InputError("--armature is written into an MJCF: give --to mjcf and --into ROBOT.xml, or leave it out")
    check_outputs([out], [model, into, *(data or ())])
    kept = load(model)
    reading = Reading(column, torque_constant, reader, linear, gaps)
    recording = reading.read(data, linear_of(kept)) if data else None
    text = None
    if into is not None:
        try:
            text = into.read_text(encoding="utf-8")
        except FileNotFoundError:
            raise InputError(f"{into}: there is no such file") from None
        except UnicodeDecodeError:
            raise InputError(f"{into}: is no text in UTF-8") from None
    done = export_model(kept, to, name=name, recording=recording, into=text, armature=armature, online=online)
    grave = [note for note in done.notes if note.startswith("NOT DETERMINED")]
    for note in done.notes:
        if note not in grave:
            print(f"note: {one_line(note)}", file=sys.stderr)
    warn(grave)
    if out is None:
        print(done.text, end="")
    else:
        print(f"wrote {write_text(out, done.text)}")
