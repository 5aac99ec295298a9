"""The part of a report on simulated motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fricmodels.motion.document import error_words, how, position_unit
from fricmodels.report.figure_tables import points_of
from fricmodels.report.page import Block, Picture, Section, Words, table
from fricmodels.report.pictures import drawn
from fricmodels.report.wording import number

if TYPE_CHECKING:
    from fricmodels.motion import Judged

_FREE = (
    "An open simulation adds up every error of force: one of F on a drive with the viscous coefficient K is a speed of "
    "F/K that never ends, so that the position drifts. A model can be best by torque and not by position."
)


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
    sentence = f"{shown.rung.name}, simulated {what}, with {by}: {error_words(errors, motion)}, on test data."
    figure = figures.simulated_motion(shown)
    sentence += f" {drawn(*figures.drawn_samples(figure))}"
    blocks: list[Block] = [
        Picture("Simulated beside measured motion", sentence, figure, points_of(figure), "simulated-motion")
    ]
    unit = position_unit(motion)
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
