"""MATLAB ``.mat`` files up to version 7, by SciPy."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader

if TYPE_CHECKING:
    import pandas as pd


class MatlabReader(Reader):
    """MATLAB files: every vector is a column.

    Fields of structures are called ``structure.field``; the columns of a matrix ``name(1)``, ``name(2)``, … as in
    MATLAB. The columns are those whose length most vectors have; scalars and vectors of other lengths are left out.
    """

    name = "matlab"
    suffixes = (".mat",)
    summary = "MATLAB .mat up to version 7"
    apart = True

    def look(self, path: Path) -> None:
        """Refuse what has no header of a MATLAB file, and the format that is HDF5."""
        from scipy.io.matlab import matfile_version

        try:
            version, _ = matfile_version(path)
        except Exception as error:
            raise _unreadable(path, error) from None
        if version == 2:
            raise InputError(f"{path}: this is MATLAB 7.3 (HDF5); save it with save(..., '-v7')")

    def table(self, path: Path) -> pd.DataFrame:
        """Return the vectors of the most common length as columns."""
        import pandas as pd
        import scipy.io

        try:
            content = scipy.io.loadmat(path, simplify_cells=True)
        except MemoryError:
            raise
        except Exception as error:
            raise _unreadable(path, error) from None
        variables = {name: value for name, value in content.items() if not name.startswith("__")}
        columns = dict(_vectors(variables))
        lengths = Counter(len(values) for values in columns.values())
        if not lengths:
            held = ", ".join(f"{name} ({_kind(value)})" for name, value in variables.items()) or "nothing"
            raise InputError(
                f"{path}: holds no numeric vectors but {held}; save the samples as plain vectors or a structure of them"
            )
        length = max(lengths, key=lambda n: (lengths[n], n))
        return pd.DataFrame({name: values for name, values in columns.items() if len(values) == length})


def _unreadable(path: Path, error: Exception) -> InputError:
    reason = " ".join(str(error).split()).rstrip(".")
    return InputError(f"{path}: cannot be read as a MATLAB file: {reason}")


def _vectors(variables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in variables.items():
        label = f"{prefix}{name}"
        if isinstance(value, Mapping):
            yield from _vectors(value, f"{label}.")
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiubU" and value.size > 1:
            if value.ndim == 1:
                yield label, value
            elif value.ndim == 2:
                rows = value if value.shape[0] >= value.shape[1] else value.T
                yield from ((f"{label}({i + 1})", rows[:, i]) for i in range(rows.shape[1]))
        elif _is_text(value):
            yield label, value


def _is_text(value: Any) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.dtype.kind == "O"
        and value.ndim == 1
        and value.size > 1
        and all(isinstance(item, str) for item in value)
    )


def _kind(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return "complex" if value.dtype.kind == "c" else f"array of {value.dtype}"
    return type(value).__name__
