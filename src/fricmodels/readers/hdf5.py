"""HDF5 files, and MATLAB's of version 7.3, by h5py: in a process of their own, and bounded in what they unpack to.

Only what lies in the file itself is read: links to other files, and data kept in other files, are left out.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.errors import InputError
from fricmodels.readers.base import SeveralTables
from fricmodels.readers.vectors import columns_of, of_one_length

if TYPE_CHECKING:
    import pandas as pd

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_STARTS = (0, 512, 1024, 2048, 4096)
"""Where an HDF5 file may begin, after a block of somebody else's such as MATLAB's header."""
_MOST_OBJECTS = 10_000
_DEEPEST = 20
_ALWAYS = 200_000_000
_MOST_TIMES = 100
_UNITS = ("unit", "units")
GROUP = "group"
"""Column with the name of each row's group, where groups with the same columns are to be the runs of a recording."""


class Hdf5Reader(SeveralTables):
    """HDF5 files: every data set is a column, called by its path, as in ``/run1/velocity``.

    Data sets outside of groups, and those of a file that has one group only, are called by their names alone. Columns
    of a matrix are ``name(1)``, ``name(2)``, …, those of a compound type ``name.field``. The columns are as long as the
    first that a mapping names, or else as most are. ``--column run=group`` takes all groups that have the same data
    sets as the runs of one recording. An attribute ``unit`` or ``units`` gives the unit of a column.
    """

    name = "hdf5"
    suffixes = (".h5", ".hdf5", ".hdf")
    summary = "HDF5; columns in groups are /GROUP/NAME"
    apart = True

    def look(self, path: Path) -> None:
        """Refuse what does not begin as an HDF5 file."""
        if not is_hdf5(path):
            raise InputError(f"{path}: is no HDF5 file; its content begins otherwise")

    def table_for(self, path: Path, asked: Collection[str]) -> pd.DataFrame:
        """Return the data sets as long as those asked for."""
        with _opened(path) as file:
            found = _Content(path, file)
            columns, units = found.columns()
        short = {name.rpartition("/")[2]: name for name in columns}
        alone = len({name.rpartition("/")[0] for name in columns}) == 1 and not any(
            name.startswith("/") for name in asked
        )
        if GROUP in asked and GROUP not in columns:
            table, names = _stacked(path, columns)
        else:
            if alone:
                columns = {name: columns[full] for name, full in short.items()}
            one_length = of_one_length(columns, asked)
            if one_length is None:
                held = ", ".join(found.left_out) or "nothing"
                raise InputError(f"{path}: holds no numeric vectors but {held}; save the samples as one vector each")
            table, names = one_length, short if alone else {name: name for name in columns}
        table.attrs["units"] = {name: units[full] for name, full in names.items() if full in units}
        return table


def is_hdf5(path: Path) -> bool:
    """Whether a file begins as HDF5 does, at one of the places where it may begin."""
    with path.open("rb") as stream:
        for start in _STARTS:
            stream.seek(start)
            if stream.read(len(_SIGNATURE)) == _SIGNATURE:
                return True
    return False


def variables(path: Path) -> tuple[dict[str, Any], list[str]]:
    """Return the variables of a MATLAB file of version 7.3 as SciPy would, and what could not be taken, in words."""
    with _opened(path) as file:
        content = _Content(path, file)
        return content.matlab(file), content.left_out


