"""Reads a file in a process of its own: a spoilt one may kill its parser, or unpack to more than there is memory for.

The child gives the table back as an Arrow file, which is copied nowhere else; it has a limit of time and of memory.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmodels.errors import InputError
from fricmodels.processes import end_with_parent, time_limit

if TYPE_CHECKING:
    import pandas as pd

    from fricmodels.readers.base import Reader

LIMIT = "FRICMODELS_READ_TIMEOUT"
"""Environment variable: seconds that reading one file may take."""
_DEFAULT_LIMIT = 120.0
_LEAST_MEMORY = 1 << 30
_MEMORY_FOR_A_BYTE = 40
_CHILD = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from fricmodels.readers.apart import child; child()"


def table_apart(reader: Reader, path: Path, asked: Collection[str] = ()) -> pd.DataFrame:
    """Return a reader's table of a file, read by a child process; see :meth:`Reader.table_for`.

    Raises:
        InputError: what the reader says of the file, or that it ended the child, took too long or too much memory.
    """
    limit = time_limit(LIMIT, _DEFAULT_LIMIT, "reading a file may take")
    with tempfile.TemporaryDirectory(prefix="fricmodels-") as folder:
        out = Path(folder) / "table"
        order: dict[str, Any] = {
            "module": type(reader).__module__,
            "name": type(reader).__qualname__,
            "path": str(path),
            "asked": list(asked),
        }
        memory = _LEAST_MEMORY + _MEMORY_FOR_A_BYTE * path.stat().st_size
        order |= {"out": str(out), "memory": memory, "seconds": limit, "parent": os.getpid()}
        code = [sys.executable, "-c", _CHILD, json.dumps(sys.path), json.dumps(order)]
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        try:
            ended = subprocess.run(code, **quiet, timeout=limit, check=False).returncode  # type: ignore[call-overload]
        except subprocess.TimeoutExpired:
            raise InputError(f"{path}: reading it takes longer than {limit:g} s ({LIMIT} sets the limit)") from None
        return _taken(path, out, ended)


def _taken(path: Path, out: Path, ended: int) -> pd.DataFrame:
    said = out.with_suffix(".json")
    if said.exists():
        raise InputError(json.loads(said.read_text(encoding="utf-8"))["error"])
    if ended != 0 or not out.exists():
        how = signal.Signals(-ended).name if -ended in {*signal.Signals} else f"exit code {ended}"
        raise InputError(f"{path}: the file is damaged: reading it kills its reader ({how}); save it anew")
    import pyarrow.feather

    table = pyarrow.feather.read_table(out, memory_map=False)
    frame: pd.DataFrame = table.to_pandas(ignore_metadata=True)
    metadata = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
    frame.columns = json.loads(metadata["columns"])  # Arrow keeps the same name twice, pandas does not write it
    frame.attrs.update(json.loads(metadata["attrs"]))
    return frame


def child() -> None:
    """Read the file that the command line asks for, and write its table, or what the reader says against it."""
    order: dict[str, Any] = json.loads(sys.argv[2])
    end_with_parent(order["parent"])
    path, out = Path(order["path"]), Path(order["out"])
    try:
        _write(_read(order, path), out)
    except InputError as error:
        _refuse(out, str(error))
    except MemoryError:
        _refuse(out, f"{path}: it unpacks to more memory than a recording of its size needs; save fewer samples a file")
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        _refuse(out, f"{path}: cannot be read: {reason}")


def _read(order: dict[str, Any], path: Path) -> pd.DataFrame:
    import importlib

    reader = getattr(importlib.import_module(order["module"]), order["name"])()
    _limit(order["memory"], order["seconds"])
    table: pd.DataFrame = reader.table_for(path, order["asked"])
    return table


def _limit(memory: int, limit: float) -> None:
    """Bound what this process may take beyond what it has; where the system has no limits, time alone is bounded."""
    if sys.platform != "linux":
        return
    import resource

    with Path("/proc/self/statm").open() as stream:
        now = int(stream.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + memory, now + memory))
    resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 1))


def _write(frame: pd.DataFrame, out: Path) -> None:
    import pyarrow
    import pyarrow.feather

    columns = [str(name) for name in frame.columns]
    plain = frame.set_axis([str(number) for number in range(len(columns))], axis=1)
    for name, kind in plain.dtypes.items():
        if getattr(kind, "byteorder", "=") == ">":  # Arrow knows the order of this machine alone
            plain[name] = plain[name].astype(kind.newbyteorder("="))
    table = pyarrow.Table.from_pandas(plain, preserve_index=False)
    attrs = {name: dict(frame.attrs.get(name, {})) for name in ("units", "other_lengths")}
    kept = {"columns": json.dumps(columns), "attrs": json.dumps(attrs)}
    pyarrow.feather.write_feather(table.replace_schema_metadata(kept), out, compression="uncompressed")


def _refuse(out: Path, message: str) -> None:
    out.unlink(missing_ok=True)
    out.with_suffix(".json").write_text(json.dumps({"error": message}), encoding="utf-8")
