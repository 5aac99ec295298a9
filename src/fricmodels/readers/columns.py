"""Which column of a table is which channel: standard names, and ``CHANNEL=COLUMN[:UNIT]``.

The column may contain spaces, equal signs and colons. A column of the whole name after the first ``=`` is taken
first; only if there is none, what follows the last colon is the unit, and without one the unit that the column's name
states (``Speed [rpm]``, ``pos_deg``). So ``velocity=a:b`` is the column ``a:b`` where the table has one, and the column
``a`` in the unit ``b`` otherwise. ``a [b]`` says the same.

A column that is called as a channel and states its unit, ``Position [deg]`` or ``velocity_deg_s``, needs no mapping.

A log without a time has rows at a known interval: ``time=row:5ms`` counts them, unless a column is called ``row``.

What else was recorded, such as another joint's motion, is a further channel: ``other.NAME=COLUMN[:UNIT]``, any number
of them. A column that is itself called ``other.NAME`` needs no mapping.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from fricmodels.dimension import Motion
from fricmodels.errors import InputError, suggestion
from fricmodels.readers import units
from fricmodels.readers.column_names import likely, of_one_joint, overlooked
from fricmodels.readers.header_units import NoUnit, contradicting, doubtful, may_measure, stated_size, stated_unit
from fricmodels.readers.own_names import by_own_names
from fricmodels.readers.standard_names import ALIASES, LINEAR, NAMES, STANDARD, standard_columns
from fricmodels.recording import OTHER

Mapped = Sequence[str] | Mapping[str, str | Mapping[str, str]]
"""Mappings as ``CHANNEL=COLUMN[:UNIT]``, or by channel; those of further channels under ``other``."""

_OF_THE_DRIVE = ("torque", "current", "velocity", "position")
"""Channels of one joint: where their columns have a number, it is the joint's."""
_WELCOME = ("position", "velocity", "temperature")
"""Channels without which a recording can be read, and shows less."""

_FURTHER = re.compile(re.escape(OTHER) + r"[A-Za-z_]\w*", re.ASCII)
ROW = "row"
"""What stands for the column of a time that was not recorded: the number of the row."""
_BRACKETS = re.compile(r"(.*\S)\s*[\[(](.*)[\])]")


@dataclass(frozen=True)
class Column:
    """One mapped channel: the name as written, the column, and the unit if one was given."""

    name: str
    column: str
    unit: str | None = None

    @property
    def channel(self) -> str:
        """The channel of the recording that it fills."""
        return ALIASES.get(self.name, self.name)

    def __str__(self) -> str:
        return f"{self.name}={self.column}" + (f":{self.unit}" if self.unit else "")


def parse(specification: str, present: Sequence[str]) -> Column:
    """Read ``CHANNEL=COLUMN[:UNIT]`` against the columns that are there.

    Raises:
        InputError: for an unknown channel, a column that is not there, or an unknown unit.
    """
    name, equals, rest = (part.strip() for part in specification.partition("="))
    if not equals or not rest:
        raise InputError(f"'{specification}' is no column mapping; write CHANNEL=COLUMN or CHANNEL=COLUMN:UNIT")
    if name.startswith(OTHER):
        if not _FURTHER.fullmatch(name):
            raise InputError(f"'{name}' is no name of a further channel; write {OTHER} and letters, digits or _")
    elif name not in NAMES:
        raise InputError(f"unknown channel '{name}' in '{specification}'{suggestion(name, [*NAMES, OTHER + 'NAME'])}")
    bracketed = _BRACKETS.fullmatch(rest)
    if rest in present:
        stated = bracketed[2] if bracketed and name.startswith(OTHER) and units.known(bracketed[2]) else None
        return Column(name, rest, stated)
    column, colon, unit = (part.strip() for part in rest.rpartition(":"))
    if bracketed and bracketed[1] in present:
        if bracketed[2].strip().isdecimal():
            if int(bracketed[2]) != 1:
                raise InputError(
                    f"'{bracketed[1]}' has one column; write {name}={bracketed[1]} or {name}={bracketed[1]}(1)"
                )
            return Column(name, bracketed[1])
        column, colon, unit = bracketed[1], ":", bracketed[2]
    if name == "time" and ROW not in present:
        if rest.rstrip(": ") == ROW:
            raise InputError(f"'{specification}' counts the rows: give the interval between two, as in time={ROW}:5ms")
        present = [*present, ROW] if column == ROW else present
    if colon and column in present:
        if not unit:
            return Column(name, column)
        if not units.known(unit):
            raise InputError(
                f"unknown unit '{unit}' in '{specification}'; write it as in deg/s, rpm, mA, N*m or count/2000"
            )
        return Column(name, column, unit)
    wanted = column if colon and units.known(unit) else rest
    raise InputError(f"there is no column '{wanted}' for the {name}{_near(wanted, present)}; columns: {_list(present)}")


