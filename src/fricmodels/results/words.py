"""Words that several views of a result say, and numbers that may be missing."""

from __future__ import annotations

import math
import re

from fricmodels.dimension import Motion

BY_WINDOW = "RMS torque error by window, in % of the RMS motor torque"
FOUND = "What was found"
SIZE = "Its size on the residual"
NOT_FOUND = "Tested and not found; smallest size we would have detected"
NOT_SEEN = "Could not have been seen in this recording"
"""Titles of tables."""
SAMPLING = "when the drive turned or stopped between two samples, and a shift of torque against motion within one"
"""What a recording hides between its samples."""


MORE_MOTION = "record longer, with more strokes, or with less noise"
"""The way out of a recording that moves too little."""


def lacks(channel: str, recording: str) -> str:
    """Return that a recording does not have a channel, and what to do."""
    return f"which recording '{recording}' does not have; map a column with --column {channel}=COLUMN[:UNIT]"


def without_gaps(pieces: int, stretch: int) -> str:
    """Return the way out of a recording that gaps cut into pieces of some samples, where a stretch takes more."""
    return (
        f"gaps cut most of it into pieces of {pieces} samples or less, and a stretch takes {stretch}: record without "
        "gaps, if need be more slowly"
    )


def stretches_of_motion(count: int, seconds: float) -> str:
    """Say in how many stretches, of so many seconds each, a recording moves clearly."""
    each = f"{seconds:.2g} s" + (" each" if count != 1 else "")
    return f"{count} {'stretch' if count == 1 else 'stretches'} of clear motion ({each})"


def look_alikes(others: str, separated_by: str) -> str:
    """Say which effects a recording cannot tell from one, and what would tell them apart."""
    return f"This recording cannot tell it from {others}; what would: {separated_by}."


_TORQUE = re.compile(r"(?<![\w-])([Tt])orque(s?)(?![\w-])")
_ROTATION = re.compile(r"(?<![\w-])rotation(?![\w-])")


def of_motion(text: str, motion: Motion) -> str:
    """Return a text about a drive as it reads for its motion: on a linear axis a torque is a force.

    Names of effects and columns, such as ``torque-ripple`` and ``torque_Nm``, stay as they are.

    Args:
        text: in words of a rotary drive.
        motion: of the drive.
    """
    if motion is not Motion.LINEAR:
        return text
    forces = _TORQUE.sub(lambda found: f"{'F' if found[1] == 'T' else 'f'}orce{found[2]}", text)
    return _ROTATION.sub("motion", forces)


def predictor(channel: str) -> str:
    """Return a channel that predicts the error as in a sentence: what its additions mean, in parentheses."""
    name, *parts = channel.split(", ")
    meant = [_MEANT.get(part, part) for part in parts]
    return f"{name} ({', '.join(meant)})" if meant else name


LEAST_CHANCE = 1e-6
"""Probability below which its number means nothing."""
LINE = "time, at"
"""Begins the name of a torque that comes and goes in time: "time, at 1.7 Hz"."""
ALONG = "along the motion"
"""How a diagnosis says that an error turns its sign with the motion."""
_MEANT = {"finely": "with many waves", ALONG: "turning its sign with the motion"}


def form(value: float | None, how: str) -> str:
    """Return a number in a format of Python; a dash for none."""
    return "–" if value is None else format(value, how)


def figures(value: float, digits: int = 2) -> str:
    """Return a number in so many figures and, below a million, without a power of ten: 140, not 1.4e+02."""
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and abs(value) < 1e6 else text


NORMAL_95 = 1.959964
"""Standard errors on either side of a 95 % interval."""
MOST_FIGURES = 5
"""Of a parameter, however small its error: no torque is known better."""
_OF_AN_ERROR = 2
"""Figures of a standard error: it is an estimate itself, from few recordings of its kind."""