class _opened:
    """An HDF5 file, whatever h5py says against it as one line."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> Any:
        try:
            import h5py
        except ImportError:
            raise InputError(f"{self.path}: HDF5 needs h5py: pip install h5py") from None
        try:
            self.file = h5py.File(self.path, "r", locking=False)
        except (OSError, ValueError, RuntimeError, KeyError) as error:
            raise _unreadable(self.path, error) from None
        return self.file

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        self.file.close()
        if isinstance(error, Exception) and not isinstance(error, InputError | MemoryError):
            raise _unreadable(self.path, error) from None


def _unreadable(path: Path, error: Exception) -> InputError:
    reason = " ".join(str(error).split()).rstrip(".") or type(error).__name__
    return InputError(f"{path}: cannot be read as HDF5: {reason}; the file is damaged or still being written")


class _Content:
    """The data sets of a file: walks it once, and bounds what is read."""

    def __init__(self, path: Path, file: Any) -> None:
        self.path, self.file = path, file
        self.left_out: list[str] = []
        self._seen = 0
        self._bytes = 0
        self._room = max(_ALWAYS, _MOST_TIMES * path.stat().st_size)

    def columns(self) -> tuple[dict[str, Any], dict[str, str]]:
        """Return all vectors by path, those of the root by name, and the units of those that state them."""
        columns: dict[str, Any] = {}
        units: dict[str, str] = {}
        for name, dataset in self._walk(self.file, "", ()):
            own: dict[str, Any] = {}
            for label, value in self._parts(name, dataset):
                own.update(columns_of(label, value))
            if not own:
                self.left_out.append(f"{name} ({_what(dataset)})")
            columns |= own
            unit = _unit(dataset)
            if unit:
                units |= dict.fromkeys(own, unit)
        return columns, units

    def _walk(self, group: Any, prefix: str, above: tuple[Any, ...]) -> Iterator[tuple[str, Any]]:
        """Yield every data set with its path; a group that contains itself is entered once."""
        import h5py

        for name in group:
            self._count()
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                self.left_out.append(f"{prefix}{name} (a link)")
                continue
            item = group[name]
            if isinstance(item, h5py.Dataset):
                yield (f"/{prefix}{name}" if prefix else name), item
            elif isinstance(item, h5py.Group) and item not in above and len(above) < _DEEPEST:
                yield from self._walk(item, f"{prefix}{name}/", (*above, item))

    def _count(self) -> None:
        self._seen += 1
        if self._seen > _MOST_OBJECTS:
            raise InputError(f"{self.path}: holds more than {_MOST_OBJECTS} data sets; keep those of one drive")

    def _parts(self, name: str, dataset: Any) -> Iterator[tuple[str, Any]]:
        """Yield the values of a data set, and of each field of a compound one."""
        if dataset.ndim not in (1, 2) or dataset.size < 2:
            return
        if dataset.ndim == 2 and min(dataset.shape) > _MOST_OBJECTS:
            return
        if dataset.dtype.names:
            value = self._read(dataset)
            if value is not None and value.ndim == 1:
                fields = value.dtype.names or ()
                yield from ((f"{name}.{field}", value[field]) for field in fields if value[field].dtype.kind in "fiub")
            return
        value = self._read(dataset)
        if value is not None:
            yield name, value

    def _read(self, dataset: Any) -> Any:
        """Return the content of a data set of numbers or text, within the bound of the whole; ``None`` for others."""
        import h5py

        text = h5py.check_string_dtype(dataset.dtype) is not None
        if not (dataset.dtype.kind in "fiub" or dataset.dtype.names or text):
            return None
        if dataset.external or dataset.is_virtual:
            self.left_out.append(f"{dataset.name} (kept in another file)")
            return None
        self._bytes += dataset.size * dataset.dtype.itemsize
        if self._bytes > self._room:
            raise InputError(
                f"{self.path}: its data sets unpack to over {self._bytes / 1e9:.3g} GB, more than {_MOST_TIMES} times "
                f"the file; is it all one value?"
            )
        if text:
            return np.array(dataset.asstr(errors="replace")[()], dtype=str)
        value = dataset[()]
        return value.astype(float) if value.dtype.kind == "f" and value.dtype.itemsize not in (4, 8) else value

    def matlab(self, group: Any, above: tuple[Any, ...] = ()) -> dict[str, Any]:
        """Return MATLAB's variables of a group: structures as mappings, arrays with their axes as in MATLAB."""
        import h5py

        found: dict[str, Any] = {}
        for name in group:
            self._count()
            if name.startswith("#") or not isinstance(group.get(name, getlink=True), h5py.HardLink):
                continue
            item = group[name]
            if isinstance(item, h5py.Group):
                if item not in above and len(above) < _DEEPEST:
                    found[name] = self.matlab(item, (*above, item))
                continue
            value = self._matlab_value(item)
            if value is None:
                self.left_out.append(f"{name} ({_what(item)})")
            else:
                found[name] = value
        return found

    def _matlab_value(self, dataset: Any) -> Any:
        if "MATLAB_empty" in dataset.attrs or dataset.ndim not in (1, 2) or dataset.size < 2:
            return None
        kind = _matlab_class(dataset)
        if kind == "cell":
            return self._words(dataset)
        if kind in ("char", "function_handle") or dataset.dtype.kind not in "fiub":
            return None
        value = self._read(dataset)
        return None if value is None else value.T.ravel() if 1 in value.shape else value.T

    def _words(self, cells: Any) -> Any:
        """Return a cell array of texts, as of dates, as an array of texts; ``None`` where it holds anything else."""
        import h5py

        if h5py.check_ref_dtype(cells.dtype) is None or 1 not in (*cells.shape, 1)[: cells.ndim]:
            return None
        words = []
        for reference in cells[()].ravel():
            cell = self.file[reference] if reference else None
            if not isinstance(cell, h5py.Dataset) or _matlab_class(cell) != "char" or cell.dtype.kind != "u":
                return None
            letters = self._read(cell)
            words.append("".join(map(chr, letters.ravel().tolist())) if letters is not None else "")
        return np.array(words, dtype=object)


def _stacked(path: Path, columns: dict[str, Any]) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the groups that have the same columns, one below the other, with a column that names the group."""
    import pandas as pd

    groups: dict[str, dict[str, Any]] = {}
    for name, values in columns.items():
        group, _, own = name.rpartition("/")
        groups.setdefault(group, {})[own] = values
    tables = {group: table for group, held in groups.items() if (table := of_one_length(held)) is not None}
    if not tables:
        raise InputError(f"{path}: holds no group with numeric vectors")
    most = max(tables.values(), key=lambda table: (len(table.columns), len(table)))
    alike = {group: table for group, table in tables.items() if set(table.columns) == set(most.columns)}
    parts = [table[[*most.columns]].assign(**{GROUP: group.lstrip("/") or "/"}) for group, table in alike.items()]
    first = next(iter(alike))
    return pd.concat(parts, ignore_index=True), {name: f"{first}/{name}".lstrip() for name in most.columns}


def _matlab_class(dataset: Any) -> str:
    stated = dataset.attrs.get("MATLAB_class", b"")
    return stated.decode(errors="replace") if isinstance(stated, bytes) else str(stated)


def _unit(dataset: Any) -> str:
    for attribute in _UNITS:
        stated = dataset.attrs.get(attribute)
        if isinstance(stated, bytes):
            stated = stated.decode(errors="replace")
        if isinstance(stated, str) and 0 < len(stated) <= 40:
            return stated
    return ""


def _what(dataset: Any) -> str:
    kind = _matlab_class(dataset) or str(dataset.dtype)
    return f"{kind} {'×'.join(map(str, dataset.shape)) or 'scalar'}"
