"""From a file to a recording."""

from __future__ import annotations

import hashlib
import os
import re
import stat
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.dimension import Motion
from fricmodels.errors import InputError, suggestion
from fricmodels.readers import units
from fricmodels.readers.apart import table_apart
from fricmodels.readers.base import Reader
from fricmodels.readers.checks import check
from fricmodels.readers.columns import ROW, Column, Mapped, asked, assign, overlooked_columns, unread_units
from fricmodels.readers.dates import stamps
from fricmodels.readers.gaps import Gaps, kept
from fricmodels.readers.joined import joined
from fricmodels.readers.registers import find_register
from fricmodels.readers.two_part_stamps import with_whole_stamps
from fricmodels.readers.vectors import unequal_lengths
from fricmodels.readers.wrapped_clock import going_on
from fricmodels.recording import OTHER, Recording
from fricmodels.signals.jumps import mend_jumps
from fricmodels.signals.outages import without_outages
from fricmodels.signals.polled import once_each
from fricmodels.signals.wrapping import unwrap

if TYPE_CHECKING:
    import pandas as pd


_WHOLE = 2.0**53
"""Below this every whole number is a float of its own."""
_THOUSANDS = re.compile(r"\s*[+-]?\d{1,3}(?:([.,'\s])\d{3})(?:\1\d{3})*(?:[.,]\d+)?\s*$")
"""A number with marks between its thousands, such as 1.000,5."""
_AS_IT_IS = units.Conversion(1.0, 0.0)
_LONGEST_UNIT = 60
_CLOCK = re.compile(r"\s*\d+\s*[:./-]\s*\d+\s*[:./-]\s*\d")
"""The beginning of a date or of a time of the day."""
_COUNTED_ON = ("time", "position")
"""What goes on where a counter begins anew: see :mod:`fricmodels.signals.wrapping`."""


def read(
    path: str | Path,
    *,
    columns: Mapped = (),
    motion: Motion | None = None,
    name: str | None = None,
    reader: str | None = None,
    torque_constant: float | None = None,
    gaps: Gaps | Literal["drop", "split", "join"] | None = None,
) -> Recording:
    """Read a recording.

    Args:
        path: the file; its suffix decides the reader.
        columns: mappings ``CHANNEL=COLUMN[:UNIT]`` for what does not have the standard names, and for further channels,
            see :mod:`fricmodels.readers.columns`; without a unit the column is in SI, or in the unit that the file
            states.
        motion: rotary or linear; found from names and units if not given.
        name: of the recording; the file's stem if not given.
        reader: name of the reader, if not by suffix.
        torque_constant: K_t [N m/A, or N/A], which makes torque of the current where no torque was measured.
        gaps: what is done with rows that hold no number, and where the clock starts anew; see
            :mod:`fricmodels.readers.gaps` and :mod:`fricmodels.readers.joined`. How many were left out is in
            ``provenance["gaps"]``.

    Returns:
        The recording in SI units, samples of each run together, checked by :func:`fricmodels.readers.check`; a position
        that jumps by a whole turn, or by the range of a counter, is unwrapped.

    Raises:
        InputError: for a file that is not there or holds nothing usable; one line with the place and the way out.
    """
    if not isinstance(path, str | os.PathLike):
        raise InputError(f"read takes the path of a file, got a {type(path).__name__}; write a table to a file first")
    source = Path(path)
    check_file(source)
    chosen = reader_of(source, reader)
    try:
        wanted = asked(columns)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
    table = with_whole_stamps(_table(chosen, source, wanted))
    present = [str(column) for column in table.columns]
    try:
        stated = table.attrs.get("units", {})
        found, kind = assign(columns, present, motion, stated)
        lengths = table.attrs.get("other_lengths", {})
        lacking = overlooked_columns(found, [*present, *lengths])
        overlooked = {channel: column for channel, column in lacking.items() if column in present}
        unequal = unequal_lengths(lengths, len(table), {*lacking.values()})
        found = with_stated_units(found, stated)
        converted = conversions(found, kind, torque_constant)
        further = {channel: units.further(column.unit) for channel, column in _further(found).items() if column.unit}
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
    if not len(table):
        raise InputError(f"{source}: there are no samples")
    run, run_names = _runs(source, chosen, found, table)
    order = np.argsort(run, kind="stable")
    converted |= {channel: (channel, further.get(channel, (_AS_IT_IS, ""))[0]) for channel in _further(found)}
    run = run[order]
    channels, registers, clock = {}, {}, 0.0
    for channel, (column, conversion) in converted.items():
        values = numbers(source, chosen, table, found[column])[order]
        if channel == "time":
            values, clock = going_on(values, run)
        register = find_register(values) if column not in _COUNTED_ON else None
        if register is not None:
            registers[channel], values = str(register), register.signed(values)
        channels[channel] = conversion(values)
    del table
    chosen.done()
    left: dict[str, Any] = {}
    if gaps is not None:
        brought: list[str] = []
        if Gaps(gaps) is Gaps.JOIN:
            channels, brought = joined(channels, run)
        found_rows = kept(channels, run, Gaps(gaps))
        channels = {channel: values[found_rows.rows] for channel, values in channels.items()}
        run, order = found_rows.run, order[found_rows.rows]
        run_names = run_names if not found_rows.added else {}
        left = {"gaps": str(found_rows)} if found_rows.dropped or found_rows.alone or found_rows.added else {}
        if brought:
            left = {"gaps": f"{found_rows}; {', '.join(brought)} interpolated to the rows of the motion"}
        if not len(order):
            where = "at no sample of the motion is there" if brought else "no row has"
            way_out = (
                "" if brought else "; channels that stand in rows of their own are brought together by --gaps join"
            )
            raise InputError(f"{source}: {where} a number in every channel{way_out}")
    recording = Recording(
        name=name or source.stem,
        motion=kind,
        channels=channels,
        run=run,
        provenance={
            "source": str(source),
            "sha256": _sha256(source),
            "reader": chosen.name,
            "columns": {channel: str(column) for channel, column in found.items()},
            **({"overlooked": overlooked} if overlooked else {}),
            **({"other_lengths": unequal} if unequal else {}),
            **({"unread_units": unread} if (unread := unread_units(found)) else {}),
            **({"registers": registers} if registers else {}),
            **({"clock_period": clock} if clock else {}),
            **({"runs": run_names} if run_names else {}),
            **left,
            **({"torque_constant": torque_constant} if torque_constant is not None else {}),
        },
        units={channel: further.get(channel, (_AS_IT_IS, ""))[1] for channel in _further(found)},
    )
    check(recording, lambda row: chosen.place(source, int(order[row])))
    return mend_jumps(unwrap(without_outages(once_each(recording))))


