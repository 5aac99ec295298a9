"""A fitted model driven by a recorded torque, and how far its motion goes from the recorded one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels.arrays import rms
from fricmodels.files import check_table_name, replaced
from fricmodels.readers.standard_names import STANDARD
from fricmodels.recording import OTHER, Recording
from fricmodels.saved.fitted import FittedModel
from fricmodels.simulation import Between


def driven(
    model: FittedModel, recording: Recording, between_samples: Between | None = None
) -> tuple[Recording, Between]:
    """Return the motion of a model under a recorded torque, each run open loop from its own first sample.

    Args:
        model: the fitted model. recording: as read.
        between_samples: whether the torque is ``held`` or goes straight; if not given what moves the model clearly
            nearer to the recorded motion, see :func:`fricmodels.motion.torque_between_samples`.

    Returns:
        The motion, and what was taken of the torque between samples.

    Raises:
        InputError: where the recording has no velocity, nor a position to derive it from.
    """
    from fricmodels.motion import torque_between_samples
    from fricmodels.weakform.prepared import ready

    whole = ready(recording)
    between = between_samples or torque_between_samples(model.drive, model.parameters, whole)
    channels: dict[str, list[Any]] = {}
    for run in whole.runs():
        first = {
            "velocity": float(run.velocity[0]),
            "position": float(run["position"][0]) if "position" in run else 0.0,
        }
        given: dict[str, Any] = {name: run[name] for name in ("load_torque", "temperature") if name in run}
        further: Mapping[str, Any] = {name: run[name] for name in run.channels if name.startswith(OTHER)}
        own = model.simulate(
            run.torque, first, time=run.time, further=further, units=dict(whole.units),
            between_samples=between, **given,
        )  # fmt: skip
        for name, values in own.channels.items():
            channels.setdefault(name, []).append(values)
    joined = {name: np.concatenate(parts) for name, parts in channels.items()}
    moved = Recording("simulated", whole.motion, joined, np.sort(whole.run, kind="stable"), units=whole.units)
    return moved, between


def errors_in_words(simulated: Recording, recording: Recording, how: str) -> list[str]:
    """Return in sentences how far the simulated motion is from the recorded one; open loop, every error adds up."""
    from fricmodels.weakform.prepared import ready

    whole = ready(recording)
    order = np.argsort(whole.run, kind="stable")
    lines = []
    for name, unit in (("velocity", "rad/s"), ("position", "rad")):
        if name in whole:
            error = simulated[name] - whole[name][order]
            if not np.all(np.isfinite(error)):
                lines.append(f"{name}: the simulation ended before the recording did")
                continue
            size = unit if whole.motion.value == "rotary" else unit.replace("rad", "m")
            of = ", against the one that the positions give" if name == "velocity" and name in whole.derived else ""
            lines.append(f"{name}: RMS error {rms(error):.4g} {size}{of}, {how}")
    return lines


def write_recording(recording: Recording, out: Path) -> Path:
    """Write a recording as CSV or Parquet, whole or not at all.

    Raises:
        InputError: for another suffix, or a folder that cannot be written.
    """
    import pandas as pd

    check_table_name(out)
    names = STANDARD[recording.motion]
    table = pd.DataFrame({names.get(name, name): values for name, values in recording.channels.items()})
    if len(recording.run_numbers) > 1:
        table["run"] = recording.run
    with replaced(out) as beside:
        save = table.to_csv if out.suffix == ".csv" else table.to_parquet
        save(beside, index=False)
    return out
