"""Apache Parquet, by pyarrow."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader

if TYPE_CHECKING:
    import pandas as pd


_MOST_COLUMNS = 10_000
_ALWAYS = 200_000_000
_MOST_TIMES = 100
_TICKS = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


class ParquetReader(Reader):
    """Parquet files; a field's metadata ``unit`` gives the unit of a column mapped without one."""

    name = "parquet"
    suffixes = (".parquet", ".pq")
    summary = "Apache Parquet"

    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns."""
        import pyarrow
        import pyarrow.compute
        import pyarrow.parquet

        try:
            check_size(path, pyarrow.parquet.read_metadata(path))
            table = in_seconds(pyarrow.parquet.read_table(path))
            units = stated_units(table.schema)
            frame: pd.DataFrame = table.to_pandas(ignore_metadata=True, split_blocks=True, self_destruct=True)
            del table  # its columns are the frame's now, and are let go with them
        except (pyarrow.ArrowException, OSError, ValueError) as error:
            reason = " ".join(str(error).split()).rstrip(".")
            raise InputError(f"{path}: cannot be read as Parquet: {reason}") from None
        frame.attrs["units"] = units
        return frame

    def done(self) -> None:
        """Give the memory of a table back to the system, which Arrow would keep for the next one."""
        import pyarrow

        pyarrow.default_memory_pool().release_unused()


def stated_units(schema: Any) -> dict[str, str]:
    """Return the units that the fields of a file state, by column."""
    fields = [(field.name, field.metadata or {}) for field in schema]
    return {name: data[b"unit"].decode(errors="replace") for name, data in fields if b"unit" in data}


def check_size(path: Path, metadata: Any) -> None:
    """Refuse what unpacks to far more than a recording of its size does, before it is unpacked."""
    if metadata.num_columns > _MOST_COLUMNS:
        raise InputError(
            f"{path}: has {metadata.num_columns} columns, more than {_MOST_COLUMNS}; keep those of one drive"
        )
    unpacked = 8 * metadata.num_rows * metadata.num_columns
    if unpacked > max(_ALWAYS, _MOST_TIMES * path.stat().st_size):
        raise InputError(
            f"{path}: {metadata.num_rows} rows of {metadata.num_columns} columns unpack to {unpacked / 1e9:.3g} GB, "
            f"over {_MOST_TIMES} times the file; is it all one value?"
        )


def in_seconds(table: Any) -> Any:
    """Return the table with times of day as seconds, which pandas has as objects if at all."""
    import pyarrow

    for number, field in enumerate(table.schema):
        if pyarrow.types.is_time(field.type):
            whole = pyarrow.int32() if pyarrow.types.is_time32(field.type) else pyarrow.int64()
            ticks = table.column(number).cast(whole).cast(pyarrow.float64())
            seconds = pyarrow.compute.divide(ticks, _TICKS[field.type.unit])
            table = table.set_column(number, field.name, seconds)
    return table