def _table(reader: Reader, source: Path, wanted: Sequence[str]) -> pd.DataFrame:
    """Return the reader's table, or one line that says why there is none; a plugin's reader is named."""
    try:
        reader.look(source)
        if reader.apart:
            return table_apart(reader, source, wanted)
        with redirect_stdout(StringIO()):  # what a plugin prints is no result of ours
            return reader.table_for(source, wanted)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        reason = " ".join(str(error).split()) or "no reason is given"
        raise InputError(
            f"{source}: the reader '{reader.name}' cannot read it: {type(error).__name__}: {reason}"
        ) from error


def check_file(source: Path) -> None:
    """Make sure that a file is there, is one, and has a first byte.

    Raises:
        InputError: where it is not.
    """
    try:
        kind = source.stat().st_mode
    except (OSError, ValueError) as error:
        if not isinstance(error, FileNotFoundError):
            raise InputError(f"{source}: cannot be opened: {getattr(error, 'strerror', error)}") from None
    else:
        if not stat.S_ISREG(kind) and not stat.S_ISDIR(kind):
            raise InputError(f"{source}: is a device or a pipe, no file; write the samples into a file first")
    if source.is_dir():
        raise InputError(f"{source}: is a directory; name a file in it")
    if not source.exists():
        near = suggestion(source.name, [p.name for p in source.parent.iterdir()]) if source.parent.is_dir() else ""
        raise InputError(f"{source}: there is no such file{near if 'did you mean' in near else ''}")
    try:
        with source.open("rb") as stream:
            start = stream.read(1)
    except OSError as error:
        raise InputError(f"{source}: cannot be opened: {error.strerror}") from None
    if not start:
        raise InputError(f"{source}: the file is empty")


def reader_of(source: Path, name: str | None) -> Reader:
    """Return the reader of a file, by name or by its suffix.

    Raises:
        InputError: where there is none.
    """
    from fricmodels import plugins

    readers: plugins.Registry[Reader] = plugins.load().readers
    if name is not None:
        return readers[name]()
    suffix = source.suffix.lower()
    for candidate in readers:
        if suffix in readers[candidate].suffixes:
            return readers[candidate]()
    known = ", ".join(suffix for candidate in readers for suffix in readers[candidate].suffixes)
    raise InputError(f"{source}: no reader knows the file type '{source.suffix}'; known: {known}; or give --reader")


def with_stated_units(found: Mapping[str, Column], stated: Mapping[str, str]) -> dict[str, Column]:
    """Complete mappings without unit from the units that the file states."""
    for channel, column in found.items():
        unit = stated.get(column.column, "")
        if column.unit is None and channel != "run" and unit and not units.known(unit):
            shown = unit if len(unit) < _LONGEST_UNIT else unit[:_LONGEST_UNIT] + "…"
            raise InputError(
                f"column '{column.column}': the file gives the unknown unit '{shown}'; correct it, or give one, as in "
                f"--column {channel}={column.column}:UNIT"
            )
    return {
        channel: Column(column.name, column.column, stated[column.column])
        if column.unit is None and column.column in stated and channel != "run"
        else column
        for channel, column in found.items()
    }


