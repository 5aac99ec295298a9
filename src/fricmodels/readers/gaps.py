"""What to do with rows that cannot be used: samples without numbers, repeated stamps, a clock that starts anew."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.gaps import Gaps as Gaps


@dataclass(frozen=True)
class Kept:
    """The rows that are kept.

    Attributes:
        rows: their numbers, in order.
        run: the run of each.
        dropped: how many were left out for what stands in them. alone: how many since nothing is left beside them.
        added: how many runs there are more than before.
    """

    rows: Index
    run: Index
    dropped: int
    alone: int
    added: int

    def __str__(self) -> str:
        words = []
        if self.dropped or not self.alone:
            words.append(f"{_rows(self.dropped)} without a number or with a repeated stamp left out")
        if self.alone:
            words.append(f"{_rows(self.alone)} that stood alone left out")
        if self.added:
            words.append(f"{self.added} run{'s' * (self.added != 1)} added")
        return ", ".join(words)


def _rows(count: int) -> str:
    return f"{count} row{'s' * (count != 1)}"


def kept(channels: Mapping[str, Array], run: Index, how: Gaps) -> Kept:
    """Leave out rows with a value that is no number, and those with the stamp of the row before.

    Args:
        channels: value or array of shape (N,) of each channel, samples of each run together.
        run: run number of each row, shape (N,).
        how: with ``split`` a new run begins after every row that is left out, and where the clock starts anew; a run of
            one row is left out too.
    """
    time = channels["time"]
    usable = np.logical_and.reduce([np.isfinite(values) for values in channels.values()])
    rows = np.flatnonzero(usable)
    repeated = (np.diff(time[rows]) == 0) & (np.diff(run[rows]) == 0)
    rows = rows[np.concatenate([[True], ~repeated])] if len(rows) else rows
    own = run[rows]
    if how is not Gaps.SPLIT or not len(rows):
        return Kept(rows, own, len(run) - len(rows), 0, 0)
    hole = np.diff(np.cumsum(~usable)[rows]) > 0
    begins = hole | (np.diff(own) != 0) | (np.diff(time[rows]) < 0)
    number = np.concatenate([[0], np.cumsum(begins)])
    long = np.bincount(number)[number] > 1
    dropped, alone = len(run) - len(rows), int(np.sum(~long))
    rows, before = rows[long], len(np.unique(run))
    final = np.unique(number[long], return_inverse=True)[1].astype(np.int64)
    unchanged = not begins[np.diff(own) == 0].any() and long.all()
    return Kept(
        rows,
        own if unchanged else final,
        dropped,
        alone,
        0 if unchanged else max(int(final.max(initial=-1)) + 1 - before, 0),
    )
