"""Columns that are called as a channel, and state a unit of it: ``Position [deg]``, or ``Position`` over ``[deg]``."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from fricmodels.dimension import Motion
from fricmodels.readers import units
from fricmodels.readers.header_units import stated_size, without_unit
from fricmodels.readers.standard_names import ALIASES, NAMES, SPOKEN, STANDARD, standard_columns


def by_own_names(
    found: Collection[str], present: Sequence[str], motion: Motion | None, stated: Mapping[str, str]
) -> dict[str, tuple[str, str, str]]:
    """Return the name, the column and its unit of each channel that a column is called by.

    A mapping and a standard name go first. Where two columns are called so, or their units are those of a linear axis
    and of a rotary one, none is taken: that only the user knows. A ``Speed``, maybe without a sign, comes after others.

    Args:
        found: channels that are mapped.
        present: names of the columns.
        motion: rotary or linear, if it is known.
        stated: units that the file gives beside the names, by column.
    """
    called: dict[str, list[tuple[str, str, str]]] = {}
    names = [without_unit(column).lower() for column in present]
    known = {*found, *names, *(channel for kind in STANDARD for channel in standard_columns(kind, present))}
    for column, own in zip(present, names, strict=True):
        name = own if known & {"position", "velocity"} else SPOKEN.get(own, own)
        channel = ALIASES.get(name, name)
        standard = any(channel in standard_columns(kind, present) for kind in STANDARD)
        if name not in NAMES or channel in ("run", *found) or standard:
            continue
        beside = stated.get(column)
        unit = stated_size(column, channel) or (beside and stated_size(f"{column} [{beside}]", channel))
        if unit and (motion is None or motion in (units.fits(unit, channel) or Motion)):
            called.setdefault(channel, []).append((name, column, unit))
    taken = {channel: columns[0] for channel, columns in called.items() if len(columns) == 1}
    kinds = [units.fits(unit, channel) or {*Motion} for channel, (_, _, unit) in taken.items()]
    return taken if {*Motion}.intersection(*kinds) else {}