def conversions(
    found: Mapping[str, Column], motion: Motion, torque_constant: float | None
) -> dict[str, tuple[str, units.Conversion]]:
    """Return for each channel which mapped column fills it, and how it is converted."""
    result: dict[str, tuple[str, units.Conversion]] = {}
    driven = found.get("torque", found.get("current"))
    by_current = driven is not None and (
        driven.channel == "current" or (driven.unit is not None and units.is_current(driven.unit))
    )
    if by_current and torque_constant is None:
        unit = "N/A" if motion is Motion.LINEAR else "N m/A"
        raise InputError(f"'{driven}' is a current: give the torque constant [{unit}] with --torque-constant")
    if torque_constant is not None and not by_current:
        raise InputError(f"a torque constant was given, but '{driven}' is no current")
    if torque_constant is not None and not (np.isfinite(torque_constant) and torque_constant != 0.0):
        raise InputError(f"the torque constant must be finite and not zero, got {torque_constant}")
    for channel, column in found.items():
        if channel == "run" or channel.startswith(OTHER):
            continue
        target = "current" if by_current and channel == "torque" else channel
        conversion = units.conversion(column.unit, target, motion) if column.unit else _AS_IT_IS
        result[target] = (channel, conversion)
    if by_current and torque_constant is not None:
        filled, conversion = result["current"]
        factor, offset = (torque_constant * part for part in (conversion.factor, conversion.offset))
        result["torque"] = (filled, units.Conversion(factor, offset))
    return result


def _further(found: Mapping[str, Column]) -> dict[str, Column]:
    return {channel: column for channel, column in found.items() if channel.startswith(OTHER)}


def numbers(source: Path, reader: Reader, table: pd.DataFrame, column: Column) -> Array:
    """Return the numbers of a column; stamps are seconds from the first.

    Raises:
        InputError: for what is no number, with its place.
    """
    import pandas as pd

    if column.column == ROW and ROW not in table:
        return np.arange(float(len(table)))
    values = table[column.column]
    if values.dtype.kind in "mM":
        if column.channel != "time":
            raise InputError(
                f"{source}: column '{column.column}' ({column.channel}) holds dates or times, no numbers; "
                f"name another with --column, or remove it"
            )
        since = values if values.dtype.kind == "m" else values - values.iloc[0]
        return np.asarray(since.dt.total_seconds(), dtype=float)
    if pd.api.types.is_numeric_dtype(values):
        return values.to_numpy(dtype=float, na_value=np.nan)
    try:
        numbers = pd.to_numeric(values, errors="coerce")
    except OverflowError:  # a column of whole numbers, one of them beyond what a float holds
        numbers = pd.to_numeric(values.map(str), errors="coerce")
    if column.channel == "time" and numbers.isna().all():
        taken = stamps(values.map(str), column.column)
        if taken is not None:
            return np.asarray((taken - taken.iloc[0]).dt.total_seconds(), dtype=float)
    wrong = np.flatnonzero((numbers.isna() & values.notna()).to_numpy())
    if len(wrong):
        value = str(values.iloc[int(wrong[0])])
        if column.channel == "time" and _CLOCK.match(value):
            raise InputError(
                f"{source}: column '{column.column}': '{value[:40]}' is neither a number nor a date and time that can "
                f"be read in one way only, as ISO 8601 writes them (2024-05-01T13:59:57.002) or with points "
                f"(01.05.2024 13:59:57.002); write the stamps so, state their order in the name of the column, as in "
                f"'Time [dd/mm/yyyy]', or count the rows at their interval, as with --column time={ROW}:2ms"
            )
        others = f", and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        way = "write it without marks between thousands" if _THOUSANDS.match(value) else "remove or repair those rows"
        raise InputError(
            f"{source}: {reader.place(source, int(wrong[0]))}, column '{column.column}': "
            f"'{value[:40]}' is not a number{others}; {way}"
        )
    return numbers.to_numpy(dtype=float, na_value=np.nan)


def _runs(
    source: Path, reader: Reader, found: Mapping[str, Column], table: pd.DataFrame
) -> tuple[Index, dict[int, str]]:
    """Return the run number of each row, and the names of runs that are not whole numbers."""
    import pandas as pd

    if "run" not in found:
        return np.zeros(len(table), dtype=np.int64), {}
    values = table[found["run"].column]
    empty = np.flatnonzero(values.isna().to_numpy())
    if len(empty):
        raise InputError(
            f"{source}: {reader.place(source, int(empty[0]))}, column '{found['run'].column}': the run is not named; "
            f"name it, or remove that row"
        )
    if pd.api.types.is_numeric_dtype(values) and (values == values.round()).all() and (values.abs() < _WHOLE).all():
        return values.to_numpy(dtype=np.int64), {}
    codes, names = pd.factorize(values.map(str))
    return codes.astype(np.int64), {i: str(label) for i, label in enumerate(names)}


def _sha256(source: Path) -> str:
    with source.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
