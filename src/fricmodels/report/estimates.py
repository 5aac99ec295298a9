"""How the parameters of sequential estimators came about: figures with their messages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.report.figure_tables import points_of
from fricmodels.report.page import Block, Fold, Picture
from fricmodels.report.wording import count, listed, number
from fricmodels.results.words import NORMAL_95

if TYPE_CHECKING:
    from fricmodels.results.history import Course, ParameterHistory

_NEAR = 0.05
"""Share of its final value within which an estimate has settled; or its 95 % interval, where that is wider."""


def histories(dataset: str, winner: str, found: Mapping[tuple[str, str], ParameterHistory]) -> list[Block]:
    """Return the histories on a recording: that of the winning estimator open, the others folded.

    Args:
        dataset: name of the recording.
        winner: the estimator that came first on it.
        found: histories by dataset and estimator.
    """
    own = [history for (name, _), history in found.items() if name == dataset and history.courses]
    first = [picture(history) for history in own if history.estimator == winner]
    others = [history for history in own if history.estimator != winner]
    if not others:
        return [*first]
    title = f"Estimates over time by {listed(history.estimator for history in others)}"
    return [*first, Fold(title, [picture(history) for history in others])]


def picture(history: ParameterHistory) -> Picture:
    """Return the estimates of a sequential estimator over time, with what they show in words."""
    from fricmodels.report import figures

    figure = figures.parameter_history(history)
    meta = figure.layout.meta
    words = f"{history.model}. {settling(history)}"
    if meta["drawn"] < meta["total"]:
        words += f" {count(meta['drawn'])} of {count(meta['total'])} estimates are drawn."
    if any(course.deviations is not None for course in history.courses.values()):
        words += (
            " The dotted band is two standard deviations by the filter's own covariance; where it is wider than the"
        )
        words += " estimates are large it leaves the axis."
    title = f"Estimates over time by {history.estimator}"
    return Picture(title, words, figure, points_of(figure), f"history-{history.estimator}")


def settling(history: ParameterHistory) -> str:
    """Say which parameter settles last, and when; or which have not settled at the end."""
    settled = {key: _settled(history, course) for key, course in history.courses.items()}
    late = [key for key, moment in settled.items() if moment is None]
    if late:
        verb = "have" if len(late) > 1 else "has"
        return f"At the end of the record {listed(late)} {verb} not settled within 5 % of the final value."
    last = max(settled, key=lambda key: settled[key] or 0.0)
    moment = settled[last] or 0.0
    return f"{last} settles last: from {number(moment)} s on it stays within 5 % of its final value, or its interval."


def _settled(history: ParameterHistory, course: Course) -> float | None:
    """Return from when on [s] an estimate stays near its final value; ``None`` where it does not until the end."""
    values = np.array([np.nan if each is None else each for each in course.estimates], dtype=float)
    final = values[-1] if course.final is None else course.final
    room = max(_NEAR * abs(final), NORMAL_95 * (course.standard_error or 0.0))
    away = np.flatnonzero(~(np.abs(values - final) <= room))
    if not len(away):
        return history.time[0]
    after = int(away[-1]) + 1
    return None if after >= len(values) - 1 else history.time[after]
