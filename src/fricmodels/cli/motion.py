"""What the commands say of simulated motion: ``--score position``, ``--horizon``, ``--controller``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.loop import Loop
    from fricmodels.motion import Controller, Judged, MotionFit, PluginController
    from fricmodels.recording import Recording
    from fricmodels.saved import FittedModel


class Score(StrEnum):
    """What a model is judged by."""

    TORQUE = "torque"
    POSITION = "position"


ScoreOption = Annotated[Score, typer.Option("--score", help="Judge by the torque, or by the simulated position too.")]
Horizon = Annotated[
    int | None,
    typer.Option(
        "--horizon", min=1, help="Simulate anew from the measured state every so many samples; in one go if left out."
    ),
]
ControllerFile = Annotated[
    Path | None,
    typer.Option(
        "--controller",
        metavar="FILE.yaml",
        help="Simulate through this controller, from its reference; that of a model's file if left out.",
    ),
]


def loop_of(path: Path | None, recording: Recording, file: FittedModel | None = None) -> Loop | None:
    """Return what a controller's file makes of a simulation, or else the controller that a model carries.

    Raises:
        InputError: for a mistake in the file, or a channel that the recording does not have.
    """
    controller = controller_for(path, recording, file)
    return None if controller is None else controller.loop()


def controller_for(
    path: Path | None, recording: Recording, file: FittedModel | None = None
) -> Controller | PluginController | None:
    """Return the controller of a file, or else the one that a model carries, or ``None``.

    Raises:
        InputError: for a mistake in the file, or a channel that the recording does not have.
    """
    from fricmodels.motion import check_controller, read_controller
    from fricmodels.saved.controlled import controller_of

    controller = read_controller(path) if path is not None else None if file is None else controller_of(file)
    if controller is not None:
        check_controller(controller, frozenset(recording.channels), recording.name)
    return controller


def check_score(
    score: Score, recording: Recording, horizon: int | None, controller: Path | None, option: str = "--score"
) -> None:
    """Refuse options that do not go together, before the work begins.

    Raises:
        InputError: saying what to change.
    """
    from fricmodels.errors import InputError
    from fricmodels.results.words import lacks

    if score is Score.POSITION and not recording.measures("position"):
        raise InputError(f"the position is needed, {lacks('position', recording.name)}")
    for name, given in (("--horizon", horizon), ("--controller", controller)):
        if given is not None and score is not Score.POSITION:
            raise InputError(f"{name} goes with {option} position")


def by_motion(
    console: Any,
    comparisons: Sequence[Comparison],
    horizon: int | None,
    loop: Loop | None,
    out: Path | None,
    *,
    known: Mapping[str, float] | None = None,
) -> list[Judged]:
    """Say, and write as ``motion.json``, what the simulated motion says of models that were fitted to the torque.

    What is known of the loop's parameters is where a fit of them begins, or what they are.
    """
    from fricmodels.cli.printing import working
    from fricmodels.motion import Rung, judged
    from fricmodels.motion.document import motion_document, write_motion
    from fricmodels.progress import watched

    first = comparisons[0]
    rungs = [Rung(each.drive, {**(known or {}), **each.estimate.parameters}) for each in comparisons]
    with working("simulating") as say, watched(say):
        found = judged(rungs, first.train, first.test, loop=loop, horizon=horizon)
    console.print()
    show_motion(console, found, horizon, first.train.interval, loop is not None)
    if out is not None:
        document = motion_document(found, horizon, first.drive.motion, closed=loop is not None)
        console.print(f"wrote {write_motion(document, out)}", markup=False, soft_wrap=True)
    return found


def taken(comparisons: Sequence[Comparison], found: Sequence[Judged]) -> Comparison:
    """Return the comparison that the simulated motion chose, with the parameters that it found; else the last one."""
    for comparison, each in zip(comparisons, found, strict=True):
        if each.chosen and each.fit is not None:
            return with_parameters(comparison, each.fit)
    return comparisons[-1]


def show_motion(console: Any, found: Sequence[Judged], horizon: int | None, interval: float, closed: bool) -> None:
    """Print the simulated errors of each model on what was kept back."""
    from fricmodels.dimension import DISPLACEMENT
    from fricmodels.motion.document import how, motion_words
    from fricmodels.terminal import Column, show_table

    motion, held = found[0].rung.drive.motion, found[0].kept.between_samples == "held"
    unit = DISPLACEMENT.unit(motion)
    console.print(f"Simulated {how(horizon, interval, closed=closed, held=held)}:", markup=False, highlight=False)
    columns = [
        Column("model", tuple(each.rung.name for each in found)),
        Column(f"by torque [{unit}]", tuple(f"{each.by_torque.position:.3g}" for each in found), True),
        Column(f"refitted [{unit}]", tuple("–" if e.test is None else f"{e.test.position:.3g}" for e in found), True),
        Column(f"velocity [{unit}/s]", tuple("–" if e.test is None else f"{e.test.velocity:.3g}" for e in found), True),
        Column("", tuple("taken" if each.chosen and len(found) > 1 else "" for each in found)),
    ]
    show_table(console, columns, "RMS error of the simulated motion on what was kept back")
    for each in found:
        if (each.chosen or len(found) == 1) and each.test is not None:
            words = motion_words(each.test, motion)
            console.print(f"{each.rung.name}, refitted to the motion: {words}.", markup=False, highlight=False)


def refitted(
    comparison: Comparison, horizon: int | None, loop: Loop | None, known: Mapping[str, float] | None = None
) -> tuple[Comparison, MotionFit]:
    """Return a comparison with the parameters that bring the simulated motion nearest to the measured one, and the fit.

    Raises:
        EstimationError: where no simulation reaches its end.
    """
    from fricmodels.motion import Simulator, fit_motion, torque_between_samples

    start = {**(known or {}), **comparison.estimate.parameters}
    between = torque_between_samples(comparison.drive, start, comparison.train, loop=loop)
    simulator = Simulator(comparison.drive, comparison.train, horizon=horizon, loop=loop, between_samples=between)
    fit = fit_motion(simulator, [start])
    return with_parameters(comparison, fit), fit


def with_parameters(comparison: Comparison, fit: MotionFit) -> Comparison:
    """Return a comparison with the parameters of a fit to the motion."""
    from dataclasses import replace

    from fricmodels.diagnosis.comparison import compare_fit

    keys = [comparison.drive.inertia_key, *(p.key for p in comparison.drive.model.parameters)]
    own = {key: fit.parameters[key] for key in keys}
    errors = {key: error for key, error in fit.standard_errors.items() if key in keys}
    found = compare_fit(comparison.train, comparison.test, comparison.drive, own, errors)
    places = [fit.estimated.index(key) for key in comparison.drive.keys]
    message = "" if fit.converged else "the search was cut off before it converged"
    estimate = replace(found.estimate, covariance=fit.covariance[places][:, places], message=message)
    return replace(found, estimate=estimate)