def _written(columns: Mapped) -> Iterator[str]:
    """Yield each mapping as ``CHANNEL=COLUMN[:UNIT]``.

    Raises:
        InputError: for mappings below any other name than ``other``.
    """
    if isinstance(columns, str):
        yield columns
    elif not isinstance(columns, Mapping):
        yield from columns
    else:
        for name, column in columns.items():
            if isinstance(column, str):
                yield f"{name}={column}"
            elif f"{name}." == OTHER:
                yield from (f"{OTHER}{further}={of}" for further, of in column.items())
            else:
                raise InputError(f"the channel '{name}' takes one column; only 'other' has channels of its own")


def asked(columns: Mapped) -> list[str]:
    """Return every name of a column that the mappings may mean: with what looks like a unit, and without it."""
    names: dict[str, None] = {}
    for specification in _written(columns):
        rest = specification.partition("=")[2].strip()
        bracketed = _BRACKETS.fullmatch(rest)
        meant = (rest, rest.rpartition(":")[0].strip(), bracketed[1] if bracketed else "")
        names.update(dict.fromkeys(name for name in meant if name))
    return [*names]


def mapping(columns: Mapped, present: Sequence[str]) -> dict[str, Column]:
    """Read several mappings, of a list or ``{channel: "COLUMN[:UNIT]"}``; return them by channel.

    Raises:
        InputError: as :func:`parse`, and for a channel that is mapped twice.
    """
    found: dict[str, Column] = {}
    for specification in _written(columns):
        column = parse(specification, present)
        if column.channel in found:
            raise InputError(f"the channel '{column.name}' is mapped twice: '{found[column.channel]}' and '{column}'")
        found[column.channel] = column
    return found


def detect_motion(mapped: Mapping[str, Column], present: Sequence[str]) -> Motion:
    """Tell rotary from linear by the mapping's names and units, then by the standard names; rotary if nothing tells.

    Raises:
        InputError: when the mapping speaks of both.
    """
    said = {column.name: True for column in mapped.values() if column.name in ALIASES}
    for column in mapped.values():
        if column.unit and column.channel != "run" and not column.channel.startswith(OTHER):
            kinds = units.fits(column.unit, column.channel)
            if len(kinds) == 1:
                said[column.name] = kinds == {Motion.LINEAR}
    if len(set(said.values())) > 1:
        sliding = [name for name, linear in said.items() if linear]
        turning = [name for name, linear in said.items() if not linear]
        raise InputError(
            f"the mapping mixes a linear axis ({', '.join(sliding)}) with a rotary one ({', '.join(turning)}); "
            f"correct the units or name the motion"
        )
    if said:
        return Motion.LINEAR if next(iter(said.values())) else Motion.ROTARY
    fits = {
        motion: sum(channel in LINEAR and channel not in mapped for channel in standard_columns(motion, present))
        for motion in STANDARD
    }
    if fits[Motion.LINEAR] != fits[Motion.ROTARY]:
        return max(fits, key=lambda motion: fits[motion])
    own = [channel for channel in mapped if channel not in ("time", "run") and not channel.startswith(OTHER)]
    sources = [mapped[channel].column.lower() for channel in own]
    linear_names = sum(source.startswith("force") or source.endswith(("_n", "_m", "_m_s", "_mm")) for source in sources)
    rotary_names = sum("torque" in source or "rad" in source or source.endswith("nm") for source in sources)
    return Motion.LINEAR if linear_names > rotary_names else Motion.ROTARY


