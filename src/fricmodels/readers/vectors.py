"""Columns out of whatever vectors and matrices a file holds: those of one length, by name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas as pd


def vectors(variables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each vector with its name: fields as ``structure.field``, columns of a matrix as ``name(1)``, …."""
    for name, value in variables.items():
        label = f"{prefix}{name}"
        if isinstance(value, Mapping):
            yield from vectors(value, f"{label}.")
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiubU" and value.size > 1:
            yield from columns_of(label, value)
        elif _is_text(value):
            yield label, value


def columns_of(label: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield a vector, or each column of a matrix; its rows are samples where there are more of them."""
    if value.ndim == 1:
        yield label, value
    elif value.ndim == 2 and 1 in value.shape:
        yield label, value.ravel()
    elif value.ndim == 2:
        rows = value if value.shape[0] >= value.shape[1] else value.T
        yield from ((f"{label}({i + 1})", rows[:, i]) for i in range(rows.shape[1]))


def of_one_length(columns: Mapping[str, Any], asked: Collection[str] = ()) -> pd.DataFrame | None:
    """Return the columns as long as the first that is asked for, or else as most of them are; ``None`` without any.

    What is left out is in ``attrs["other_lengths"]``: length by name.
    """
    import pandas as pd

    if not columns:
        return None
    length = next((len(columns[name]) for name in asked if name in columns), None)
    if length is None:
        counts = Counter(len(values) for values in columns.values())
        length = max(counts, key=lambda n: (counts[n], n))
    table = pd.DataFrame({name: values for name, values in columns.items() if len(values) == length})
    table.attrs["other_lengths"] = {name: len(values) for name, values in columns.items() if len(values) != length}
    return table


_NEARLY = 0.01
"""Share of the samples by which a list that should have been as long as the others differs from them at most."""


def unequal_lengths(lengths: Mapping[str, int], samples: int, wanted: Collection[str]) -> dict[str, int]:
    """Return, of the columns of other lengths, those that should have been of this one: wanted, or nearly as long."""
    return {
        name: length
        for name, length in lengths.items()
        if name in wanted or 0 < abs(length - samples) <= _NEARLY * samples
    }


def kind(value: Any) -> str:
    """Say what a value is that is no vector."""
    if isinstance(value, np.ndarray):
        return "complex" if value.dtype.kind == "c" else f"array of {value.dtype}"
    return type(value).__name__


def _is_text(value: Any) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.dtype.kind == "O"
        and value.ndim == 1
        and value.size > 1
        and all(isinstance(item, str) for item in value)
    )
