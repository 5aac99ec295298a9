"""``fricmodels fit``: a fitted model as a file."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricmodels.cli.measurement import (
    Column,
    Data,
    Format,
    GapsOption,
    Inertia,
    Linear,
    ModelName,
    Reading,
    TorqueConstant,
    Trust,
    load,
)
from fricmodels.cli.motion import ControllerFile, Horizon, Score, check_score, controller_for
from fricmodels.cli.outputs import check_outputs
from fricmodels.cli.sums import check_model, is_sums, plan_of, summed
from fricmodels.errors import InputError
from fricmodels.gaps import Gaps

if TYPE_CHECKING:
    from fricmodels.saved import FittedModel


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
    sums: Annotated[
        bool, typer.Option("--sums", help="Fit a linear law to every sample, read in blocks: for very long recordings.")
    ] = False,
) -> None:
    """Fit a model and keep it in a file, to call, simulate and export.

    The fit is that of `compare`; with --objective position its parameters then bring the simulated motion nearest, and
    the file keeps the --controller through which it was simulated. Files of `sums` may be given in the place of
    recordings.

    Python reads the file with `fricmodels.load`; `compare`, `diagnose`, `improve` and `simulate` take it in place of a
    model's name, `export` writes it for other programs.
    """
    check_outputs([out], [*data, model, controller])
    if sums or is_sums(data):
        if objective is not Score.TORQUE:
            raise InputError("--objective position simulates a recording, of which sums hold no sample; leave one out")
        how = {"columns": column or (), "reader": reader, "torque_constant": torque_constant}
        _by_sums(data, model, out, inertia, linear, trust, gaps, how)
        return
    reading = Reading(column, torque_constant, reader, linear, gaps)
    given = load(data, model, reading, inertia=inertia, trust=trust)
    check_score(objective, given.recording, horizon, controller, option="--objective")
    by_position = objective is Score.POSITION
    control = controller_for(controller, given.recording, given.file if by_position else None)
    from fricmodels.cli.answers import answered
    from fricmodels.cli.printing import working
    from fricmodels.diagnosis import compare
    from fricmodels.progress import watched
    from fricmodels.saved import keep

    with answered(given.recording, given.model), working(f"fitting {given.model.name}") as say, watched(say):
        comparison = compare(given.recording, given.model, given.inertia)
        kept = keep(comparison)
        if by_position:
            from fricmodels.cli.motion import refitted
            from fricmodels.saved.controlled import found_of, with_controller

            known = {} if given.file is None else found_of(given.file)
            comparison, fit = refitted(comparison, horizon, None if control is None else control.loop(), known)
            kept = keep(comparison)
            kept = kept if control is None else with_controller(kept, control, fit)
    _say(kept, out)


def _by_sums(
    data: list[Path],
    model: str,
    out: Path,
    inertia: float | None,
    linear: bool,
    trust: bool,
    gaps: Gaps | None,
    how: Mapping[str, Any],
) -> None:
    """Fit to sums, read from files or made here."""
    from fricmodels.cli.printing import working
    from fricmodels.progress import watched
    from fricmodels.saved.summed import keep_sums
    from fricmodels.sums import added, load

    if is_sums(data):
        total = added(load(path) for path in data)
    else:
        plan = plan_of(data[0], model, inertia, linear, trust, gaps, how)
        with working(f"fitting {model}") as say, watched(say):
            total = added(one for _, one in summed(data, plan, gaps, how))
    check_model(total, model)
    _say(keep_sums(total, inertia), out)


def _say(kept: FittedModel, out: Path) -> None:
    """Write a model, and print it, the answer first: who reads may stop reading."""
    from fricmodels.cli.printing import print_line, warn
    from fricmodels.saved.words import error_in_words, model_lines

    document, path = kept.document, kept.save(out)
    files = ", ".join(document.provenance.files[:3]) or document.provenance.recording
    print_line(f"{files}: {document.model}, {error_in_words(document)}.")
    for line in model_lines(document):
        print_line(line, indent=6)
    sure = len(document.parameters) - len(kept.not_identified)
    if kept.not_identified:
        print_line(f"How sure: {sure} of {len(document.parameters)} parameters are determined by this recording.")
    warn([f"the fit did not end well: {message}"] if (message := kept.document.provenance.message) else [])
    warn(f"'{key}' is not determined by this recording: {reason}" for key, reason in kept.not_identified.items())
    warn([kept.of_the_clock] if kept.of_the_clock else [])
    print(f"wrote {path}")
    print_line("Next: write it for a controller or a simulator:")
    print(f"  fricmodels export {shlex.quote(str(out))} --to c")
