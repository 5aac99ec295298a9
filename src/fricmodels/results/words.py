"""Words that several views of a result say, and numbers that may be missing."""

from __future__ import annotations

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


def form(value: float | None, how: str) -> str:
    """Return a number in a format of Python; a dash for none."""
    return "–" if value is None else format(value, how)


def in_percent(share: float | None) -> float | None:
    """Return a share in percent, where there is one."""
    return None if share is None else 100 * share
