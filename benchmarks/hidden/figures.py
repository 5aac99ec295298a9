"""The figures of the challenge from its rows, beside those asked for."""

from __future__ import annotations

import datetime
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from hidden.draw import EFFECTS

Row = dict[str, Any]
SIZES = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, math.inf)
"""Edges of size over the smallest size that the statistics allow."""
GAINS = (-math.inf, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Edges of the share by which the held-out error would fall without the effect."""
NOTES = "<!-- what falls short -->"


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % interval of a share by Wilson's score."""
    if not count:
        return 0.0, 1.0
    z, p = 1.96, hits / count
    centre = (p + z * z / 2 / count) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(p * (1 - p) / count + z * z / 4 / count**2)
    return max(centre - half, 0.0), min(centre + half, 1.0)


def share(results: Iterable[bool]) -> str:
    """Write a share with its interval and count."""
    values = list(results)
    if not values:
        return "–"
    low, high = wilson(sum(values), len(values))
    return f"{100 * sum(values) / len(values):.1f} % ({100 * low:.0f}–{100 * high:.0f}) of {len(values)}"


def right(row: Row) -> bool:
    return row["effect"] in row["names"]


def strictly_right(row: Row) -> bool:
    return row["names"][:1] == [row["effect"]]


def summary(rows: Sequence[Row], times: Mapping[str, float]) -> list[str]:
    """Return all tables as lines of Markdown."""
    of = {kind: [r for r in rows if r["kind"] == kind and r["status"] == "ok"] for kind in KINDS}
    lost = Counter((r["kind"], r["status"]) for r in rows if r["status"] != "ok")
    lines = ["", *_overview(of, times), "", *_effects(of["single"]), "", *_confusion(of["single"])]
    lines += ["", *_by("excitation", of["single"]), "", *_power(of["power"]), "", *_pairs(of["pair"])]
    lines += ["", *_alike(of["alike"]), "", *_nulls(of["null"])]
    if lost:
        lines += ["", "Trials without a result: " + ", ".join(f"{k} {s} ({n})" for (k, s), n in lost.items()) + "."]
        reasons = Counter(r["message"] for r in rows if r["status"] == "failed")
        lines += [f"- {n} × {message}" for message, n in reasons.items()]
        none = Counter(r["effect"] for r in rows if r["kind"] == "single" and r["status"] == "no size matters")
        lines += [f"- no size of {name} mattered in {n} trials of {_count(rows, name)}" for name, n in none.items()]
    unmet = Counter((r["effect"], kind) for r in of["single"] for kind in r["unmet"])
    lines += ["", *_too_small(of["single"])]
    if unmet:
        worst = ", ".join(f"{name} by {kind} ({n})" for (name, kind), n in unmet.most_common(12))
        lines += ["", f"Draws given up because no size mattered: {worst}."]
    return lines


def _count(rows: Sequence[Row], effect: str) -> int:
    return sum(r["kind"] == "single" and r["effect"] == effect for r in rows)


KINDS = ("single", "null", "pair", "power", "alike")


def _overview(of: Mapping[str, list[Row]], times: Mapping[str, float]) -> list[str]:
    single, null, pair, alike = of["single"], of["null"], of["pair"], of["alike"]
    after = [r["after"]["ratio"] is not None and r["after"]["ratio"] <= 1.1 for r in single]
    seconds = f"{times['warm']:.2f} s ({times['cold']:.1f} s cold)" if times else "–"
    long = f"{times['long']:.1f} s, {times['peak_gb']:.2f} GB" if times else "–"
    by = {p: ([r["peers"][p] == r["effect"] for r in single], [r for r in null if "peers" in r]) for p in PEERS}
    table = [
        ("right class named first", "≥ 97 %", share(right(r) for r in single)),
        ("– true effect first in its class", "", share(strictly_right(r) for r in single)),
        ("– true effect alone in its class", "", share(r["names"] == [r["effect"]] for r in single)),
        ("nothing hidden: a false effect", "≤ 1 %", share(bool(r["names"]) for r in null)),
        ("nothing hidden: “unknown effect”", "", share(r["verdict"] == "unknown-effect" for r in null)),
        ("held-out error ≤ 1.1 × true model's after the first named", "≥ 95 %", share(after)),
        ("– held-out error ≤ 1.1 × the base law's with nothing hidden", "", share(_restored(r) for r in single)),
        ("two hidden effects, both named", "≥ 90 %", share(_both(r) for r in pair)),
        ("effect removed from the list: “unknown effect”", "≥ 90 %", share(_unknown(r) for r in single)),
        ("– no wrong name", "", share(not r["removed"]["names"] for r in single)),
        ("– none, or such with which no more is left than with the true effect", "", share(map(_as_good, single))),
        ("look-alikes: no member asserted alone", "≥ 95 %", share(len(r["names"]) != 1 for r in alike)),
        ("20 000 samples, warm, one core (processor time)", "< 2 s", seconds),
        ("2 000 000 samples (processor time), peak memory", "< 60 s, < 2 GB", long),
    ]
    for peer, (hits, blanks) in by.items():
        table.append((f"{peer}: right effect first", "", share(hits)))
        table.append(
            (f"{peer}: names an effect where nothing is hidden", "", share(bool(r["peers"][peer]) for r in blanks))
        )
    return ["## Figures", "", "| figure | asked | measured (95 % interval) |", "|---|---|---|", *map(_line, table)]


PEERS = ("stepwise", "pysindy")
AS_LITTLE = 1.02
"""Held-out error of a fit with a wrong name over that with the true effect, at which no fit tells the two apart."""


def _line(cells: Sequence[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _titles(cells: Sequence[object]) -> list[str]:
    return [_line(cells), "|" + "---|" * len(cells)]


def _unknown(row: Row) -> bool:
    return bool(row["removed"]["verdict"] == "unknown-effect")


def _as_good(row: Row) -> bool:
    """Whether, with the true effect off the list, nothing is named, or what leaves as little held-out error as it: the
    first effect, or all that a ladder adds."""
    removed = row["removed"]
    left = [removed.get(of, {}).get("ratio") for of in ("after", "ladder")]
    return not removed["names"] or any(ratio is not None and ratio <= AS_LITTLE for ratio in left)


def _restored(row: Row) -> bool:
    """Whether the error with what was named is about what the base law leaves where nothing is hidden."""
    after = row["after"]
    return bool(after["ratio"] is not None and after["named"] <= 1.1 * row["ratio"] * after["base"])


def _both(row: Row) -> bool:
    named = {name for members in row["classes"] for name in members}
    return set(row["truth"]) <= named


def _effects(single: list[Row]) -> list[str]:
    head = ["effect", "right class first", "true name first", "after ≤ 1.1", "removed → unknown", "wrong name", *PEERS]
    lines = ["## By effect (asked: ≥ 90 % each)", "", *_titles(head)]
    for name in EFFECTS:
        rows = [r for r in single if r["effect"] == name]
        if rows:
            after = [r["after"]["ratio"] is not None and r["after"]["ratio"] <= 1.1 for r in rows]
            own = [share(right(r) for r in rows), _percent(map(strictly_right, rows)), _percent(after)]
            removed = [_percent(map(_unknown, rows)), _percent(bool(r["removed"]["names"]) for r in rows)]
            peers = [_percent(r["peers"][p] == name for r in rows) for p in PEERS]
            lines.append(_line([f"`{name}`", *own, *removed, *peers]))
    return lines


def _percent(results: Iterable[bool]) -> str:
    values = list(results)
    return f"{100 * sum(values) / len(values):.0f} %" if values else "–"


def _confusion(single: list[Row]) -> list[str]:
    lines = [
        "## Confusion",
        "",
        "First names given, with their counts; the class is in brackets where it is larger.",
        "",
    ]
    lines += ["| hidden | named | nothing |", "|---|---|---|"]
    for name in EFFECTS:
        rows = [r for r in single if r["effect"] == name]
        if rows:
            named = Counter(_class(r["names"]) for r in rows if r["names"])
            silent = Counter(r["verdict"] for r in rows if not r["names"])
            cells = [", ".join(f"{text} {n}" for text, n in c.most_common()) for c in (named, silent)]
            lines.append(_line([f"`{name}`", *cells]))
    return lines


def _class(names: Sequence[str]) -> str:
    return names[0] + (f" [{', '.join(sorted(names[1:]))}]" if len(names) > 1 else "")


def _too_small(single: list[Row]) -> list[str]:
    """Return what is said of the sizes that the challenge does not count."""
    lines = [
        "## Sizes that are not asked for",
        "",
        "Before a size was raised, or another rig drawn: the effect matters to the drive, but adding the true effect",
        "and fitting it does not lower the held-out error by a tenth.",
        "",
    ]
    head = ["effect", "recordings", "right class first", "adequate", "unknown", "wrong name"]
    lines += _titles(head)
    for name in EFFECTS:
        small = [s for r in single if r["effect"] == name for s in r["too_small"]]
        if small:
            hits = sum(name in s["names"] for s in small)
            silent = [sum(s["verdict"] == v for s in small) for v in ("adequate", "unknown-effect")]
            cells = [len(small), hits, *silent, len(small) - hits - sum(silent)]
            lines.append(_line([f"`{name}`", *cells]))
    return lines


def _by(field: str, single: list[Row]) -> list[str]:
    lines = [f"## By {field}", "", f"| {field} | right class first |", "|---|---|"]
    values = sorted({r[field] for r in single})
    return lines + [_line([v, share(right(r) for r in single if r[field] == v)]) for v in values]


def _power(rows: list[Row]) -> list[str]:
    lines = ["## How small an effect is still found", ""]
    lines += [
        "Share named by size, in multiples of the smallest size that the statistics allow on the recording of the"
    ]
    lines += ["same motion with nothing hidden; and by how much the held-out error would fall without the effect.", ""]
    sizes = [f"{_edge(a)}–{_edge(b)}" for a, b in pairwise(SIZES)]
    gains = [f"{_gain(a)}–{_gain(b)} %" for a, b in pairwise(GAINS)]
    head = ["effect", "smallest (median, % of RMS torque)", *sizes, *gains]
    lines += _titles(head)
    for name in (*EFFECTS, ""):
        chosen = [r for r in rows if name in ("", r["effect"])]
        points = [(r, p) for r in chosen for p in r["points"]]
        if not points:
            continue
        smallest = sorted(r["smallest_percent"] for r in chosen if r["smallest_percent"])
        cells: list[str] = [f"{smallest[len(smallest) // 2]:.2g}" if smallest and name else "–"]
        for low, high in pairwise(SIZES):
            inside = [
                r["effect"] in p["names"]
                for r, p in points
                if r["smallest_percent"] and low <= p["size_percent"] / r["smallest_percent"] < high
            ]
            cells.append(_of(inside))
        for low, high in pairwise(GAINS):
            cells.append(_of([r["effect"] in p["names"] for r, p in points if low <= 1 - p["ratio"] < high]))
        lines.append(_line([f"`{name}`" if name else "all", *cells]))
    hidden = Counter(r["effect"] for r in rows if not r["smallest_percent"])
    if hidden:
        lines += ["", "Said to be invisible on the recording with nothing hidden, though its effect matters: "]
        lines[-1] += ", ".join(f"{name} ({n})" for name, n in hidden.items()) + "."
    return lines


def _of(results: list[bool]) -> str:
    return f"{sum(results)}/{len(results)}" if results else ""


def _edge(value: float) -> str:
    return "∞" if math.isinf(value) else f"{value:g}"


def _gain(value: float) -> str:
    return "…" if math.isinf(value) else f"{100 * value:g}"


def _pairs(rows: list[Row]) -> list[str]:
    lines = ["## Two hidden effects", "", f"Both named: {share(_both(r) for r in rows)}; at least one: "]
    one = [any(t in c for t in r["truth"] for c in r["classes"]) for r in rows]
    none = [not any(set(c).isdisjoint(r["truth"]) for c in r["classes"]) for r in rows]
    lines[-1] += f"{share(one)}; nothing wrong named besides: {share(none)}."
    missed = Counter(t for r in rows for t in r["truth"] if not any(t in c for c in r["classes"]))
    seen = Counter(t for r in rows for t in r["truth"])
    wrong = Counter(c[0] for r in rows for c in r["classes"] if set(c).isdisjoint(r["truth"]))
    if missed:
        lines += ["Missed: " + ", ".join(f"{name} {n} of {seen[name]}" for name, n in missed.most_common()) + "."]
    if wrong:
        lines += ["Wrongly named: " + ", ".join(f"{name} {n}" for name, n in wrong.most_common()) + "."]
    return lines


def _alike(rows: list[Row]) -> list[str]:
    lines = [
        "## Look-alikes",
        "",
        "| situation | none alone | class named | alone | nothing |",
        "|---|---|---|---|---|",
    ]
    for name in sorted({r["effect"] for r in rows}):
        chosen = [r for r in rows if r["effect"] == name]
        several = [len(r["names"]) > 1 and r["truth"] in r["names"] for r in chosen]
        alone = Counter(f"{r['names'][0]} (true: {r['truth']})" for r in chosen if len(r["names"]) == 1)
        told = ", ".join(f"{text} {n}" for text, n in alone.most_common())
        cells = [share(len(r["names"]) != 1 for r in chosen), _of(several), told, sum(not r["names"] for r in chosen)]
        lines.append(_line([name, *cells]))
    return lines


def _nulls(rows: list[Row]) -> list[str]:
    false = Counter(f"{_class(r['names'])} by {r['excitation']}" for r in rows if r["names"])
    silent = [r for r in rows if r["verdict"] == "unknown-effect"]
    unknown = Counter(f"{r['view'] or 'no channel'} by {r['excitation']}" for r in silent)
    lines = [
        "## Nothing hidden",
        "",
        f"{len(rows)} recordings. A false effect in {share(bool(r['names']) for r in rows)}.",
    ]
    for text, counts in (("Falsely named", false), ("“Unknown effect” seen in", unknown)):
        if counts:
            lines.append(f"{text}: " + ", ".join(f"{name} ({n})" for name, n in counts.most_common()) + ".")
    return lines


def report(lines: Sequence[str], command: str, page: Path) -> str:
    """Return the whole page; what was written by hand below the mark is kept."""
    before = page.read_text(encoding="utf-8") if page.exists() else ""
    notes = before.partition(NOTES)[2]
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    head = ["# The hidden-effect challenge", "", f"Measured on {today} by `{command}`.", "", *INTRODUCTION.splitlines()]
    return "\n".join([*head, *lines, "", NOTES]) + (notes or "\n")


INTRODUCTION = """\
Recordings are drawn from the [rig](rig.md) with scale, excitation, size, noise (0.2–5 % of the RMS velocity) and seed
at random. An effect counts as hidden only where it matters twice. To the drive: the base law, fitted to the recording
and to that of the same rig without the effect, has a held-out RMS torque error of at most 0.9 times as much without it;
no effect's own expression takes part in that. And to the model, as is asked: with the true effect added and fitted, the
held-out error is at most 0.9 times as much. A size that is too small is raised. The stated inertia is given.

- **right class**: the hidden effect is in the class of look-alikes that is named first.
- **removed**: the true effect, the look-alikes named with it, and every effect that explains at least 98 % of what the
  true one does, are taken off the list of candidates.
- **two effects**: each alone matters so; both are in classes that `improve` kept.
- **look-alikes**: recordings made so that another effect leaves less than 2 % of what the true one explains.
- **stepwise** is forward selection by F tests, **pysindy** an ensemble of sequentially thresholded regressions, both on
  the Lanczos-filtered derivative without samples at rest, with columns for every effect (see `hidden/peers.py`)."""
