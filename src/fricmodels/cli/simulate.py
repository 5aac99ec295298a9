"""``fricmodels simulate``: data with known truth and hidden effects, or the motion of a fitted model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from fricmodels.cli.measurement import Column, Format, GapsOption, Reading, TorqueConstant


def command(
    rig: Annotated[
        Path,
        typer.Argument(metavar="RIG.yaml|FILE.model.json", help="Description of a simulated drive, or a fitted model."),
    ],
    out: Annotated[Path, typer.Option("--out", help="Recording to write: .csv or .parquet.")],
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Use another seed than the file's.")] = None,
    torque: Annotated[
        list[Path] | None,
        typer.Option("--torque", metavar="DATA", help="Recording whose torque drives a fitted model; repeatable."),
    ] = None,
    reference: Annotated[
        list[Path] | None,
        typer.Option(
            "--reference",
            metavar="DATA",
            help="Recording with the reference that drives a fitted model through the controller in its file; "
            "repeatable.",
        ),
    ] = None,
    between_samples: Annotated[
        Literal["linear", "held"] | None,
        typer.Option(
            "--between-samples",
            help="Whether the recorded torque goes straight from sample to sample, or is held; if not given what moves "
            "the model clearly nearer to the recorded motion.",
        ),
    ] = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    gaps: GapsOption = None,
) -> None:
    """Simulate a drive with hidden effects.

    Writes the recording, and the truth beside it as DATA.truth.json. A fitted model is driven by the torque of a
    recording, open loop from its first sample, or by its reference through the controller that `fit --controller`
    stored; how far its motion goes from the recorded one is printed.
    """
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.errors import InputError

    beside = out.with_suffix(".truth.json") if out.name and rig.suffix != ".json" else None
    check_outputs([out, beside], [rig, *(torque or ()), *(reference or ())])
    if rig.suffix == ".json":
        if bool(torque) == bool(reference):
            raise InputError(
                f"{rig}: a fitted model needs what drives it; give a recording with --torque DATA, or with "
                f"--reference DATA for the controller in its file"
            )
        if seed is not None:
            raise InputError("a fitted model has no noise, and no seed; leave --seed out")
        if between_samples is not None and reference:
            raise InputError("--between-samples is about a recorded torque; with --reference there is none")
        how = Reading(column, torque_constant, reader, False, gaps)
        _fitted(rig, torque or reference or [], how, out, closed=bool(reference), between_samples=between_samples)
        return
    if torque or reference or between_samples is not None:
        raise InputError(
            "--torque, --reference and --between-samples are for a fitted model; a rig has its own excitation"
        )
    if column or torque_constant is not None or reader or gaps:
        raise InputError(
            "--column, --torque-constant, --reader and --gaps say how a recording is read that drives a fitted model; "
            "a rig reads none"
        )
    from fricmodels.cli.printing import working
    from fricmodels.progress import steps, watched
    from fricmodels.rig import load_rig, write

    chosen = load_rig(rig)
    if seed is not None:
        chosen = chosen.model_copy(update={"seed": seed})
    with working("simulating") as say, watched(say), steps(f"simulating {chosen.name}, and writing it", 2) as done:
        recording = chosen.simulate()
        done()
        data, truth = write(recording, out)
    print(f"{data}: {len(recording)} samples of {', '.join(recording.channels)}")
    print(f"{truth}: the truth, {chosen.true_model}")


def _fitted(
    path: Path,
    data: list[Path],
    reading: Reading,
    out: Path,
    *,
    closed: bool,
    between_samples: Literal["linear", "held"] | None,
) -> None:
    from fricmodels.cli.printing import print_line, working
    from fricmodels.progress import steps, watched
    from fricmodels.saved import load
    from fricmodels.saved.controlled import closed_loop
    from fricmodels.saved.driven import driven, errors_in_words, write_recording

    model = load(path)
    with (
        working("simulating") as say,
        watched(say),
        steps(f"reading, simulating and writing with {path.name}", 3) as done,
    ):
        recording = reading.read(data, model.motion)
        done()
        if closed:
            simulated, how = closed_loop(model, recording), "closed loop"
        else:
            simulated, between = driven(model, recording, between_samples)
            how = "open loop, the torque held between samples" if between == "held" else "open loop"
        done()
        written = write_recording(simulated, out)
    print(f"{written}: {len(simulated)} samples of {', '.join(simulated.channels)}")
    for line in errors_in_words(simulated, recording, how):
        print_line(line)
