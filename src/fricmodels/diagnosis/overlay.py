"""The overlay of model and measurement, sample by sample, for plotting."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.files import replaced
from fricmodels.score import headline_window, torque_error_over


def write_overlay(comparison: Comparison, directory: Path) -> Path:
    """Write ``overlay.csv``: time, torque as measured and as modelled, error, and which samples were kept back.

    The error is that of the headline, over its window about each sample.
    """
    import pandas as pd

    parts = []
    unit = "Nm" if comparison.drive.motion == "rotary" else "N"
    window = headline_window(comparison.train, comparison.drive.inertia)
    for part, kept in ((comparison.train, False), (comparison.test, True)):
        error = torque_error_over(comparison.drive, comparison.estimate.parameters, part, window)
        columns = {
            "time_s": part.time,
            f"measured_{unit}": part.torque,
            f"modelled_{unit}": part.torque - error,
            f"error_{unit}": error,
            "kept_back": np.full(len(part), kept),
        }
        parts.append(pd.DataFrame(columns))
    path = directory / "overlay.csv"
    with replaced(path) as beside:
        pd.concat(parts).sort_values("time_s", kind="stable").to_csv(beside, index=False)
    return path
