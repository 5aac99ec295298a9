"""What each rule of the diagnosis is worth: every one is switched off, on both challenges and real recordings.

Drives of the rig with an effect on the list of candidates and off it, with two, and with nothing hidden; rough drives;
and the real recordings beside the project, where they are. The rules of the ladder are switched off in ``improve``, all
others in a first diagnosis. Those that change many answers are switched off one by one. The others are switched off
together, and only where the answer changes by halves, until those are found by which it does (group testing, Dorfman
1943): two rules whose changes undo each other are not seen. Rows go to a JSONL file as they come; running again does
only what is missing. ``--report`` writes docs/ablation.md.

    python benchmarks/ablation.py [--seed N] [--jobs 2] [--count rough:null=60 …] [--logs LOGS.yaml] [--report]

Other logs are the datasets of a tournament: files, columns and, where it is known, the inertia.
"""

from __future__ import annotations

import argparse
import datetime
import functools
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
Row = dict[str, Any]
LADDER = ("superfluous_gain", "removal_loss", "exchange_margin", "exchange_for_adequate")
"""Rules that are used between the rungs of a ladder only."""
ONE_BY_ONE = ("significance", "of_channel", "kept", "outpredicted_significance", "own_share", "least_torque")
"""Rules that change many answers: a group with one of them would always have to be halved."""
COUNTS = {
    "rig:null": 40,
    "rig:listed": 1,
    "rig:unlisted": 1,
    "rig:pair": 6,
    "rough:null": 250,
    "rough:single": 3,
    "rough:several": 16,
    "rough:beside": 3,
    "rough:unlisted": 5,
}
SEVERAL = ("pair", "several", "beside", "real", "log")
"""Kinds of recordings, or sets of them, in which rules of the ladder are switched off as well."""
LONGEST = 1800.0


def ablated(key: str, seed: int, logs: Path | None = None) -> Row:
    """Return what is said of one recording with every rule, and what changes without each."""
    from ablated.cases import Case, case
    from fricmodels.diagnosis import examine, improve
    from fricmodels.diagnosis.ladder import added
    from fricmodels.diagnosis.policy import POLICY, Policy

    Answer = Callable[[Case, Policy], Row]
    used: set[str] = set()

    class Watched(Policy):
        """A policy that notes which of its constants are used: switching off another one changes nothing."""

        def __getattribute__(self, name: str) -> Any:
            used.add(name)
            return super().__getattribute__(name)

    def first(of: Case, policy: Policy) -> Row:
        found = examine(of.comparison, leave_out=of.leave_out, policy=policy)
        return {"verdict": found.verdict, "names": [list(f.names) for f in found.findings]}

    def last(of: Case, policy: Policy) -> Row:
        ladder = improve(*of.given, leave_out=of.leave_out, policy=policy)
        return {"verdict": ladder.last.verdict, "names": [list(f.names) for f in added(ladder)]}

    began, of = time.process_time(), case(key, seed, logs)
    row: Row = {"matter": list(of.matter)}
    several = not {*key.split(":")[:2]}.isdisjoint(SEVERAL)
    parts: dict[str, Answer] = {"first": first, **({"last": last} if several else {})}
    for part, answer in parts.items():
        used.clear()
        told = {"": answer(of, Watched())}
        rules = [r for r in rules_off() if r in used and (r in LADDER) == (part == "last")]

        def differing(group: Sequence[str], answer: Answer = answer, told: dict[str, Row] = told) -> dict[str, Row]:
            """Return the answers without each rule of a group by which they differ."""
            said = answer(of, functools.reduce(Policy.without, group, POLICY)) if group else told[""]
            if said == told[""] or len(group) < 2:
                return dict.fromkeys(group, said)
            half = len(group) // 2
            return differing(group[:half]) | differing(group[half:])

        for rule in ONE_BY_ONE:
            told |= differing([rule] if rule in rules else [])
        told |= differing([rule for rule in rules if rule not in ONE_BY_ONE])
        for said in told.values():
            said["right"] = [of.is_right(names) for names in said["names"]]
            said["found"] = [m for m in of.matter if any(m in names for names in said["names"])]
        row[part] = {**told[""], "without": {r: said for r, said in told.items() if r and said != told[""]}}
    return {**row, "cpu": time.process_time() - began}


