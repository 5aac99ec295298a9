"""MATLAB ``.mat`` files: up to version 7 by SciPy, version 7.3, which is HDF5, by h5py."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmodels.errors import InputError
from fricmodels.readers import hdf5
from fricmodels.readers.base import SeveralTables
from fricmodels.readers.vectors import kind, of_one_length, vectors

if TYPE_CHECKING:
    import pandas as pd


class MatlabReader(SeveralTables):
    """MATLAB files: every vector is a column.

    Fields of structures are called ``structure.field``; the columns of a matrix ``name(1)``, ``name(2)``, … as in
    MATLAB. The columns are those as long as the first that a mapping names, or else as most vectors are; scalars and
    vectors of other lengths are left out.
    """

    name = "matlab"
    suffixes = (".mat",)
    summary = "MATLAB .mat, version 7.3 included"
    apart = True

    def look(self, path: Path) -> None:
        """Refuse what has no header of a MATLAB file."""
        from scipy.io.matlab import matfile_version

        if hdf5.is_hdf5(path):
            return
        try:
            matfile_version(path)
        except Exception as error:
            raise _unreadable(path, error) from None

    def table_for(self, path: Path, asked: Collection[str]) -> pd.DataFrame:
        """Return the vectors as long as those asked for."""
        variables, what = self._variables(path)
        table = of_one_length(dict(vectors(variables)), asked)
        if table is None:
            held = ", ".join([*(f"{name} ({kind(value)})" for name, value in variables.items()), *what]) or "nothing"
            raise InputError(
                f"{path}: holds no numeric vectors but {held}; save the samples as plain vectors or a structure of them"
            )
        return table

    def _variables(self, path: Path) -> tuple[dict[str, Any], list[str]]:
        """Return the variables by name, and what could not be taken, in words."""
        import scipy.io

        if hdf5.is_hdf5(path):
            return hdf5.variables(path)
        try:
            content = scipy.io.loadmat(path, simplify_cells=True)
        except MemoryError:
            raise
        except Exception as error:
            raise _unreadable(path, error) from None
        return {name: value for name, value in content.items() if not name.startswith("__")}, []


def _unreadable(path: Path, error: Exception) -> InputError:
    reason = " ".join(str(error).split()).rstrip(".")
    return InputError(f"{path}: cannot be read as a MATLAB file: {reason}")
