"""From what a caller gives (numbers, arrays, a table, a recording) to the signals of a model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array, Index
from fricmodels.errors import InputError, suggestion
from fricmodels.model import Model
from fricmodels.recording import RATE, SIGNAL_CHANNEL, Recording
from fricmodels.signals.integrated import with_integrated_position

if TYPE_CHECKING:
    import pandas as pd

_COLUMNS = {
    "time": ("time_s",),
    "velocity": ("velocity_rad_s", "velocity_m_s"),
    "position": ("position_rad", "position_m"),
    "acceleration": ("acceleration_rad_s2", "acceleration_m_s2"),
    "motor_torque": ("torque", "torque_Nm", "force", "force_N"),
    "load_torque": ("load_torque_Nm", "load_force", "load_force_N"),
    "temperature": ("temperature_degC",),
}
"""Signal → further names that a table may have for it: the channel, and the column that this package writes."""


@dataclass(frozen=True)
class Given:
    """Signals of one call.

    Attributes:
        values: by signal, each a number or a flat array of length N.
        shape: of the answer; ``()`` for a number.
        index: of the table, where one was given.
        time: sample times [s], shape (N,), where they are known.
        run: number of the run of each sample, where one is known.
    """

    values: Mapping[str, Array]
    shape: tuple[int, ...]
    index: Any = None
    time: Array | None = None
    run: Index | None = None

    def answer(self, torque: Array) -> Any:
        """Return a torque, shape (N,) or (1,), as it was asked for: a number, an array, or a series."""
        if self.shape == ():
            return float(torque[0])
        shaped = np.broadcast_to(torque, (int(np.prod(self.shape)),)).reshape(self.shape).copy()
        if self.index is None:
            return shaped
        import pandas as pd

        return pd.Series(shaped, index=self.index, name="torque")


def given(model: Model, data: object, named: Mapping[str, ArrayLike | None]) -> Given:
    """Return the signals of a call.

    Args:
        model: says which signals it needs.
        data: a table with a column for each signal, a recording, or ``None``.
        named: signals by name; they go before those of the table.

    Raises:
        InputError: where a signal is missing, unknown, or of another shape.
    """
    known = {*model.signals, "time", "run"}
    for name, value in named.items():
        if name not in known and value is not None:
            raise InputError(f"'{model.name}' knows no signal '{name}'{suggestion(name, known)}")
    values = {name: _numbers(name, value) for name, value in named.items() if value is not None}
    index, run = None, None
    if isinstance(data, Recording):
        values = {**_of_recording(model, data), **values}
        run = np.asarray(data.run)
    elif data is not None:
        table = _table(data)
        index = table.index
        values = {**_of_table(table, known - set(values)), **values}
    _check(model, values)
    try:
        shape = np.broadcast_shapes(*(value.shape for value in values.values()))
    except ValueError:
        sizes = ", ".join(f"{name} {value.shape}" for name, value in values.items() if value.ndim)
        raise InputError(f"signals of one call have one shape, or are numbers; these differ: {sizes}") from None
    flat = {name: np.broadcast_to(v, shape).ravel() if v.ndim else v for name, v in values.items()}
    time = flat.get("time")
    if run is None and "run" in flat:
        run = np.broadcast_to(flat["run"], shape).ravel().astype(np.int64)
    return Given(flat, shape, index, None if time is None or time.ndim == 0 else time, run)


def _numbers(name: str, value: ArrayLike) -> Array:
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"signal '{name}' must be numbers, got {type(value).__name__}") from None


def _table(data: object) -> pd.DataFrame:
    import pandas as pd

    if not isinstance(data, pd.DataFrame):
        kind = type(data).__name__
        raise InputError(f"a table or a recording is expected, got {kind}; give signals by name: velocity=…")
    return data


def _of_table(table: pd.DataFrame, wanted: set[str]) -> dict[str, Array]:
    found = {}
    for name in wanted:
        column = next((c for c in (name, *_COLUMNS.get(name, ())) if c in table.columns), None)
        if column is not None:
            found[name] = np.asarray(table[column], dtype=float)
    return found


def _of_recording(model: Model, recording: Recording) -> dict[str, Array]:
    recording = with_integrated_position(recording)
    recording.require(model.required, model.name)
    return {name: recording.signal(name) for name in {*model.needs, "time", "velocity"}}


def _check(model: Model, values: dict[str, Array]) -> None:
    """Fill in what may be left out, and refuse what may not."""
    for name in sorted(model.needs - set(values)):
        if name == "motor_torque_rate" or name not in model.required:
            values[name] = np.zeros(())  # a delay of a record is no friction; an optional load is none
            continue
        channel = SIGNAL_CHANNEL.get(name, name)
        wanted = f"{name}=…" if name.isidentifier() else f"channels={{'{name}': …}}"
        of = "" if channel == name else f" (channel '{channel}')"
        raise InputError(f"'{model.name}' needs the signal '{name.removeprefix(RATE)}'{of}; give it as {wanted}")