def rules_off() -> list[str]:
    """Return the rules that can be switched off."""
    from dataclasses import fields

    from fricmodels.diagnosis.policy import Policy

    return [entry.name for entry in fields(Policy) if entry.metadata["off"] is not None]


def run(arguments: argparse.Namespace) -> list[Row]:
    """Run what is missing and return all rows that are asked for."""
    from concurrent.futures import as_completed

    from pebble import ProcessPool

    from ablated.cases import keys, listed

    logs = Path(arguments.logs).resolve() if arguments.logs else None
    named = [source.dataset for source in listed(logs)[1]] if logs else []
    path = Path(arguments.out)
    path.parent.mkdir(parents=True, exist_ok=True)
    stored = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    known = {row["key"]: row for row in stored if row["seed"] == arguments.seed}
    wanted = list(dict.fromkeys(keys(COUNTS | dict(arguments.count), with_real=not arguments.no_real, logs=named)))
    waiting = [] if arguments.no_run else [key for key in wanted if known.get(key, {}).get("status") != "ok"]
    stored_of = sum(known.get(key, {}).get("status") == "ok" for key in wanted)
    print(f"{len(wanted)} recordings, {stored_of} of them stored in {path.name}", flush=True)
    began, context = time.perf_counter(), multiprocessing.get_context("spawn")
    with ProcessPool(arguments.jobs, context=context) as pool, path.open("a", encoding="utf-8") as file:
        futures = {pool.schedule(ablated, args=[key, arguments.seed, logs], timeout=LONGEST): key for key in waiting}
        try:
            for done, future in enumerate(as_completed(futures), 1):
                key = futures[future]
                try:
                    row = {"status": "ok", **future.result()}
                except Exception as error:
                    row = {"status": "failed", "message": f"{type(error).__name__}: {error}".splitlines()[0]}
                known[key] = {"key": key, "seed": arguments.seed, **row}
                file.write(json.dumps(known[key]) + "\n")
                file.flush()
                left = (time.perf_counter() - began) / done * (len(waiting) - done) / 60
                print(f"{done}/{len(waiting)}  {left:.0f} min left  {key} {row['status']}", flush=True)
        except KeyboardInterrupt:
            pool.stop()
            print("stopped; run again for the rest", flush=True)
    return [known[key] for key in wanted if key in known]


FIGURES = ("false names", "unknown", "right names", "wrong names", "named of those that matter")


def figures(rows: Iterable[Row], rule: str, part: str) -> dict[str, int]:
    """Return the counts of a challenge, without a rule or, where that is empty, with all."""
    counts = dict.fromkeys(FIGURES, 0)
    for row in rows:
        if part not in row:
            continue
        said = row[part]["without"].get(rule, row[part])
        if ":null:" in row["key"]:
            counts["false names"] += bool(said["names"])
            counts["unknown"] += said["verdict"] == "unknown-effect"
        else:
            counts["right names"] += sum(said["right"])
            counts["wrong names"] += len(said["right"]) - sum(said["right"])
            counts["named of those that matter"] += len(said["found"])
    return counts


