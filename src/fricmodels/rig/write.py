"""A recording and its truth, written side by side."""

from __future__ import annotations

import json
from pathlib import Path

from fricmodels.files import check_table_name, replaced, write_bytes, write_text
from fricmodels.readers.standard_names import STANDARD
from fricmodels.recording import Recording


def write(recording: Recording, out: str | Path) -> tuple[Path, Path]:
    """Write the samples to ``out`` (``.csv`` or ``.parquet``) and the truth to ``out`` with ``.truth.json`` instead.

    Both appear whole or not at all. The column ``run`` is there when there are several runs.

    Raises:
        InputError: for another suffix, or a folder that cannot be written.
    """
    import pandas as pd

    path = Path(out)
    check_table_name(path)
    truth = path.with_suffix(".truth.json")
    table = pd.DataFrame({STANDARD[recording.motion][name]: values for name, values in recording.channels.items()})
    if recording.run[-1] > 0:
        table["run"] = recording.run
    text = json.dumps(dict(recording.provenance), indent=2) + "\n"
    known = truth.read_bytes() if truth.is_file() else None
    try:
        with replaced(path) as beside:
            save = table.to_csv if path.suffix == ".csv" else table.to_parquet
            save(beside, index=False)
            write_text(truth, text)
    except BaseException:
        if known is None:
            truth.unlink(missing_ok=True)
        else:
            write_bytes(truth, known)
        raise
    return path, truth
