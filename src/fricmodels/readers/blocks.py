"""A file read block by block, the columns that are wanted only: what is too long to be held is never held."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.readers.checks import GREATEST
from fricmodels.readers.columns import Column, Mapped, assign
from fricmodels.readers.parquet import ParquetReader, check_size, in_seconds, stated_units
from fricmodels.readers.reading import check_file, conversions, numbers, read, reader_of, with_stated_units
from fricmodels.readers.units import Conversion

_ROWS = 1 << 16
"""Rows of a block of a Parquet file."""


@dataclass(frozen=True)
class Block:
    """Samples that follow one another in a file.

    Attributes:
        channels: in SI units, shape (N,) each. run: number of the run of each sample, shape (N,).
        first: number of the first row in the file.
    """

    channels: Mapping[str, Array]
    run: Index
    first: int


@dataclass(frozen=True)
class Blocks:
    """A file whose samples come block by block; it can be gone through again.

    Attributes:
        source: the file. rows: how many it has. motion: rotary or linear.
        channels: those that it has.
    """

    source: Path
    rows: int
    motion: Motion
    channels: tuple[str, ...]
    _columns: Mapping[str, Column] = field(default_factory=dict)
    _conversions: Mapping[str, tuple[str, Conversion]] = field(default_factory=dict)
    _whole: Block | None = None

    def of(self, wanted: Sequence[str]) -> Iterator[Block]:
        """Yield the blocks with some channels.

        Raises:
            InputError: for values that cannot be read, with their place.
        """
        if self._whole is not None:
            channels = {name: self._whole.channels[name] for name in wanted}
            yield Block(channels, self._whole.run, self._whole.first)
            return
        yield from self._parquet(wanted)

    def _parquet(self, wanted: Sequence[str]) -> Iterator[Block]:
        import pyarrow.parquet

        chosen = {name: self._columns[self._conversions[name][0]] for name in wanted}
        run = self._columns.get("run")
        names = {column.column for column in chosen.values()} | ({run.column} if run else set())
        first, reader, begin = 0, ParquetReader(), dict[str, Any]()
        with _told(self.source), pyarrow.parquet.ParquetFile(self.source, pre_buffer=False) as file:
            stored = sorted(names.intersection(file.schema_arrow.names))  # a counted row is not
            for batch in file.iter_batches(batch_size=_ROWS, columns=stored, use_threads=False):
                channels = {}
                for name, column in chosen.items():
                    values = self._values(batch, column, first, reader, begin)
                    channels[name] = self._conversions[name][1](values)
                yield Block(channels, self._runs(batch, run, first), first)
                first += len(batch)

    def _values(self, batch: Any, column: Column, first: int, reader: Any, begin: dict[str, Any]) -> Array:
        """Return the numbers of a column of a batch: as they stand in memory where they are doubles."""
        import pyarrow

        if column.column not in batch.schema.names:
            return np.arange(float(first), float(first + len(batch)))
        stored = batch.column(batch.schema.get_field_index(column.column))
        if pyarrow.types.is_float64(stored.type) and not stored.null_count:
            values: Array = stored.to_numpy()
            return values
        frame = in_seconds(pyarrow.table({column.column: stored})).to_pandas(ignore_metadata=True)
        if pyarrow.types.is_timestamp(stored.type):
            frame[column.column] -= begin.setdefault(column.column, frame[column.column].iloc[0])
        try:
            return numbers(self.source, reader, frame, column)
        except InputError as error:
            if not first:
                raise
            raise InputError(f"{error} (counted from row {first + 1})") from None

    def _runs(self, batch: Any, run: Column | None, first: int) -> Index:
        if run is None:
            return np.zeros(len(batch), dtype=np.int64)
        stored = batch.column(batch.schema.get_field_index(run.column))
        try:
            values = np.asarray(stored.to_numpy(zero_copy_only=False), dtype=float)
            whole = np.isfinite(values) & (values == np.round(values)) & (np.abs(values) < 2.0**53)
        except (TypeError, ValueError):
            whole = np.zeros(len(batch), dtype=bool)
        if not whole.all():
            row = first + int(np.argmin(whole)) + 1
            raise InputError(
                f"{self.source}: row {row}, column '{run.column}': a file that is read in blocks names its runs by "
                f"whole numbers; number them, or fit it without sums"
            )
        return values.astype(np.int64)


def blocks(
    path: str | Path,
    *,
    columns: Mapped = (),
    motion: Motion | None = None,
    reader: str | None = None,
    torque_constant: float | None = None,
) -> Blocks:
    """Open a file to be read block by block; a format other than Parquet is one block, and held as a whole.

    Args:
        path, columns, motion, reader, torque_constant: see :func:`fricmodels.readers.read`.

    Raises:
        InputError: for a file that cannot be read.
    """
    source = Path(path)
    check_file(source)
    if reader_of(source, reader).name != "parquet":
        whole = read(source, columns=columns, motion=motion, reader=reader, torque_constant=torque_constant)
        block = Block(whole.channels, whole.run, 0)
        return Blocks(source, len(whole), whole.motion, tuple(whole.channels), _whole=block)
    import pyarrow.parquet

    with _told(source):
        metadata = pyarrow.parquet.read_metadata(source)
        schema = pyarrow.parquet.read_schema(source)
    check_size(source, metadata)
    try:
        stated = stated_units(schema)
        found, kind = assign(columns, schema.names, motion, stated)
        found = with_stated_units(found, stated)
        given = conversions(found, kind, torque_constant)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
    if not metadata.num_rows:
        raise InputError(f"{source}: there are no samples")
    return Blocks(source, metadata.num_rows, kind, tuple(given), found, given)


@contextmanager
def _told(source: Path) -> Iterator[None]:
    """Say in one line what Arrow cannot read."""
    import pyarrow

    try:
        yield
    except (pyarrow.ArrowException, OSError) as error:
        reason = " ".join(str(error).split()).rstrip(".")
        raise InputError(f"{source}: cannot be read as Parquet: {reason}") from None


def check_values(source: Path, block: Block) -> None:
    """Check that all values of a block are numbers that can be computed with.

    Raises:
        InputError: naming the first row that has one that cannot.
    """
    for name, values in block.channels.items():
        least, most = float(values.min()), float(values.max())
        if not (np.isfinite(least) and np.isfinite(most)):
            row = block.first + int(np.flatnonzero(~np.isfinite(values))[0]) + 1
            raise InputError(
                f"{source}: row {row}, {name}: an empty field, NaN or an infinite value; remove or repair those rows, "
                f"or leave them out with --gaps drop or --gaps split"
            )
        if max(abs(least), abs(most)) > GREATEST:
            raise InputError(f"{source}: {name} goes up to {max(abs(least), abs(most)):.3g}, which no drive does; "
                             f"correct its unit")  # fmt: skip