def table(rows: Sequence[Row]) -> list[str]:
    """Return what changes without each rule as lines of Markdown."""
    sets = {name: [r for r in rows if r["status"] == "ok" and r["key"].startswith(name)] for name in ("rig", "rough")}
    real = [r for r in rows if r["status"] == "ok" and r["key"].startswith(("real", "log"))]
    head = [f"{name}: {figure}" for name in sets for figure in (*FIGURES, "answers that change")]
    lines = [f"| without the rule | {' | '.join(head)} | real |", "|" + "---|" * (len(head) + 2)]
    for part, title in (("first", "all rules, first diagnosis"), ("last", "all rules, ladder")):
        cells = []
        for chosen in sets.values():
            cells += [*map(str, figures(chosen, "", part).values()), f"of {sum(part in r for r in chosen)}"]
        lines.append(f"| *{title}* | {' | '.join(cells)} | {sum(part in r for r in real)} |")
    for rule in rules_off():
        part = "last" if rule in LADDER else "first"
        cells = []
        for chosen in sets.values():
            with_it, without = figures(chosen, "", part), figures(chosen, rule, part)
            cells += [f"{without[f] - with_it[f]:+d}" if without[f] != with_it[f] else "" for f in FIGURES]
            changed = sum(part in r and rule in r[part]["without"] for r in chosen)
            cells.append(str(changed) if changed else "")
        other = [r["key"].split(":")[2] for r in real if part in r and rule in r[part]["without"]]
        lines.append(f"| `{rule}` | {' | '.join(cells)} | {', '.join(other)} |")
    return lines


PAGE = """\
# What each rule is worth

Measured on {date:%Y-%m-%d} by `{command}`.

Every rule of the [policy](decisions/policy.md) is switched off in turn, and the same recordings are diagnosed again.
The first line of the table counts the answers with all rules: with nothing hidden the recordings that get a name, and
those that are called unknown; of all others the names that are there, the names that are not, and how many of the
effects that matter are named. Below it stands what changes without a rule; an empty cell is no change. An answer also
changes with its look-alikes, or with their order. Real recordings have no known truth: those are listed whose answer
changes.

{counts}

Rules that choose between the rungs of a ladder are switched off in `improve`, all others in a first diagnosis.

{table}
"""


def counts(rows: Sequence[Row]) -> str:
    """Return how many recordings of each kind there are."""
    kinds: dict[str, int] = {}
    for row in rows:
        kind = " ".join(row["key"].split(":")[:2]).strip() + ("" if row["status"] == "ok" else " that failed")
        kinds[kind] = kinds.get(kind, 0) + 1
    return "Recordings: " + ", ".join(f"{count} {kind}" for kind, count in kinds.items()) + "."


def counted(text: str) -> tuple[str, int]:
    """Return the kind and the number of ``KIND=NUMBER``."""
    kind, _, number = text.partition("=")
    if kind not in COUNTS or not number.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' is not KIND=NUMBER, with a kind of {', '.join(COUNTS)}")
    return kind, int(number)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", default=str(ROOT / "runs" / "ablation.jsonl"))
    parser.add_argument("--count", type=counted, action="append", default=[], help="recordings of a kind: KIND=NUMBER")
    parser.add_argument("--no-real", action="store_true", help="leave out real recordings, which take minutes each")
    parser.add_argument("--logs", help="tournament whose datasets are further real recordings")
    parser.add_argument("--no-run", action="store_true", help="only print what is stored")
    parser.add_argument("--report", action="store_true", help="write docs/ablation.md")
    arguments = parser.parse_args()
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"))
    rows = run(arguments)
    lines = table(rows)
    print("\n".join([counts(rows), "", *lines]))
    if arguments.report:
        from fricmodels.files import write_text

        command = " ".join(
            ["python benchmarks/ablation.py", *(a for a in sys.argv[1:] if a not in ("--report", "--no-run"))]
        )
        page, marker = ROOT / "docs" / "ablation.md", "<!-- by hand -->"
        old = page.read_text(encoding="utf-8") if page.exists() else ""
        by_hand = marker + old.partition(marker)[2] if marker in old else marker + "\n"
        text = PAGE.format(date=datetime.date.today(), command=command, counts=counts(rows), table="\n".join(lines))
        write_text(page, text + "\n" + by_hand)


if __name__ == "__main__":
    main()
