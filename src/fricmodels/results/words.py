"""Words that several views of a result say, and numbers that may be missing."""

from __future__ import annotations

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
