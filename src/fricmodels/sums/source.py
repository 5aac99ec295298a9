"""From a file to its sums: read once, block by block, and held never as a whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.errors import InputError
from fricmodels.gaps import Gaps
from fricmodels.progress import steps
from fricmodels.readers import check
from fricmodels.readers.blocks import Block, Blocks, blocks, check_values
from fricmodels.readers.gaps import kept
from fricmodels.recording import Recording
from fricmodels.signals.counted import sum_of_counts
from fricmodels.signals.jumps import mend_jumps
from fricmodels.signals.segments import BRIDGED
from fricmodels.signals.wrapping import unwrap
from fricmodels.sums.plan import Plan
from fricmodels.sums.rows import Rows, Stretch
from fricmodels.sums.summed import PARTS, Sums
from fricmodels.weakform.smoothed import blocks_of

_RATE = 0.1
"""Share by which the sampling interval of a file may differ from the plan's."""


def of_file(path: str | Path, plan: Plan, *, gaps: Gaps | str | None = None, **how: Any) -> Sums:
    """Return the sums of one file; each run and each stretch without a gap has rows of its own.

    Args:
        path: the file. Of Parquet a block at a time is in memory; other formats are read as a whole.
        plan: what the rows are.
        gaps: what is done with rows without a number and where the clock starts anew; refused if not given.
        how: columns, motion, reader and torque constant; see :func:`fricmodels.readers.read`.

    Raises:
        InputError: for a file that cannot be used, or that is not of the plan's kind.
    """
    opened = blocks(path, **({"motion": plan.motion} | how))
    names = _names(opened, plan)
    if gaps is not None and Gaps(gaps) is Gaps.JOIN:
        raise InputError(f"{opened.source}: sums are made block by block, which joins no channels; write them joined")
    cut = _Cut(opened.source, plan, None if gaps is None else Gaps(gaps))
    columns = len(plan.drive.model.parameters) + 4
    products = np.zeros((PARTS, columns, columns))
    total = 0
    for rows, begins in cut.rows(counted(opened, names)):
        edges = np.searchsorted(begins * PARTS // opened.rows, np.arange(PARTS + 1))
        for number in np.flatnonzero(np.diff(edges)):
            some = rows[:, edges[number] : edges[number + 1]]
            products[number] += some @ some.T
        total += rows.shape[1]
    return Sums.of(plan, opened.source.name, products, total, cut.samples, cut.seen)


def counted(opened: Blocks, names: Sequence[str]) -> Iterator[Block]:
    """Yield the blocks of a file, and tell how many of its rows are done."""
    with steps(f"summing the samples of {opened.source.name}", opened.rows) as done:
        for block in opened.of(names):
            yield block
            done(len(block.run))


def pilot(path: str | Path, *, gaps: Gaps | str | None = None, **how: Any) -> Recording:
    """Return what a plan is made from: a file as a recording, of a long one blocks spread evenly over it.

    Args:
        path: the file.
        gaps: see :func:`of_file`.
        how: columns, motion, reader and torque constant.

    Raises:
        InputError: for a file that cannot be used.
    """
    opened = blocks(path, **how)
    wanted = blocks_of(opened.rows)
    known = ("time", "torque", "velocity", "position", "load_torque", "temperature")
    names = [name for name in known if name in opened.channels]
    parts: list[Mapping[str, Array]] = []
    runs = []
    for block in opened.of(names):
        for number, (start, stop) in enumerate(wanted):
            inside = slice(max(start - block.first, 0), max(stop - block.first, 0))
            if len(block.run[inside]):
                parts.append({name: values[inside] for name, values in block.channels.items()})
                runs.append(np.stack([np.full(len(block.run[inside]), number), block.run[inside]]))
    channels = {name: np.concatenate([part[name] for part in parts]) for name in names}
    _, run = np.unique(np.concatenate(runs, axis=1), axis=1, return_inverse=True)
    run = run.astype(np.int64).ravel()
    order = np.argsort(run, kind="stable")
    channels, run = {name: values[order] for name, values in channels.items()}, run[order]
    if gaps is not None:
        left = kept(channels, run, Gaps(gaps))
        channels, run = {name: values[left.rows] for name, values in channels.items()}, left.run
    provenance = {"source": str(opened.source)}
    recording = Recording(opened.source.stem, opened.motion, channels, run, provenance=provenance)
    check(recording)
    return mend_jumps(unwrap(recording))


def _names(opened: Blocks, plan: Plan) -> list[str]:
    missing = [name for name in plan.channels if name not in opened.channels]
    if missing:
        raise InputError(
            f"{opened.source}: has no {missing[0].replace('_', ' ')}, of which the rows of '{plan.model}' are made; "
            f"map a column with --column {missing[0]}=COLUMN[:UNIT]"
        )
    if opened.motion is not plan.motion:
        raise InputError(f"{opened.source}: is of a {opened.motion} drive, the plan of a {plan.motion} one")
    return [*plan.channels, *(["load_torque"] if "load_torque" in {*opened.channels} - {*plan.channels} else [])]


@dataclass
class _Cut:
    """Cuts the blocks of a file into stretches without a gap."""

    source: Path
    plan: Plan
    gaps: Gaps | None
    samples: int = 0
    seen: dict[str, Array] = field(default_factory=dict)
    _stretch: Stretch | None = None
    _last: tuple[float, int, float] | None = None
    """Time, run and position as recorded of the last sample."""
    _turned: float = 0.0
    _closed: set[int] = field(default_factory=set)

    def rows(self, given: Iterator[Block]) -> Iterator[Rows]:
        """Yield the rows of all stretches; see :meth:`.Stretch.take`."""
        for block in given:
            whole = block if self.gaps is None else self._usable(block)
            if not len(whole.run):
                continue
            check_values(self.source, whole)
            self._note(whole)
            if self._last is None:
                self._check_rate(whole)
            begins = self._begins(whole)
            edges = [0, *begins[begins > 0].tolist(), len(whole.run)]
            for start, stop in pairwise(edges):
                if start in begins or self._stretch is None:
                    if self._stretch is not None:
                        yield from self._stretch.rest()
                    self._stretch, self._turned, self._last = Stretch(self.plan, whole.first + start), 0.0, None
                piece = {name: values[start:stop] for name, values in whole.channels.items()}
                yield from self._stretch.take(self._summed(self._unwrapped(piece)))
                self._last = (float(piece["time"][-1]), int(whole.run[stop - 1]), self._position(whole, stop - 1))
        if self._stretch is not None:
            yield from self._stretch.rest()

    def _begins(self, block: Block) -> Any:
        """Return the samples of a block at which a stretch begins."""
        time, run = block.channels["time"], block.run
        before = (float(time[0]) - self.plan.interval, int(run[0])) if self._last is None else self._last[:2]
        step, other = np.diff(time, prepend=before[0]), np.diff(run, prepend=before[1]) != 0
        back = (step <= 0.0) & ~other
        if back.any() and self.gaps is not Gaps.SPLIT:
            row = int(np.argmax(back))
            what = "is repeated" if step[row] == 0.0 else "goes back"
            raise InputError(
                f"{self.source}: row {block.first + row + 1}: the time {time[row]:.9g} s {what}; begin a run there "
                f"with --gaps split, or name its column with --column run=COLUMN, or put the rows in order"
            )
        self._check_runs([before[1], *run[other].tolist()])
        return np.flatnonzero(other | back | (step >= BRIDGED * self.plan.interval))

    def _check_runs(self, numbers: list[int]) -> None:
        """Make sure that no run begins again after another one."""
        for ended, begun in pairwise(numbers):
            self._closed.add(ended)
            if begun in self._closed:
                raise InputError(
                    f"{self.source}: the samples of run {begun} do not stand together; sort the file by its runs"
                )

    def _check_rate(self, block: Block) -> None:
        step = np.diff(block.channels["time"])
        usual = float(np.median(step)) if len(step) else self.plan.interval
        if abs(usual - self.plan.interval) > _RATE * self.plan.interval and usual > 0.0:
            raise InputError(
                f"{self.source}: is sampled every {usual:.4g} s, what the plan was made from every "
                f"{self.plan.interval:.4g} s; give it sums of its own"
            )

    def _usable(self, block: Block) -> Block:
        """Return a block without rows that have no number or repeat the stamp of the one before."""
        finite = np.logical_and.reduce([np.isfinite(values) for values in block.channels.values()])
        rows = np.flatnonzero(finite)
        time = block.channels["time"][rows]
        before = np.nan if self._last is None else self._last[0]
        rows = rows[np.diff(time, prepend=before) != 0.0]
        if len(rows) == len(block.run):
            return block
        return Block({name: values[rows] for name, values in block.channels.items()}, block.run[rows], block.first)

    def _note(self, block: Block) -> None:
        self.samples += len(block.run)
        for name, values in block.channels.items():
            limits = np.array([values.min(), values.max()])
            old = self.seen.get(name, limits)
            self.seen[name] = np.array([min(old[0], limits[0]), max(old[1], limits[1])])

    def _summed(self, piece: dict[str, Array]) -> dict[str, Array]:
        """Return samples with the sum of counts as position, where only their differences were recorded."""
        if not self.plan.counts:
            return piece
        position = self._turned + sum_of_counts(piece["velocity"], self.plan.counts, self.plan.interval)
        self._turned = float(position[-1])
        return {**piece, "position": position}

    def _position(self, block: Block, row: int) -> float:
        return float(block.channels["position"][row]) if "position" in block.channels else 0.0

    def _unwrapped(self, piece: dict[str, Array]) -> dict[str, Array]:
        """Return samples with the position as it goes on from the last one, where it is wrapped."""
        period = self.plan.wrap
        if not period or "position" not in piece:
            return piece
        position = piece["position"]
        before = position[0] if self._last is None else self._last[2]
        turns = self._turned + np.cumsum(np.round(np.diff(position, prepend=before) / period))
        self._turned = float(turns[-1])
        return {**piece, "position": position - period * turns}
