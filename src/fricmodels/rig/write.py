"""A recording and its truth, written side by side."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.recording import Recording

COLUMNS = {
    Motion.ROTARY: {
        "time": "time_s",
        "torque": "torque_Nm",
        "velocity": "velocity_rad_s",
        "position": "position_rad",
        "acceleration": "acceleration_rad_s2",
        "load_torque": "load_torque_Nm",
        "temperature": "temperature_degC",
    },
    Motion.LINEAR: {
        "time": "time_s",
        "torque": "force_N",
        "velocity": "velocity_m_s",
        "position": "position_m",
        "acceleration": "acceleration_m_s2",
        "load_torque": "load_force_N",
        "temperature": "temperature_degC",
    },
}
"""Standard columns of recordings on disk."""


def write(recording: Recording, out: str | Path) -> tuple[Path, Path]:
    """Write the samples to ``out`` (``.csv`` or ``.parquet``) and the truth to ``out`` with ``.truth.json`` instead.

    Both appear whole or not at all. The column ``run`` is there when there are several runs.

    Raises:
        InputError: for another suffix, or a folder that cannot be written.
    """
    import pandas as pd

    path = Path(out)
    if path.suffix not in (".csv", ".parquet"):
        raise InputError(f"cannot write '{path}': the name must end in .csv or .parquet")
    truth = path.with_suffix(".truth.json")
    table = pd.DataFrame({COLUMNS[recording.motion][name]: values for name, values in recording.channels.items()})
    if recording.run[-1] > 0:
        table["run"] = recording.run
    text = json.dumps(dict(recording.provenance), indent=2) + "\n"
    _atomically(truth, lambda beside: beside.write_text(text, encoding="utf-8"))
    if path.suffix == ".csv":
        _atomically(path, lambda beside: table.to_csv(beside, index=False))
    else:
        _atomically(path, lambda beside: table.to_parquet(beside, index=False))
    return path, truth


def _atomically(path: Path, save: Callable[[Path], object]) -> None:
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        save(beside)
        os.replace(beside, path)
    except OSError as error:
        raise InputError(f"cannot write '{path}': {error.strerror or error}") from None
    finally:
        beside.unlink(missing_ok=True)