def assign(
    columns: Mapped, present: Sequence[str], motion: Motion | None, stated: Mapping[str, str] | None = None
) -> tuple[dict[str, Column], Motion]:
    """Return the column of each channel, and the motion: what is mapped, and standard names for the rest.

    Args:
        columns: mappings. present: names of the columns. motion: rotary or linear, if it is known.
        stated: units that the file gives beside the names, by column.

    Raises:
        InputError: naming a channel that is missing, the columns that are there and the way out; or a column that is
            there twice.
    """
    found = {
        channel: Column(column.name, column.column, column.unit or _stated(column))
        for channel, column in mapping(columns, present).items()
    }
    own = by_own_names(found, present, motion, stated or {})
    found |= {channel: Column(*column) for channel, column in own.items()}
    kind = motion or detect_motion(found, present)
    for channel, name in standard_columns(kind, present).items():
        if channel not in found:
            found[channel] = Column(channel, name)
    for name in dict.fromkeys(present):
        named = _BRACKETS.fullmatch(name)
        channel = named[1] if named else name
        if channel not in found and _FURTHER.fullmatch(channel):
            found[channel] = parse(f"{channel}={name}", present)
    for column in found.values():
        if list(present).count(column.column) > 1:
            count = list(present).count(column.column)
            raise InputError(f"the column '{column.column}' is there {count} times; rename all but one")
    if motion is not None:
        _check_kind(found, motion)
    _require(found, kind, present)
    return found, kind


def _check_kind(found: Mapping[str, Column], motion: Motion) -> None:
    """Refuse a unit of the other kind of motion than the one that is named."""
    for column in found.values():
        if column.unit is None or column.channel == "run" or column.channel.startswith(OTHER):
            continue
        kinds = units.fits(column.unit, column.channel)
        if kinds and motion not in kinds:
            raise InputError(
                f"'{column}' is in a unit of a {_other(motion)} drive; {_named(motion)}, or correct the unit"
            )


def _other(motion: Motion) -> Motion:
    return Motion.ROTARY if motion is Motion.LINEAR else Motion.LINEAR


def _named(motion: Motion) -> str:
    """Return how a kind of motion is taken back that was named."""
    asked = "--linear (motion: linear)" if motion is Motion.LINEAR else "'motion: rotary'"
    return f"leave out {asked} or a model of a {motion} drive"


def overlooked_columns(found: Mapping[str, Column], present: Sequence[str]) -> dict[str, str]:
    """Return by channel the columns that nothing uses, and that look like a channel that was not found."""
    used = [found[channel].column for channel in _OF_THE_DRIVE if channel in found]
    looked_for = (channel for channel in _WELCOME if channel not in found)
    likely_ones = ((channel, overlooked(channel, _free(found, present, (channel,)), used)) for channel in looked_for)
    return {channel: name for channel, name in likely_ones if name is not None}


def unread_units(found: Mapping[str, Column]) -> dict[str, str]:
    """Return by channel what is the matter with the unit that the name of a column states or may state, in words."""
    said = {}
    for channel, column in found.items():
        if channel == "run" or channel.startswith(OTHER):
            continue
        stated = stated_size(column.column, channel)
        if column.unit:
            if stated is not None and units.differ(stated, column.unit, channel):
                said[channel] = f"its name states '{stated}'"
        elif words := doubtful(column.column):
            said[channel] = f"'({words})' is not known as a unit"
        elif unit := contradicting(column.column, channel):
            said[channel] = f"'{unit}', in which its name ends, does not measure it"
    return said


def _free(found: Mapping[str, Column], present: Sequence[str], channels: Sequence[str]) -> list[str]:
    """Return the columns that are not in use, nor called as other channels than some."""
    taken = {column.column for column in found.values()}
    return [name for name in present if name not in taken and name.lower() not in set(NAMES).difference(channels)]


def _stated(column: Column) -> str | None:
    return None if column.channel == "run" else stated_unit(column.column, column.channel)


def _may_be(column: str, channel: str) -> bool:
    """Whether a column may be a channel, or one that has another name on a linear axis, by its unit."""
    return may_measure(column, ALIASES.get(channel, channel))


def _measured_in(channels: Sequence[str], free: Sequence[str]) -> tuple[str, str] | None:
    """Return the one column that states a unit of one of some channels, whatever it is called, as ``M [Nm]``."""
    stated = []
    for channel in channels:
        own = ALIASES.get(channel, channel)
        found = ((name, stated_size(name, own)) for name in free)
        stated += [(channel, name) for name, unit in found if unit is not None and units.fits(unit, own)]
    return stated[0] if len({name for _, name in stated}) == 1 else None


