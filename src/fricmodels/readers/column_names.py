"""What columns are usually called: which of them looks like a channel that was not found."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from difflib import get_close_matches

_HABITS = {
    "time": ("t", "time", "stamp", "zeit", "sec", "timestamp"),
    "torque": ("torque", "tau", "effort", "tq", "trq", "moment"),
    "force": ("force", "effort", "thrust", "load"),
    "current": ("current", "i", "amps", "iq"),
    "velocity": ("velocity", "vel", "speed", "qd", "dq", "omega", "w", "rpm"),
    "position": ("position", "pos", "q", "angle", "theta", "encoder"),
    "temperature": ("temperature", "temp"),
}
_ASKED_FOR = re.compile(
    r"(?<![a-z])(ref|reference|des|desired|cmd|command|commanded|demand|goal|target|set|setpoint|sp|err|error|p|d|ff)(?![a-z])"
)
"""Words in the name of a column that holds what a controller was asked for, or missed, or a part of what it gave, and
not what was measured."""
_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
"""A word of a name, also of one that is written as ``leftSpeed``."""
_NUMBER = re.compile(r"\d+")


def likely(
    channels: Sequence[str], free: Sequence[str], may_be: Callable[[str, str], bool] = lambda *_: True
) -> tuple[str, str] | None:
    """Return the channel and the column that looks like it by its name; ``None`` if no column looks like any.

    What was measured comes before what a controller was asked for.

    Args:
        channels: of which one would do, the first rather than the next.
        free: names of columns that are not in use, nor called as another channel.
        may_be: whether a column may be a channel, by the unit in its name.
    """
    measured = [name for name in free if not _ASKED_FOR.search(name.lower())]
    return _alike(channels, measured, may_be) or _alike(channels, free, may_be)


def _alike(channels: Sequence[str], free: Sequence[str], may_be: Callable[[str, str], bool]) -> tuple[str, str] | None:
    habits = [(word, channel) for channel in channels for word in _HABITS[channel]]
    lowered = {channel: {name.lower(): name for name in free if may_be(name, channel)} for channel in channels}
    for habit, channel in habits:
        for low, name in lowered[channel].items():
            words = low.rpartition("/")[2].replace(" ", "_").replace("[", "_").replace("(", "_")
            stem = words.split("_")[0].rstrip("0123456789")
            if low == habit or (len(habit) > 2 and low.startswith(habit)) or stem == habit:
                return channel, name
    for habit, channel in habits:
        near = get_close_matches(habit, lowered[channel], n=1, cutoff=0.75)
        if near:
            return channel, lowered[channel][near[0]]
    for habit, channel in habits:
        for low, name in lowered[channel].items():
            if len(habit) > 2 and habit in map(str.lower, _WORD.findall(name)) and not _ASKED_FOR.search(low):
                return channel, name
    return None


def overlooked(channel: str, free: Sequence[str], used: Collection[str]) -> str | None:
    """Return the column that looks like a measured channel and is not used; ``None`` if none does, or several do.

    Where the columns in use have a number, as those of one joint of several, it has the same one.

    Args:
        channel: that the recording lacks.
        free: names of columns that are not in use.
        used: names of those that are.
    """
    numbers = {tuple(_NUMBER.findall(name)) for name in used} - {()}
    measured = [name for name in free if not _ASKED_FOR.search(name.lower())]
    same = [name for name in measured if not numbers or tuple(_NUMBER.findall(name)) in numbers]
    first = likely((channel,), same)
    if first is None or likely((channel,), [name for name in same if name != first[1]]) is not None:
        return None
    return first[1]
