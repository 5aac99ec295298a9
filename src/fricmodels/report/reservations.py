"""What the numbers of an answer do not say by themselves: what they hold for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fricmodels.dimension import VELOCITY
from fricmodels.report.wording import noise_alone, percent
from fricmodels.results.words import form

if TYPE_CHECKING:
    from fricmodels.results.comparison import ComparisonDocument


_ONE_WINDOW = 0.05
"""Share by which two windows may differ and be one: they are whole numbers of samples."""


def reservations(data: ComparisonDocument) -> str:
    """Return sentences, each with a space before it; empty where there are none."""
    return _of_runs_apart(data) + _of_other_runs(data) + _of_position(data) + _of_speed(data)


def as_promised(data: ComparisonDocument) -> str:
    """Say what the test error is over the window of a held model's file, beside what that says, if it is another.

    Each recording has its own window, by its noise. Errors over different ones do not compare.
    """
    promised, over = data.promised_percent, data.promised_band_ms
    bands = [(band.window_ms, band) for band in data.rms_torque_error.bands if band.window_ms]
    if promised is None or not over or not bands:
        return ""
    window, here = min(bands, key=lambda pair: abs(math.log(pair[0] / over)))
    if window == data.rms_torque_error.band_ms or abs(window / over - 1.0) > _ONE_WINDOW:
        return ""
    noise = noise_alone(here.noise_floor_percent)
    return (
        f" Over {form(over, '.3g')} ms, as in the file of the model, the test error is "
        f"{percent(here.held_out_percent)}, of noise alone {noise}; the file says {percent(promised)}."
    )


def beyond_range(data: ComparisonDocument) -> str:
    """Say which channels go beyond where held numbers were fitted; a space before each sentence."""
    words = ""
    for one in data.beyond_range:
        share, channel = form(100 * (one.share_of_samples or 0.0), ".2g"), one.channel.replace("_", " ")
        words += (
            f" {share} % of the samples have a {channel} beyond {form(one.least, '.3g')} to "
            f"{form(one.greatest, '.3g')} {one.unit}, where the numbers were fitted: there the model is a guess."
        )
    return words


def _of_runs_apart(data: ComparisonDocument) -> str:
    apart = data.runs_apart
    if apart is None:
        return ""
    differ = "; ".join(
        f"{one.key} is {form(one.least, '.3g')} in {one.least_run} and {form(one.greatest, '.3g')}"
        f"{' ' if one.unit else ''}{one.unit} in {one.greatest_run}"
        for one in apart.parameters
    )
    which = "they" if apart.fitted == apart.runs else f"{apart.fitted} of them"
    return (
        f" The {apart.runs} runs are not alike: fitted each by itself {which} leave {percent(apart.percent)}, together "
        f"{percent(apart.together_percent)}{': ' if differ else ''}{differ}. Are they of one drive, one load, one "
        "temperature, one unit?"
    )


def _of_other_runs(data: ComparisonDocument) -> str:
    if not data.offsets_of_runs:
        return ""
    several = data.offsets_of_runs > 1
    runs, they = (f"each of {data.offsets_of_runs} runs", "they were") if several else ("the run", "it was")
    return f" The offset of {runs} is taken from the run itself: as far as the model's file tells, {they} not fitted."


def _of_position(data: ComparisonDocument) -> str:
    if not data.integrated_position:
        return ""
    return (
        " No position was measured: what goes with it here goes with the integral of the velocity, from where each run "
        "begins, and is the same in another log only if that begins at the same place."
    )


def _of_speed(data: ComparisonDocument) -> str:
    if data.friction_drives_from is None:
        return ""
    at = f"{form(data.friction_drives_from, '.3g')} {VELOCITY.unit(data.motion)}"
    return f" From {at} on, beyond the recorded motion, the friction of this model would push, not brake: no use there."
