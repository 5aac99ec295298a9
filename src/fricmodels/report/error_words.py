"""The errors of a comparison in words: how large they are, over which window, and beside which noise."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.recording import word
from fricmodels.report.reservations import as_promised, beyond_range, reservations
from fricmodels.report.wording import noise_alone, percent
from fricmodels.results.words import form
from fricmodels.score.bands import averaged

if TYPE_CHECKING:
    from fricmodels.results.comparison import ComparisonDocument

_TOO_LARGE = 1.25
"""Times the error that is left above which an estimate of the noise is said to be too large."""
_QUIETER = 2.0
"""Times the test error above which the fit error is said with it."""


def window(data: ComparisonDocument) -> str:
    """Say over which window the errors are averaged; nothing where that is not known, as in files of old versions."""
    errors = data.rms_torque_error
    sample = errors.bands[0].window_ms if errors.bands else None
    return "" if errors.band_ms is None or sample is None else averaged(errors.band_ms, sample)


def error_words(data: ComparisonDocument) -> str:
    """Say by how much the test error falls, or what it is, beside what noise alone would leave."""
    steps = data.steps
    before, after = steps[0].held_out_rms_percent, steps[-1].held_out_rms_percent
    noise = f"noise alone would leave {of_noise(data)}"
    if within_noise(data):
        noise = _estimated_too_large(data)
    over = f", {window(data)}" if window(data) else ""
    where = f"of the RMS {data.reference} on data that took no part in fitting{over}"
    if len(steps) > 1:
        return f"Test error {percent(before)} → {percent(after)} {where}; {noise}.{_quieter(data)}{reservations(data)}"
    if data.held:
        where = f"of the RMS {data.reference} on the three tenths that a fit would keep back{over}"
    return f"Test error {percent(before)} {where}; {noise}.{_quieter(data)}{reservations(data)}"


def _quieter(data: ComparisonDocument) -> str:
    """Say that more is left of what was fitted, where it is much more: the test data may hold less that is hard."""
    last = data.steps[-1]
    fit, test = last.rms_percent, last.held_out_rms_percent
    if data.held or fit is None or test is None or fit <= _QUIETER * test or fit <= 100 * POLICY.least_torque:
        return ""
    return (
        f" Where it was fitted {percent(fit)} is left: the data that took no part may hold less of what is hard to "
        "follow, such as starts and reversals."
    )


def of_noise(data: ComparisonDocument) -> str:
    """Say how much noise alone would leave."""
    text = noise_left(data)
    return text if text.startswith("less") else f"about {text}"


def noise_left(data: ComparisonDocument) -> str:
    """Return what noise alone would leave."""
    return noise_alone(data.last_noise_floor_percent).replace("<\u00a0", "less than ")


def within_noise(data: ComparisonDocument) -> bool:
    """Whether the error that is left is clearly smaller than what noise was estimated to leave."""
    end, noise = data.steps[-1].held_out_rms_percent, data.last_noise_floor_percent
    return end is not None and noise is not None and _TOO_LARGE * end < noise


def _estimated_too_large(data: ComparisonDocument) -> str:
    """Say of which channel the noise is smaller than it was estimated, and what to do about that."""
    channel = data.steps[-1].noise_channel
    named = word(channel, Motion(data.motion)) if channel else ""
    whose = f"the noise of the {named}" if named else "the noise"
    remedy = f"; a {named} that is logged finer, or with less noise, tells it better" if named else ""
    return (
        f"{whose} was estimated at {percent(data.last_noise_floor_percent)}, an estimate that is too high: go by the "
        f"test error{remedy}"
    )


def comparison_words(data: ComparisonDocument) -> tuple[str, str]:
    """Say how far off a model is: the answer, and the errors that it rests on."""
    errors = data.rms_torque_error
    left = f"{percent(errors.held_out_percent)} of the {data.reference}"
    sentence = f"The model {data.model} leaves a test error of {left}."
    words = error_words(data) + ("" if _quieter(data) else f" Fit error {percent(errors.percent)}.")
    if data.held:
        sentence = f"The model {data.model} with the numbers of its file leaves an error of {left}."
        others = f"On the other samples {percent(errors.percent)}."
        words = f"Nothing was fitted. {error_words(data)} {others}{as_promised(data)}{beyond_range(data)}"
    sample = errors.bands[0] if errors.bands else None
    if sample is None or sample.window_ms == errors.band_ms:
        return sentence, words
    return sentence, (
        f"{words} Per sample ({form(sample.window_ms, '.3g')} ms) the test error is "
        f"{percent(sample.held_out_percent)}, of noise alone {noise_alone(sample.noise_floor_percent)}."
    )
