"""Coverage of the 95 % intervals of every estimator, and of ``compare``, on drives whose truth is known.

A cell is one kind of recording: who simulates it (the rig, or ``fricmodels.simulation``), how its torque runs between
samples, its sensor noise, rate, motion, whether the inertia is given, and which effect the drive and the model have.
Every replication of a cell draws its motion and its noise from the cell's name and its number alone.

    python benchmarks/coverage_matrix.py                   all cells, 100 replications; --keep FILE resumes
    python benchmarks/coverage_matrix.py --quick           six cells, 20 replications
    python benchmarks/coverage_matrix.py --cells trapezoid --estimators ekf,batch --replications 30 --processes 2

An interval is good if it covers the truth in 90 to 98 % of the replications, up to the binomial error of the count, or
if the parameter carries no interval and the fit says why.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels import plugins
from fricmodels.diagnosis import compare
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording
from fricmodels.signals import prepare
from known_drives import MOTIONS, TRUTH, Cell

ROOT = Path(__file__).parent.parent
COMPARE = "compare"
SLOW = {"ukf": 20}
"""Estimators with Python in every sample have at most so many replications."""
LEAST, MOST = 0.90, 0.98
SIDE = 1.959963984540054


def cells() -> list[Cell]:
    """Return the matrix: every motion with every noise, then what is left, one change at a time."""
    found = [
        Cell(motion=motion, noise=noise)
        for motion in MOTIONS
        for noise in ("white", "coloured", "rounded", "encoder-65536", "encoder-4096")
    ]
    for base in (Cell(), Cell(motion="point-to-point")):
        found += [replace(base, rate=100, noise=noise) for noise in ("white", "coloured", "encoder-4096")]
        found += [replace(base, inertia="estimated", noise=noise) for noise in ("white", "coloured", "encoder-65536")]
        found += [replace(base, source="simulate", torque=torque) for torque in ("held", "linear")]
        found += [replace(base, effect=effect) for effect in TRUTH]
    found += [Cell(torque="linear"), Cell(torque="linear", rate=100)]
    found += [Cell(source="simulate", torque="linear", motion=motion) for motion in ("sine", "trapezoid")]
    found += [Cell(source="simulate", torque="linear", effect=effect) for effect in TRUTH]
    return list(dict.fromkeys(found))


def quick_cells() -> list[Cell]:
    """Return the few cells of ``--quick``."""
    return [
        Cell(),
        Cell(noise="coloured"),
        Cell(noise="encoder-4096", motion="point-to-point"),
        Cell(rate=100, inertia="estimated"),
        Cell(source="simulate", torque="linear", motion="sine"),
        Cell(effect="gravity"),
    ]


def fitted(name: str, cell: Cell, recording: Recording) -> dict[str, Any]:
    """Fit with an estimator by name, or with ``compare``; return values, standard errors and reasons by key."""
    drive = cell.drive
    try:
        if name == COMPARE:
            found = compare(recording, drive.model, drive.inertia).estimate
            return {"values": dict(found.parameters), "errors": dict(found.standard_errors), "reasons": {}}
        fit = plugins.load().estimators[name]().fit(drive, prepare_velocity(recording))
    except FricmodelsError as error:
        return {"values": {}, "errors": {}, "reasons": dict.fromkeys(drive.keys, str(error))}
    if not fit.converged:
        return {"values": {}, "errors": {}, "reasons": dict.fromkeys(drive.keys, f"{fit.status}: {fit.message}")}
    reasons = {**fit.no_interval, **fit.not_identified}
    reasons |= {key: "not estimated" for key in drive.keys if key not in fit.standard_errors and key not in reasons}
    return {"values": dict(fit.parameters), "errors": dict(fit.standard_errors), "reasons": reasons}


def prepare_velocity(recording: Recording) -> Recording:
    """Return the recording with a velocity, as a tournament gives it to an estimator."""
    return recording if "velocity" in recording else prepare(recording)


def replication(task: tuple[Cell, int, tuple[str, ...]]) -> list[dict[str, Any]]:
    """Fit one recording with every estimator asked; return one row each."""
    cell, number, names = task
    recording = cell.recording(number)
    bound = cell.lower_bound(recording)
    rows = []
    for name in names:
        if number >= SLOW.get(name, number + 1):
            continue
        began = time.perf_counter()
        found = {**fitted(name, cell, recording), "bound": bound, "seconds": time.perf_counter() - began}
        rows.append({"cell": cell.name, "estimator": name, "number": number, **found})
    return rows


@dataclass(frozen=True)
class Figures:
    """What the replications of one cell show of one parameter; bias, error and SE in % of its true value."""

    fits: int
    intervals: int
    covered: int
    bias: float
    standard_error: float
    rms: float
    over_bound: float
    reasons: Mapping[str, int]

    @property
    def likely(self) -> tuple[float, float]:
        """95 % interval of the coverage (Clopper and Pearson)."""
        from scipy.stats import binomtest

        found = binomtest(self.covered, self.intervals).proportion_ci(0.95)
        return float(found.low), float(found.high)

    @property
    def good(self) -> bool:
        """Whether the coverage may lie in 90 to 98 %, and what has no interval has a reason."""
        if sum(self.reasons.values()) < self.fits - self.intervals:
            return False
        return self.intervals == 0 or (self.likely[0] <= MOST and self.likely[1] >= LEAST)


def figures(rows: Sequence[Mapping[str, Any]], key: str, true: float) -> Figures:
    """Return the figures of one parameter over the rows of one cell and estimator."""
    with_error = [row for row in rows if row["errors"].get(key) is not None]
    misses = [(row["values"][key] - true, row["errors"][key]) for row in with_error]
    all_misses = [row["values"][key] - true for row in rows if key in row["values"]]
    size = abs(true) or 1.0
    ratios = [
        (row["values"][key] - true) / row["bound"][key] for row in rows if key in row["values"] and key in row["bound"]
    ]
    reasons = Counter(_shortened(row["reasons"].get(key, "")) for row in rows if row["errors"].get(key) is None)
    reasons.pop("", None)
    return Figures(
        len(rows),
        len(misses),
        sum(abs(miss) <= SIDE * error for miss, error in misses),
        100 * float(np.median(all_misses)) / size if all_misses else math.nan,
        100 * float(np.mean([error for _, error in misses])) / size if misses else math.nan,
        100 * float(np.sqrt(np.mean(np.square(all_misses)))) / size if all_misses else math.nan,
        float(np.sqrt(np.mean(np.square(ratios)))) if ratios else math.nan,
        reasons,
    )


def _shortened(reason: str) -> str:
    return reason.split(":")[0].split(";")[0][:48]


def printed(rows: Sequence[Mapping[str, Any]], order: Sequence[Cell], names: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a Markdown table for every cell, and a summary by estimator."""
    counts: dict[str, Counter[str]] = {name: Counter() for name in names}
    for cell in order:
        mine = [row for row in rows if row["cell"] == cell.name]
        if not mine:
            continue
        yield f"\n### {cell.name}\n"
        yield "| estimator | parameter | covers | of | 95 % of it | bias % | SE % | RMS % | RMS/CRB | no interval |"
        yield "|---|---|---|---|---|---|---|---|---|---|"
        for name in names:
            own = [row for row in mine if row["estimator"] == name]
            for key in (p.key for p in cell.drive.parameters) if own else ():
                f = figures(own, key, cell.truth[key])
                counts[name]["good" if f.good else "bad"] += 1
                counts[name]["none"] += f.intervals == 0
                covers, likely = "–", "–"
                if f.intervals:
                    covers = f"{100 * f.covered / f.intervals:.0f} %" + ("" if f.good else " ✗")
                    likely = f"{100 * f.likely[0]:.0f}–{100 * f.likely[1]:.0f}"
                why = "; ".join(f"{count}× {reason}" for reason, count in sorted(f.reasons.items()))
                numbers = (f"{v:.3g}" if math.isfinite(v) else "–" for v in (f.bias, f.standard_error, f.rms))
                over = f"{f.over_bound:.2f}" if math.isfinite(f.over_bound) else "–"
                cells = [f"`{name}`", key, covers, str(f.intervals), likely, *numbers, over, why]
                yield "| " + " | ".join(cells) + " |"
    yield "\n## Summary\n"
    yield "| estimator | parameters of cells | as they should be | of these without an interval | outside 90–98 % |"
    yield "|---|---|---|---|---|"
    for name, count in counts.items():
        yield f"| `{name}` | {count['good'] + count['bad']} | {count['good']} | {count['none']} | {count['bad']} |"


