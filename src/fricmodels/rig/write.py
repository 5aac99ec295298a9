"""A recording and its truth, written side by side."""

from __future__ import annotations

import json
from pathlib import Path

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.files import replaced, write_text
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
    write_text(truth, text)
    with replaced(path) as beside:
        save = table.to_csv if path.suffix == ".csv" else table.to_parquet
        save(beside, index=False)
    return path, truth
