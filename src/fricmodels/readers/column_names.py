"""What columns are usually called: which of them looks like a channel that was not found."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from difflib import SequenceMatcher, get_close_matches

_HABITS = {
    "time": ("t", "time", "stamp", "zeit", "sec", "timestamp", "millis", "micros"),
    "torque": ("torque", "tau", "effort", "tq", "trq", "moment", "drehmoment", "couple"),
    "force": ("force", "kraft", "effort", "thrust", "load"),
    "current": ("current", "i", "amps", "iq", "strom", "courant"),
    "velocity": ("velocity", "vel", "speed", "qd", "dq", "omega", "w", "rpm", "geschwindigkeit", "drehzahl", "vitesse"),
    "position": ("position", "pos", "q", "angle", "theta", "encoder", "winkel", "ticks"),
    "temperature": ("temperature", "temp"),
}
_ASKED_FOR = re.compile(
    r"(?<![a-z])(ref|reference|des|desired|cmd|command|commanded|demand|goal|target|set|setpoint|soll\w*|sp|err|error|p|d|ff"
    r"|gravity|coriolis|external|ext)(?![a-z])"
)
"""Words in the name of a column that holds what a controller was asked for, or missed, or a part of what it gave, or
what a model says, and not what was measured."""
_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
"""A word of a name, also of one that is written as ``leftSpeed``."""
_NUMBER = re.compile(r"\d+")
_BRACKET = re.compile(r"\s*[\[(][^\[(]*[\])]\s*$")
"""A unit or an index at the end of a name."""
_LONG = 6
"""Letters from which on a word may be the end of a longer one, as in ``Istgeschwindigkeit``."""


def likely(
    channels: Sequence[str],
    free: Sequence[str],
    may_be: Callable[[str, str], bool] = lambda *_: True,
    beside: Collection[str] = (),
) -> tuple[str, str] | None:
    """Return the channel and the column that looks like it by its name; ``None`` if no column looks like any.

    What was measured comes before what a controller was asked for, and a column of the same joint before another one.

    Args:
        channels: of which one would do, the first rather than the next.
        free: names of columns that are not in use, nor called as another channel.
        may_be: whether a column may be a channel, by the unit in its name.
        beside: names of other columns of the joint, if some are known.
    """
    measured = [name for name in free if not _ASKED_FOR.search(name.lower())]
    for names in (of_one_joint(measured, beside), measured, of_one_joint(free, beside), free):
        found = _alike(channels, names, may_be)
        if found is not None:
            return found
    return None


def of_one_joint(free: Sequence[str], beside: Collection[str]) -> list[str]:
    """Return the columns that have the same numbers in their names as others, the most alike first.

    All of them, as they stand, where those have none.
    """
    known = {name: _numbers(name) for name in beside if _numbers(name)}
    if not known:
        return list(free)
    same = [name for name in free if _numbers(name) in known.values()]
    return sorted(same, key=lambda name: -max(SequenceMatcher(None, name, other).ratio() for other in known))


def _numbers(name: str) -> tuple[str, ...]:
    """Return the numbers in a name; those of a unit are none of them, those of an index are."""
    unit = _BRACKET.search(name)
    return tuple(_NUMBER.findall(name if unit is None or "(" in unit.group() else name[: unit.start()]))


def _own_name(name: str) -> str:
    """Return a name without a unit or an index at its end, and without the names of what holds it, in small letters."""
    return re.split(r"[/.]", _BRACKET.sub("", name.lower()))[-1] or name.lower()


def _alike(channels: Sequence[str], free: Sequence[str], may_be: Callable[[str, str], bool]) -> tuple[str, str] | None:
    habits = [(word, channel) for channel in channels for word in _HABITS[channel]]
    possible = {channel: [name for name in free if may_be(name, channel)] for channel in channels}
    for habit, channel in habits:
        for name in possible[channel]:
            low = _own_name(name)
            stem = low.replace(" ", "_").split("_")[0].rstrip("0123456789")
            if habit in (name.lower(), low, stem) or (len(habit) > 2 and low.startswith(habit)):
                return channel, name
    for habit, channel in habits:
        lowered = {name.lower(): name for name in possible[channel]}
        near = get_close_matches(habit, lowered, n=1, cutoff=0.75)
        if near:
            return channel, lowered[near[0]]
    for habit, channel in habits:
        for name in possible[channel]:
            if _has_word(name, habit) and not _ASKED_FOR.search(name.lower()):
                return channel, name
    return None


def _has_word(name: str, habit: str) -> bool:
    """Whether a word stands within a name; of single letters only that of a position, which stands for nothing else."""
    words = [word.lower() for word in _WORD.findall(_BRACKET.sub("", name))]
    within = (len(habit) > 1 or habit == "q") and habit in words
    return within or (len(habit) >= _LONG and any(word.endswith(habit) for word in words))


def overlooked(channel: str, free: Sequence[str], used: Collection[str]) -> str | None:
    """Return the column that looks like a measured channel and is not used; ``None`` if none does, or several do.

    Where the columns in use have a number, as those of one joint of several, it has the same one.

    Args:
        channel: that the recording lacks.
        free: names of columns that are not in use.
        used: names of those that are.
    """
    measured = [name for name in free if not _ASKED_FOR.search(name.lower())]
    same = of_one_joint(measured, used)
    first = likely((channel,), same)
    if first is None or likely((channel,), [name for name in same if name != first[1]]) is not None:
        return None
    return first[1]