def borne(value: float, error: float) -> tuple[float, int]:
    """Return a value to the second figure of its error, at most five, and in how many figures it is written so."""
    last = _power(error, _OF_AN_ERROR) - _OF_AN_ERROR + 1
    last = max(last, _power(value, MOST_FIGURES) - MOST_FIGURES + 1) if value else last
    rounded = round(value, -last) + 0.0  # no zero with a sign
    return rounded, max(_power(rounded, MOST_FIGURES) - last + 1, 1)


def _power(value: float, digits: int) -> int:
    """Return the power of ten of a number as it is written in so many figures: 1 of 9.96 in two."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2])


def value_text(value: float, error: float | None, without: int = MOST_FIGURES) -> str:
    """Return a parameter in the figures that its standard error bears, or in so many without one.

    In one, where the error is larger than the value: 10000 ± 2e8 is not 0.
    """
    if error is None or not math.isfinite(error) or error <= 0:
        return figures(value, without)
    return figures(value, 1) if abs(value) < error else figures(*borne(value, error))


def spread_text(error: float | None) -> str:
    """Return a standard error, or half of an interval, in two figures; in words where there is none."""
    return "given" if error is None else figures(error, _OF_AN_ERROR) if error > 0 else "not determined"


def with_spread(value: float, error: float | None) -> str:
    """Return a parameter with its standard error: ``1.81 ± 0.02``."""
    known = error is not None and error > 0
    return f"{value_text(value, error)} {'± ' if known else ''}{spread_text(error)}"


END_STOP = "an end stop"
"""Ends what is said of a drive that is held at the ends of its travel."""
HELD_AT_REST = "as a brake or an end stop does"
"""Ends what is said of a drive that is held at rest by more than its friction in motion."""
COMBINED = "the recording determines only a combination of it with"
"""Begins the reason why a parameter is not identified, where others take its place."""
CONTAINS_ZERO = "contains zero"
"""In the reason why a parameter is not identified, where all that is wrong is that it may be nothing."""
HELD = "; held at "
"""Begins what is said of the value that a parameter was held at, after the reason."""


def is_combined(reason: str) -> bool:
    """Whether only a combination of a parameter with others is determined: it has no standard error of its own."""
    return reason.startswith(COMBINED)


def share_text(share: float | None) -> str:
    """Return a share of an error that an effect takes away, in whole percent.

    Less than one percent, and all that would raise the error, is nothing that could be told from another recording.
    """
    return "–" if share is None else "< 1 %" if share < _LEAST_SHARE else f"{100 * share:.0f} %"


_LEAST_SHARE = 0.01


def change_text(gain: float | None) -> str:
    """Return how the error changes with an effect that takes away such a share of it."""
    return "no less" if gain is not None and gain < _LEAST_SHARE else f"-{share_text(gain)}".replace("-–", "–")


def chance_text(p_value: float | None) -> str:
    """Return a probability in one figure; below one in a million the number means nothing."""
    return "–" if p_value is None else f"< {LEAST_CHANCE:.0e}" if p_value < LEAST_CHANCE else f"{p_value:.1g}"


def chance_in_words(p_value: float) -> str:
    """Return a probability as it follows its letter in a sentence: ``= 0.02``, or ``< 1e-06``."""
    text = chance_text(p_value)
    return text if text.startswith("<") else f"= {text}"


def in_percent(share: float | None) -> float | None:
    """Return a share in percent, where there is one."""
    return None if share is None else 100 * share


LEAST_NOISE = 0.1
"""Noise with fewer percent of the RMS torque has no digits: a change of every sample in its ninth makes as much."""


def noise_text(percent: float, digits: int = 3) -> str:
    """Return what noise alone leaves [% of the RMS torque].

    Less than a tenth of a percent is not told apart: no torque is known as well, and what is written there changes with
    the last digits of the samples.
    """
    return f"< {LEAST_NOISE} %" if percent < LEAST_NOISE else f"{percent:.{digits}g} %"


def about_noise(percent: float, digits: int = 3) -> str:
    """Return what noise alone leaves in a sentence: about so much, or less than what is told apart."""
    text = noise_text(percent, digits)
    return text.replace("< ", "less than ") if text.startswith("<") else f"about {text}"
