"""The part of a report on simulated motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fricmodels.dimension import DISPLACEMENT, Motion
from fricmodels.errors import InputError
from fricmodels.motion.document import how, motion_words
from fricmodels.report.figure_tables import points_of
from fricmodels.report.page import Block, Fold, Picture, Section, Words, table
from fricmodels.report.pictures import beyond_words, drawn
from fricmodels.report.wording import count, number, percent, set_powers

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.motion import Judged, Replays

_FREE = (
    "An open simulation adds up every error of force: one of F on a drive with the viscous coefficient K is a speed of "
    "F/K that never ends, so that the position drifts. A model can be best by torque and not by position."
)

_REFIT = (
    "The parameters are those that the torque gave. With --score position, the same command fits them to the motion, "
    "and judges by the position too."
)


def simulated(comparisons: Sequence[Comparison]) -> Block:
    """Show the motion that the last model makes of the measured torque, beside that of the first; or say why not.

    Args:
        comparisons: one model, or the first and the last of a ladder.
    """
    from fricmodels.motion import replayed, stretch_of, undetermined
    from fricmodels.report import figures

    last = comparisons[-1]
    inertia, error = (
        each.get(last.drive.inertia_key) for each in (last.estimate.parameters, last.estimate.standard_errors)
    )
    inertia = last.drive.inertia if last.drive.inertia is not None else inertia
    why = undetermined(last.drive, inertia or 0.0, error)
    if why:
        return Words(f"The motion that the model would make is not simulated: {why}.")
    stretch = stretch_of(last.test)
    try:
        found = replayed([(each.drive, each.estimate.parameters) for each in comparisons], stretch)
    except InputError as reason:
        return Words(f"The motion that the model would make is not simulated: {set_powers(str(reason))}.")
    figure = figures.simulated_velocity(found)
    shown = f"{drawn(*figures.drawn_samples(figure))}{beyond_words(figure)}"
    words = f"{replay_words(found, last.drive.motion)} {shown}"
    picture = Picture("Simulated beside measured motion", words, figure, points_of(figure), "simulated-motion")
    return Fold(_headline(found), [picture, Words(_REFIT)])


def _headline(found: Replays) -> str:
    first, last = found.models[0], found.models[-1]
    text = f"Simulated motion: the velocity is off by {percent(last.percent)}"
    if len(found.models) > 1:
        text += f" with what was found, by {percent(first.percent)} with the model as given"
    return text


def replay_words(found: Replays, motion: Motion) -> str:
    """Say how a motion was simulated, how far it is off, and how far noise alone would bring it."""
    stretch, unit = found.stretch, f"{DISPLACEMENT.unit(motion)}/s"
    anew = "each piece of it from its measured state"
    if stretch.horizon or stretch.excerpt:
        anew = f"anew from the measured state every {number(stretch.window)} s"
    usual = ", the usual time between two reversals" if stretch.stroke else ""
    part = "on test data"
    if stretch.excerpt:
        part = f"on {count(len(stretch.recording))} of {count(stretch.total)} samples of test data, evenly spread"
    sizes = [f"{number(each.error)} {unit} ({percent(each.percent)} of the RMS velocity)" for each in found.models]
    held = ", held between samples" if found.between_samples == "held" else ""
    text = f"From the measured torque alone{held}, {part}, {anew}{usual}. "
    text += f"The RMS velocity error is {sizes[-1]}"
    if len(sizes) > 1:
        text += f", with the model as given {sizes[0]}"
    text += f"; noise of the sensors alone would give {number(found.noise)} {unit}."
    if found.models[-1].percent >= 100:
        text += " To say that the drive stands still would be no worse: with this model the torque does not tell this."
    return text


def motion_section(found: Sequence[Judged]) -> Section:
    """Show the simulated motion beside the measured one, and the error of every model that was judged by it."""
    from fricmodels.report import figures

    shown = next((each for each in found if each.chosen), found[-1])
    errors = shown.by_torque if shown.test is None else shown.test
    motion, simulator = shown.rung.drive.motion, shown.kept
    what = how(
        simulator.horizon,
        simulator.recording.interval,
        closed=simulator.loop is not None,
        held=simulator.between_samples == "held",
    )
    by = "the parameters that the torque gave" if shown.fit is None else "parameters fitted to the motion"
    sentence = f"{shown.rung.name}, simulated {what}, with {by}: {motion_words(errors, motion)}, on test data."
    figure = figures.simulated_motion(shown)
    sentence += f" {drawn(*figures.drawn_samples(figure))}"
    blocks: list[Block] = [
        Picture("Simulated beside measured motion", sentence, figure, points_of(figure), "simulated-motion")
    ]
    unit = DISPLACEMENT.unit(motion)
    rows = []
    for each in found:
        own = each.test
        rows.append(
            (
                each.rung.name,
                number(each.by_torque.position),
                "–" if own is None else number(own.position),
                "–" if own is None else number(own.velocity),
                "yes" if each.chosen else "",
            )
        )
    titles = {
        "model": False,
        f"by torque [{unit}]": True,
        f"fitted to the motion [{unit}]": True,
        f"its velocity [{unit}/s]": True,
        "taken": False,
    }
    blocks.append(table("RMS errors of the simulated motion on test data", titles, rows))
    if len(found) > 1:
        blocks.append(
            Words("Taken is the smallest model within one standard error of the best; the test data decide alone.")
        )
    if simulator.loop is None:
        blocks.append(Words(_FREE))
    return Section("motion", "Simulated motion", blocks)
