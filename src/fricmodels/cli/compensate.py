"""``fricmodels compensate``: what a friction model is worth to a controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricmodels.progress import Progress
    from fricmodels.saved import FittedModel


def command(
    rigs: Annotated[
        list[Path], typer.Argument(metavar="RIG.yaml…", help="Simulated drives, as of `simulate`.", show_default=False)
    ],
    model: Annotated[
        list[str] | None,
        typer.Option("--model", metavar="LAW+EFFECT|FILE.model.json", help="Where to begin; or files, repeatable."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Figures: .json or .csv.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Use another seed than the files'.")] = None,
    motions: Annotated[int, typer.Option("--motions", min=1, max=100, help="Motions to follow.")] = 3,
    motion: Annotated[str, typer.Option("--motion", help="both, multisine or trapezoid.")] = "both",
    at: Annotated[str, typer.Option("--at", help="Compensate at the reference, or at the measured motion.")] = (
        "reference"
    ),
    at_rest: Annotated[
        str, typer.Option("--at-rest", help="With --at measured: none, reference or smooth.")
    ] = "reference",
    turn: Annotated[
        float, typer.Option("--turn", help="With --at measured: speed of rest, over the peak speed.")
    ] = 0.02,
    rate: Annotated[float, typer.Option("--rate", help="Of the controller [Hz].")] = 1000.0,
    delay: Annotated[float, typer.Option("--delay", help="From encoder to torque, in samples.")] = 1.0,
    bandwidth: Annotated[
        float | None, typer.Option("--bandwidth", help="Of the controlled position [Hz]; by its delays if left out.")
    ] = None,
    encoder_step: Annotated[
        float | None, typer.Option("--encoder-step", help="[rad or m]; 256 counts a sample at full speed if left out.")
    ] = None,
) -> None:
    """Say what a friction model is worth to a controller: tracking error with and without.

    Each simulated drive is recorded, identified from that recording, and then driven along other motions under a PD
    controller with delay and encoder: without compensation, with Coulomb and viscous friction, with the improved model,
    and with the torque that the drive's own equations ask for.
    """
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.cli.printing import console, working
    from fricmodels.compensation import study
    from fricmodels.compensation.document import check_name, write
    from fricmodels.compensation.present import show
    from fricmodels.rig import load_rig
    from fricmodels.tracking.settings import settings_of

    check_outputs([out], [*rigs, *(model or ())])
    if out is not None:
        check_name(out)
    settings = settings_of(
        rate=rate, delay=delay, bandwidth=bandwidth, encoder_step=encoder_step, at=at, at_rest=at_rest, turn=turn,
        motion=motion,
    )  # fmt: skip
    start, given = _models(model or [])
    drives = [load_rig(path) for path in rigs]
    if seed is not None:
        drives = [drive.model_copy(update={"seed": seed}) for drive in drives]
    with working("simulating") as progress:
        studies = []
        for drive in drives:
            told = _of(drive.name, progress)
            studies.append(study(drive, settings, start=start, given=given, motions=motions, progress=told))
    shown = console()
    show(shown, studies, [str(path) for path in rigs], seed)
    if out is not None:
        shown.print(f"wrote {write(studies, out)}", markup=False, soft_wrap=True)


def _of(name: str, say: Callable[[Progress], None]) -> Callable[[Progress], None]:
    return lambda step: say(replace(step, stage=f"{name}: {step.stage}"))


def _models(names: list[str]) -> tuple[str | None, list[tuple[str, FittedModel]]]:
    """Return the model to begin from, or the models of files."""
    from fricmodels.errors import InputError
    from fricmodels.model import Model
    from fricmodels.saved import load

    files = [name for name in names if name.endswith(".json")]
    if len(files) < len(names) and (files or len(names) > 1):
        raise InputError("--model takes one name to begin from, or any number of model files; not both")
    if names and not files:
        return Model.parse(names[0]).name, []
    return None, [(Path(file).name, load(file)) for file in files]
