"""The figures of the challenge on rough drives from its rows, beside those asked for."""

from __future__ import annotations

import datetime
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.diagnosis.support import Support
from hidden.figures import NOTES, share
from rough.judge import alike, first_right, is_right, matters, named, rest_is_unknown, rest_matters, there, wrong

Row = dict[str, Any]
KINDS = ("null", "single", "several", "beside", "unlisted")


def _line(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    return ["", _line(head), "|" + "---|" * len(head), *map(_line, rows)]


def summary(rows: Sequence[Row]) -> list[str]:
    """Return all tables as lines of Markdown."""
    of = {kind: [r for r in rows if r["kind"] == kind and r["status"] == "ok"] for kind in KINDS}
    lines = ["", "## Figures", *_overview(of), "", "## Single effects, by effect", *_effects(of["single"])]
    for title, key in VIEWS.items():
        lines += ["", f"## By {title}", *_by(title, key, of)]
    lines += ["", "## Naming against silence", "", *TRADE.splitlines(), *_trade(of)]
    lines += ["", "## Wrong names", *_wrong(of), "", "## Time and trials without a result", "", *_rest(rows)]
    return lines


OF_TIME = frozenset({"drift", "step-change"})
"""Effects of the time itself: on another motion their instants are others."""


def _members(rows: Iterable[Row]) -> list[bool]:
    """Return for each class that is named whether it is right."""
    return [is_right(r, names) for r in rows for names in r["last_names"]]


def _found(rows: Iterable[Row]) -> list[bool]:
    """Return for each hidden listed effect that matters whether it is named."""
    return [named(r, true) for r in rows for true in r["matter"]]


def _elsewhere(rows: Iterable[Row], least: float) -> list[bool]:
    ends = [r["elsewhere"] for r in rows if r["elsewhere"] and "last" in r["elsewhere"]]
    return [e["last"] < least * e["first"] for e in ends]


def _overview(of: Mapping[str, list[Row]]) -> list[str]:
    null, several, beside, alone = of["null"], of["several"], of["beside"], of["unlisted"]
    single = [r for r in of["single"] if matters(r)]
    small = [r for r in of["single"] if not matters(r)]
    everything = [r for rows in of.values() for r in rows]
    rest = [r for r in beside if rest_matters(r)]
    lasting = [r for r in everything if not r["unlisted"] and OF_TIME.isdisjoint(r["listed"])]
    return _table(
        ["figure", "asked", "measured (95 % interval)"],
        [
            ("nothing hidden: a false name", "≤ 1 %", share(bool(wrong_first(r)) for r in null)),
            ("nothing hidden: “unknown”", "≤ 3 %", share(r["verdict"] == "unknown-effect" for r in null)),
            ("single effect that matters: right class first", "≥ 97 %", share(map(first_right, single))),
            ("– another class first", "", share(bool(r["names"]) and not first_right(r) for r in single)),
            ("– single effect that is too small to matter: a wrong name", "", share(bool(wrong(r)) for r in small)),
            ("several: names given that are there", "≥ 95 %", share(_members(several))),
            ("several: effects that matter that are named", "≥ 80 %", share(_found(several))),
            ("listed beside unlisted: named", "≥ 80 %", share(_found(beside))),
            ("– names given that are there", "", share(_members(beside))),
            ("– the rest said to be unknown, where it matters", "≥ 90 %", share(map(rest_is_unknown, rest))),
            ("only unlisted: a wrong name", "≤ 5 %", share(bool(wrong(r)) for r in alone)),
            ("– said to be unknown, where it matters", "", share(rest_is_unknown(r) for r in alone if rest_matters(r))),
            ("another motion: last model better than first", "≥ 98 %", share(_elsewhere(everything, 1.0))),
            ("– not worse by more than 2 %", "always", share(_elsewhere(everything, 1.02))),
            ("– better, with nothing off the list or of the time itself", "", share(_elsewhere(lasting, 1.0))),
        ],
    )


def wrong_first(row: Row) -> list[list[str]]:
    """Return the classes that ``diagnose`` names in which nothing is there."""
    return [names for names in row["names"] if not is_right(row, names)]


def _effects(single: list[Row]) -> list[str]:
    cells = []
    for name in sorted({r["name"] for r in single}):
        rows = [r for r in single if r["name"] == name]
        counted = [r for r in rows if matters(r)]
        other = Counter(
            _class(r["names"][0]) if r["names"] else r["verdict"] for r in counted if not first_right(r)
        ).most_common()
        answers = ", ".join(f"{text} {n}" for text, n in other)
        end = share(named(r, name) for r in counted)
        cells.append([f"`{name}`", len(rows), share(map(first_right, counted)), end, answers])
    return _table(["effect", "drawn", "right class first, of those that matter", "named by `improve`", "else"], cells)


def _class(names: Sequence[str]) -> str:
    return names[0] + (f" [{', '.join(sorted(names[1:]))}]" if len(names) > 1 else "")


def _colour(row: Row) -> str:
    s = row["sensors"]
    kinds = [n for n in ("velocity", "torque") if s[f"{n}_colour"] and s[f"{n}_noise"]]
    return " and ".join(kinds) or "white"


def _stamps(row: Row) -> str:
    s = row["sensors"]
    return "even" if not s["jitter"] else "false stamps" if s["false_stamps"] else "true jitter"


def _between(value: float, edges: Sequence[int], unit: str) -> str:
    low, high = next((a, b) for a, b in pairwise(edges) if a <= value < b)
    return f"{low} to below {high} {unit}"


VIEWS: Mapping[str, Callable[[Row], str]] = {
    "excitation": lambda r: str(r["motion"]),
    "drive": lambda r: str(r["drive"]),
    "control": lambda r: str(r["control"]),
    "velocity channel": lambda r: str(r["sensors"]["velocity"]),
    "coloured noise of": _colour,
    "time stamps": _stamps,
    "rate": lambda r: _between(r["sensors"]["rate"], (50, 200, 1000, 5001), "Hz"),
    "encoder": lambda r: _between(r["sensors"]["bits"], (12, 15, 18, 21), "bit"),
    "position": lambda r: "recorded" if r["sensors"]["position"] else "not recorded",
    "runs": lambda r: "one" if r["runs"] == 1 else "several",
    "inertia": lambda r: "given" if r["inertia_given"] else "estimated",
}


def _by(title: str, key: Callable[[Row], str], of: Mapping[str, list[Row]]) -> list[str]:
    values = sorted({key(r) for rows in of.values() for r in rows})
    several = [*of["several"], *of["beside"]]
    cells = [
        [
            value,
            share(bool(wrong_first(r)) for r in of["null"] if key(r) == value),
            share(r["verdict"] == "unknown-effect" for r in of["null"] if key(r) == value),
            share(first_right(r) for r in of["single"] if key(r) == value and matters(r)),
            share(_members(r for r in several if key(r) == value)),
            share(_found(r for r in several if key(r) == value)),
            share(bool(wrong(r)) for r in of["unlisted"] if key(r) == value),
        ]
        for value in values
    ]
    head = [
        title,
        "null: false",
        "null: unknown",
        "single: right",
        "names that are there",
        "effects named",
        "unlisted: wrong",
    ]
    return _table(head, cells)


CURVES: Mapping[str, Sequence[float]] = {
    "own_share": (0.0, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95),
    "of_channel": (0.0, 0.8, 0.85, 0.9, 0.95, 1.0),
}
"""Thresholds at which names are counted, by the name of the constant in the policy."""


def _trade(of: Mapping[str, list[Row]]) -> list[str]:
    """Return names given and effects named at other thresholds than those of the policy, the others kept."""
    rows = [r for rows in of.values() for r in rows if r.get("judged")]
    cells = []
    for rule, levels in CURVES.items():
        for level in levels:
            policy = replace(POLICY, **{rule: level})
            names = {r["key"]: _supported(r, policy) for r in rows}
            wrong = [not is_right(r, one) for r in rows for one in names[r["key"]]]
            found = [
                any(not alike(r, true).isdisjoint(one) for one in names[r["key"]])
                for r in rows
                for true in r.get("matter", [])
            ]
            here = " (chosen)" if level == getattr(POLICY, rule) else ""
            cells.append([f"`{rule}` ≥ {level:g}{here}", share(wrong), share(found)])
    return _table(["threshold", "names that are wrong", "effects that matter that are named"], cells)


def _supported(row: Row, policy: Policy) -> list[list[str]]:
    """Return the classes that the first diagnosis supports under a policy."""
    fields = ("own_share", "of_channel", "torque", "p_value")
    judged = row["judged"][0]
    members = [m for m in judged["members"] if m["names"] not in judged.get("one_cause", [])]
    return [m["names"] for m in members if Support(**{key: m[key] for key in fields}).suffices(policy)]


def _wrong(of: Mapping[str, list[Row]]) -> list[str]:
    counts: Counter[tuple[str, str, str]] = Counter()
    for kind, rows in of.items():
        for row in rows:
            hidden = " + ".join([*sorted(there(row)), *row["unlisted"]]) or "nothing"
            counts.update((kind, hidden, _class(names)) for names in wrong(row))
    return _table(["kind", "what is there", "named", "times"], [(*k, n) for k, n in sorted(counts.items())])


def _rest(rows: Sequence[Row]) -> list[str]:
    seconds = sorted(r["seconds"] for r in rows if r["status"] == "ok")
    lines = (
        [f"{sum(seconds) / max(len(seconds), 1):.1f} s a trial on average, {seconds[-1]:.0f} s at most."]
        if seconds
        else []
    )
    lost = Counter((r["kind"], r["message"]) for r in rows if r["status"] != "ok")
    return lines + [f"- {n} × {kind}: {message}" for (kind, message), n in lost.items()]


def page(lines: Sequence[str], command: str, target: Path) -> str:
    """Return the whole page; what was written by hand below the mark is kept."""
    before = target.read_text(encoding="utf-8") if target.exists() else ""
    notes = before.partition(NOTES)[2]
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    head = [
        "# The challenge on rough drives",
        "",
        f"Measured on {today} by `{command}`.",
        "",
        *INTRODUCTION.splitlines(),
    ]
    return "\n".join([*head, *lines, "", NOTES]) + (notes or "\n")


TRADE = """\
Effects of the set that the first diagnosis finds on the base model, each judged at another threshold while the others
stay. That the test error must fall with an effect before it is named is left out here."""

INTRODUCTION = """\
Recordings of a simulator that shares nothing with the [rig](rig.md): robot joints, spindles, servos and linear axes in
a loop with a sampled controller, integrated at 24 kHz or faster, logged at 50 Hz to 5 kHz with encoders of 12 to 20
bit, a velocity that is measured, derived, low-passed or absent, white or coloured noise, jittered or false time stamps.
Effects have 1 to 30 % of the RMS torque. The model that is given is `coulomb-viscous`; its inertia is told in seven of
ten.

- **matters**: with the true effect added and fitted, the test error is at most 0.9 times as much; of several, with all
  of them against all others. What remains matters if the same drive without it has a test error of at most 0.9 times.
- **right class**: the effect is in the class of look-alikes that is named, or an effect that
  `benchmarks/rough/judge.py` lists as not to be told from it in such a recording: an offset and a Coulomb asymmetry
  without rests; a wrong inertia and a wrong torque constant without a known load; gravity and a wrong torque constant
  with one payload; a delay, a wrong inertia and frictional lag with one frequency, and there a spring and the offset of
  its neutral point, where the inertia is estimated; gravity and stiffness within half a turn.
- **there**: hidden, or a delay of at least a tenth of a sample that sampling and sensors make by themselves.
- **another motion**: both ends of the ladder, with their parameters, on another kind of motion of the same drive."""
