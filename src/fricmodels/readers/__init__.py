"""From files to recordings. The built-in readers, one format a file, register through the same hook as anybody's."""

from __future__ import annotations

from fricmodels.hookspecs import hookimpl
from fricmodels.readers.bag import BagReader
from fricmodels.readers.base import Reader
from fricmodels.readers.checks import check
from fricmodels.readers.csv import CsvReader
from fricmodels.readers.hdf5 import Hdf5Reader
from fricmodels.readers.json import JsonReader
from fricmodels.readers.matlab import MatlabReader
from fricmodels.readers.parquet import ParquetReader
from fricmodels.readers.reading import read
from fricmodels.readers.together import read_together, together

__all__ = ["Reader", "check", "read", "read_together", "together"]


@hookimpl
def fricmodels_readers() -> list[type[Reader]]:
    """Return the built-in readers."""
    return [CsvReader, ParquetReader, MatlabReader, Hdf5Reader, JsonReader, BagReader]
