"""Spoils good recordings in many ways and counts how often the log check says so; writes docs/log_check.md.

    python benchmarks/sabotage.py [--rigs 160] [--simulations 30] [--seed 1] [--write]

Named: a finding of a kind that belongs to what was done. Accused: a warning or a stop on a recording that was not
touched, a delay aside where the rig hides one.
"""

from __future__ import annotations

import argparse
import datetime
import time
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from fricmodels.files import write_text
from fricmodels.logcheck import Severity, findings
from fricmodels.recording import Recording
from fricmodels.signals.outages import without_outages
from fricmodels.signals.wrapping import unwrap
from sabotaged.elastic import elastic
from sabotaged.good import Good, real, rigs, simulations
from sabotaged.ways import BOTH, WAYS, Way

PAGE = Path(__file__).parent.parent / "docs" / "log_check.md"
TEMPLATE = Path(__file__).parent / "log_check.md"


def judged(recording: Recording, inertia: float | None = None) -> dict[str, Severity]:
    """Return the kinds that are found, each with its gravest severity."""
    found: dict[str, Severity] = {}
    for finding in findings(unwrap(without_outages(recording)), inertia):
        found.setdefault(finding.kind, finding.severity)
    return found


def spoilt(good: Good, way: Way, number: int, tally: dict[str, Counter[str]]) -> None:
    if way.told == "inertia" and good.inertia is None:
        return
    changed = way.spoil(good.recording, np.random.default_rng(number))
    if changed is None:
        return
    found = judged(changed, way.times * good.inertia if way.told == "inertia" and good.inertia else None)
    row = tally[way.name]
    row["done"] += 1
    row["named"] += any(kind in found for kind in way.says)
    row["stopped"] += Severity.STOP in found.values()
    if not any(kind in found for kind in way.says):
        row[f"missed: {good.name.partition(':')[0].rstrip('0123456789 ')}"] += 1


def untouched(good: Good) -> dict[str, Severity]:
    """Return what a recording is accused of that nobody touched."""
    found = judged(good.recording, good.inertia)
    return {k: s for k, s in found.items() if s is not Severity.NOTE and k not in good.allowed}


def late(drives: Iterable[Good]) -> str:
    """Return how many drives that are not late are called so, and of how many it is said that they look so."""
    tally: Counter[str] = Counter()
    for good in drives:
        said = [finding.text for finding in findings(unwrap(good.recording)) if finding.kind == "torque-delay"]
        tally["done"] += 1
        tally["called"] += any("looks as if" not in text for text in said)
        tally["looks"] += any("looks as if" in text for text in said)
    return f"of {tally['done']} such drives {tally['called']} are called late, and of {tally['looks']} it is said"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=int, default=160)
    parser.add_argument("--simulations", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--write", action="store_true", help="write docs/log_check.md")
    asked = parser.parse_args()
    tally: dict[str, Counter[str]] = defaultdict(Counter)
    accused: Counter[str] = Counter()
    seconds: list[float] = []
    lines = []
    simulated = [*rigs(asked.rigs, asked.seed), *simulations(asked.simulations, asked.seed)]
    measured = list(real())
    for number, good in enumerate([*simulated, *measured]):
        start = time.perf_counter()
        said = untouched(good)
        seconds.append(time.perf_counter() - start)
        if number >= len(simulated):
            lines.append((good.name, said))
        else:
            accused["done"] += 1
            accused["accused"] += bool(said)
            accused["stopped"] += Severity.STOP in said.values()
            if said:
                print(f"accused: {good.name}: {', '.join(said)}", flush=True)
        for way in (*WAYS, *BOTH):
            if number >= len(simulated) and set(way.says) & set(said):
                continue  # it is like that by itself
            spoilt(good, way, number, tally)
    total = Counter[str]()
    rows = []
    for way in WAYS:
        total.update(tally[way.name])
        rows.append(_row(way.name, way.says, tally[way.name]))
    rows.append(_row("**all**", (), total))
    rows += [_row(way.name, way.says, tally[way.name]) for way in BOTH]
    parts = {
        "command": f"python benchmarks/sabotage.py --rigs {asked.rigs} --simulations {asked.simulations} "
        f"--seed {asked.seed}",
        "date": f"{datetime.date.today():%Y-%m-%d}",
        "recordings": str(len(simulated) + len(measured)),
        "table": "\n".join(["| what was done | kind | recordings | named | stopped |", "|---|---|---|---|---|", *rows]),
        "untouched": f"{accused['accused']} of {accused['done']} accused, {accused['stopped']} stopped",
        "real": "\n".join(f"| {name} | {', '.join(said) or '–'} |" for name, said in lines),
        "elastic": late(elastic(asked.rigs, asked.seed)),
        "seconds": f"{1e3 * float(np.median(seconds)):.0f} ms",
    }
    for way in WAYS:
        print(_row(way.name, way.says, tally[way.name]), {k: v for k, v in tally[way.name].items() if "missed" in k})
    print(*rows[len(WAYS) :], parts["untouched"], parts["elastic"], parts["seconds"], parts["real"], sep="\n")
    if asked.write:
        text = TEMPLATE.read_text(encoding="utf-8")
        for name, value in parts.items():
            text = text.replace("{{" + name + "}}", value)
        write_text(PAGE, text)


def _row(name: str, says: tuple[str, ...], row: Counter[str]) -> str:
    kinds = ", ".join(f"`{kind}`" for kind in says)
    done = max(row["done"], 1)
    named, stopped = (100 * row[key] / done for key in ("named", "stopped"))
    return f"| {name} | {kinds} | {row['done']} | {named:.1f} % | {stopped:.0f} % |"


if __name__ == "__main__":
    main()