def _require(found: Mapping[str, Column], motion: Motion, present: Sequence[str]) -> None:
    force = "force" if motion is Motion.LINEAR else "torque"
    every = (("time",), (force, "current"), ("velocity", "position"))
    missing = [any_of for any_of in every if not any(ALIASES.get(channel, channel) in found for channel in any_of)]
    if not missing:
        return
    _refuse_other_kind(found, motion, present, {channel for any_of in missing for channel in any_of})
    options, beside = [], [column.column for column in found.values() if column.channel not in ("time", "run")]
    for any_of in missing:
        channels = tuple(dict.fromkeys((*any_of, *(ALIASES.get(channel, channel) for channel in any_of))))
        free = _free(found, present, channels)
        stated = _measured_in(channels, of_one_joint(free, beside)) or _measured_in(channels, free)
        channel, column = likely(channels, free, _may_be, beside) or stated or (any_of[0], None)
        beside += [column] if column is not None and channel != "time" else []
        options.append(_option(channel if channel in any_of else any_of[0], column))
        if channel == "velocity" and column is not None:
            further = [name for name in _free(found, present, ("position",)) if name != column]
            also = likely(("position",), of_one_joint(further, beside), _may_be, beside)
            options += [_option(*also)] if also is not None else []
    needed = _listed(["the " + " or ".join(any_of) for any_of in missing], "and")
    standard = _listed([STANDARD[motion][ALIASES.get(c, c)] for any_of in missing for c in any_of], "or")
    coasts = f", or add one of zeros if the drive coasts without a {force}" if missing == [(force, "current")] else ""
    raise InputError(
        f"no column for {needed}: none is called {standard}; "
        f"map {'one' if len(missing) == 1 else 'them'} with {' '.join(options)}{coasts}; columns: {_list(present)}"
    )


def _refuse_other_kind(
    found: Mapping[str, Column], motion: Motion, present: Sequence[str], missing: Collection[str]
) -> None:
    """Say where what is missing is there with the standard name of the other kind of motion."""
    lacking = {ALIASES.get(channel, channel) for channel in missing} & set(LINEAR)
    there = [name for channel, name in standard_columns(_other(motion), present).items() if channel in lacking]
    if not there:
        return
    said = [column for column in found.values() if _says(column, motion)]
    cause = f"'{said[0]}' is that of a {motion} one: correct it" if said else _named(motion)
    verb = "is a column" if len(there) == 1 else "are columns"
    raise InputError(f"{_listed(there, 'and')} {verb} of a {_other(motion)} drive; {cause}")


def _says(column: Column, motion: Motion) -> bool:
    """Whether the name or the unit of a mapped column is one of a kind of motion alone."""
    if column.name in ALIASES:
        return motion is Motion.LINEAR
    plain = not column.unit or column.channel == "run" or column.channel.startswith(OTHER)
    return not plain and units.fits(str(column.unit), column.channel) == {motion}


def _option(channel: str, column: str | None) -> str:
    """Return the option that maps a column, as a shell reads it; one that states its unit needs none."""
    name = column or "COLUMN"
    option = f"{channel}={name}"
    try:
        stated = column is not None and stated_unit(column, ALIASES.get(channel, channel)) is not None
    except NoUnit:
        return f"--column {shlex.quote(option + ':UNIT')}"
    quoted = shlex.quote(option)
    if channel == "time" and column is None:
        return f"--column {option}[:UNIT], or at a known interval --column time={ROW}:5ms"
    return f"--column {quoted}" if stated else f"--column {quoted}[:UNIT]"


def _listed(names: Sequence[str], last: str) -> str:
    return f" {last} ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _near(word: str, present: Sequence[str]) -> str:
    lowered = {name.lower(): name for name in present}
    near = get_close_matches(word.lower(), lowered, n=1, cutoff=0.5)
    return f"; did you mean '{lowered[near[0]]}'?" if near else ""


def _list(present: Sequence[str]) -> str:
    names = [str(name) for name in present]
    if len(names) > 1 and names == [str(i) for i, _ in enumerate(names, start=1)]:
        return f"1 to {len(names)}, since the file names none"
    return ", ".join(names[:20]) + (f" and {len(names) - 20} more" if len(names) > 20 else "")
