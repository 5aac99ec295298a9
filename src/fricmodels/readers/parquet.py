"""Apache Parquet, by pyarrow."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader

if TYPE_CHECKING:
    import pandas as pd


class ParquetReader(Reader):
    """Parquet files; a field's metadata ``unit`` gives the unit of a column mapped without one."""

    name = "parquet"
    suffixes = (".parquet", ".pq")
    summary = "Apache Parquet"

    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns."""
        import pyarrow
        import pyarrow.parquet

        try:
            table = pyarrow.parquet.read_table(path)
        except (pyarrow.ArrowException, OSError) as error:
            reason = " ".join(str(error).split()).rstrip(".")
            raise InputError(f"{path}: cannot be read as Parquet: {reason}") from None
        frame: pd.DataFrame = table.to_pandas(ignore_metadata=True)
        fields = [(field.name, field.metadata or {}) for field in table.schema]
        frame.attrs["units"] = {name: data[b"unit"].decode() for name, data in fields if b"unit" in data}
        return frame