def compact(rows: Sequence[Mapping[str, Any]], order: Sequence[Cell], names: Sequence[str]) -> Iterator[str]:
    """Yield one line a cell and estimator: how many intervals hold the truth, bias and SE over the scatter."""
    yield "| cell | estimator | fits | parameter: covered, bias over SD, SE over SD |"
    yield "|---|---|---|---|"
    for cell in order:
        for name in names:
            own = [row for row in rows if row["cell"] == cell.name and row["estimator"] == name]
            if own:
                parts = [_in_short(own, p.key, cell.truth[p.key]) for p in cell.drive.parameters]
                yield f"| `{cell.name}` | `{name}` | {len(own)} | {'; '.join(parts)} |"


def _in_short(rows: Sequence[Mapping[str, Any]], key: str, true: float) -> str:
    f = figures(rows, key, true)
    label = key.rpartition(".")[2]
    if not f.intervals:
        return f"{label} no interval"
    misses = np.array([row["values"][key] - true for row in rows if row["errors"].get(key) is not None])
    errors = np.array([row["errors"][key] for row in rows if row["errors"].get(key) is not None])
    scatter = float(np.std(misses, ddof=1)) if len(misses) > 1 else 0.0
    ratios = f" {np.mean(misses) / scatter:+.1f} {np.mean(errors) / scatter:.1f}" if scatter > 0.0 else ""
    return f"{label} {f.covered}/{f.intervals}{'' if f.good else ' ✗'}{ratios}"


def collected(
    order: Sequence[Cell], names: Sequence[str], replications: int, processes: int, kept: Path | None
) -> list[dict[str, Any]]:
    """Return the rows of all replications; those in the file ``kept`` are not run again, and new ones go there."""
    known = {cell.name for cell in order}
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept and kept.exists() else []
    rows = [row for row in rows if row["cell"] in known and row["estimator"] in names and row["number"] < replications]
    done = {(row["cell"], row["number"], row["estimator"]) for row in rows}
    tasks = []
    for number in range(replications):
        for cell in order:
            missing = tuple(n for n in names if (cell.name, number, n) not in done and number < SLOW.get(n, number + 1))
            if missing:
                tasks.append((cell, number, missing))
    began = time.perf_counter()
    for count, new in enumerate(_each(tasks, processes), start=1):
        rows += new
        if kept:
            with kept.open("a") as file:
                file.writelines(json.dumps(row) + "\n" for row in new)
        rate = count / (time.perf_counter() - began)
        if count % 20 == 0 or count == len(tasks):
            left = (len(tasks) - count) / rate
            print(f"{count} of {len(tasks)} recordings, {rate:.2f}/s, {left / 60:.1f} min left", flush=True)
    return rows


def _each(tasks: Sequence[tuple[Cell, int, tuple[str, ...]]], processes: int) -> Iterable[list[dict[str, Any]]]:
    if processes == 1:
        yield from map(replication, tasks)
        return
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap_unordered(replication, tasks)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="six cells, 20 replications")
    parser.add_argument("--cells", default="", help="only cells whose name contains this")
    parser.add_argument("--estimators", default="", help="names with commas; all that are registered, and compare")
    parser.add_argument("--replications", type=int, default=0, help="recordings a cell; 100, or 20 with --quick")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=None, help="file of rows (JSON lines) to resume from and add to")
    parser.add_argument("--out", type=Path, default=None, help="write the tables there, too")
    parser.add_argument("--compact", action="store_true", help="one line a cell and estimator")
    parser.add_argument("--stored", action="store_true", help="fit nothing; only what --keep has")
    arguments = parser.parse_args()
    registered = list(plugins.load().estimators)
    names = arguments.estimators.split(",") if arguments.estimators else [*registered, COMPARE]
    order = [c for c in (quick_cells() if arguments.quick else cells()) if arguments.cells in c.name]
    replications = arguments.replications or (20 if arguments.quick else 100)
    if arguments.keep:
        arguments.keep.parent.mkdir(parents=True, exist_ok=True)
    if arguments.stored:
        rows = [json.loads(line) for line in arguments.keep.read_text().splitlines()]
    else:
        rows = collected(order, names, replications, arguments.processes, arguments.keep)
    text = "\n".join((compact if arguments.compact else printed)(rows, order, names))
    print(text)
    if arguments.out:
        arguments.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
