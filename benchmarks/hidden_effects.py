"""The hidden-effect challenge: how often the missing effect is named, and how often one is named that is not there.

Recordings are drawn from the rig with effect, size, noise, excitation, scale and seed at random. Rows go to a JSONL
file as they come; running again does only what is missing. ``--report`` writes docs/hidden_effects.md.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hidden.draw import EFFECTS
from hidden.figures import report, summary
from hidden.look_alikes import SITUATIONS

ROOT = Path(__file__).resolve().parent.parent
Row = dict[str, Any]
Job = tuple[str, str, int]
LONGEST = 600.0
"""Seconds after which a trial is given up."""


def jobs(arguments: argparse.Namespace) -> Iterator[Job]:
    """Yield every trial, in an order in which an early end leaves some of each."""
    only = arguments.only
    rounds = max(arguments.seeds, arguments.power, arguments.looks, 1)
    effects = [e for e in EFFECTS if not only or e in only]
    for index in range(rounds):
        if index < arguments.seeds:
            yield from (("single", effect, index) for effect in effects)
        if index < arguments.looks and not only:
            yield from (("alike", situation, index) for situation in SITUATIONS)
        if index < arguments.power:
            yield from (("power", effect, index) for effect in effects)
        if not only:
            share = slice(index * arguments.nulls // rounds, (index + 1) * arguments.nulls // rounds)
            yield from (("null", "", i) for i in range(arguments.nulls)[share])
            share = slice(index * arguments.pairs // rounds, (index + 1) * arguments.pairs // rounds)
            yield from (("pair", "", i) for i in range(arguments.pairs)[share])


def key(job: Job, seed: int) -> str:
    return ":".join([*map(str, job), str(seed)])


def code() -> str:
    """Return a fingerprint of the code under test and of the challenge."""
    import fricmodels

    digest = hashlib.sha256()
    for folder in (Path(fricmodels.__file__).parent, Path(__file__).parent / "hidden"):
        for path in sorted(folder.rglob("*.py")):
            if path.name != "figures.py" and not {"cli", "report", "tournament", "readers", "export"} & set(path.parts):
                digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def stored(path: Path, fingerprint: str | None) -> dict[str, Row]:
    """Return the rows of earlier runs by key, those of the same code only unless ``fingerprint`` is ``None``."""
    if not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return {row["key"]: row for row in rows if fingerprint in (None, row["code"])}


def run(arguments: argparse.Namespace) -> dict[str, Row]:
    """Run what is missing and return all rows."""
    from concurrent.futures import as_completed

    from pebble import ProcessPool

    from hidden.trials import trial

    fingerprint = code()
    path = Path(arguments.out)
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = stored(path, None if arguments.any_code else fingerprint)
    wanted = {key(job, arguments.seed): job for job in jobs(arguments)}
    rows = {k: row for k, row in rows.items() if k in wanted}
    waiting = {k: job for k, job in wanted.items() if rows.get(k, {}).get("status", "failed") == "failed"}
    print(f"{len(wanted)} trials, {len(wanted) - len(waiting)} of them stored in {path.name}", flush=True)
    if not waiting or arguments.no_run:
        return rows
    began, done = time.perf_counter(), 0
    context = multiprocessing.get_context("spawn")
    with ProcessPool(arguments.jobs, context=context) as pool, path.open("a", encoding="utf-8") as file:
        futures = {pool.schedule(trial, args=[*job, arguments.seed], timeout=LONGEST): k for k, job in waiting.items()}
        try:
            for future in as_completed(futures):
                k = futures[future]
                try:
                    row = future.result()
                except Exception as error:
                    row = {"status": "failed", "message": f"{type(error).__name__}: {error}".splitlines()[0]}
                kind, effect, index = wanted[k]
                rows[k] = {"key": k, "code": fingerprint, "kind": kind, "effect": effect, "index": index, **row}
                file.write(json.dumps(rows[k]) + "\n")
                file.flush()
                done += 1
                rate = done / (time.perf_counter() - began)
                left = (len(waiting) - done) / rate
                if done % arguments.every == 0 or done == len(waiting):
                    print(
                        f"{done}/{len(waiting)}  {rate:.2f}/s  {left / 60:.1f} min left  {_short(rows[k])}", flush=True
                    )
        except KeyboardInterrupt:
            pool.stop()
            print("stopped; run again for the rest", flush=True)
    return rows


def _short(row: Row) -> str:
    answer = row.get("names", row.get("final", "")) or row.get("verdict", row["status"])
    return f"{row['kind']} {row['effect']} → {answer}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a few of each, in about three minutes")
    parser.add_argument("--seeds", type=int, help="recordings of each effect (12)")
    parser.add_argument("--nulls", type=int, help="recordings with nothing hidden (500)")
    parser.add_argument("--pairs", type=int, help="recordings with two effects (60)")
    parser.add_argument("--power", type=int, help="power curves of each effect (3)")
    parser.add_argument("--looks", type=int, help="recordings of each look-alike situation (8)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", action="append", choices=EFFECTS, help="this effect (repeatable)")
    parser.add_argument("--out", default=str(ROOT / "runs" / "hidden_effects.jsonl"))
    parser.add_argument("--every", type=int, default=10, help="trials between lines of progress")
    parser.add_argument("--any-code", action="store_true", help="use stored rows of other versions of the code too")
    parser.add_argument("--no-run", action="store_true", help="only print what is stored")
    parser.add_argument("--times", action="store_true", help="measure time and memory too")
    parser.add_argument("--report", action="store_true", help="write docs/hidden_effects.md")
    arguments = parser.parse_args()
    defaults = {"seeds": 12, "nulls": 500, "pairs": 60, "power": 3, "looks": 8}
    few = {"seeds": 1, "nulls": 10, "pairs": 2, "power": 0, "looks": 1}
    for name, value in (few if arguments.quick else defaults).items():
        if getattr(arguments, name) is None:
            setattr(arguments, name, value)
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"))
    rows = run(arguments)
    measured = Path(arguments.out).with_name("hidden_effects_times.json")
    if arguments.times:
        from hidden.times import measure

        measured.write_text(json.dumps(measure()), encoding="utf-8")
    times = json.loads(measured.read_text(encoding="utf-8")) if measured.exists() else {}
    lines = summary(list(rows.values()), times)
    print("\n".join(lines))
    if arguments.report:
        command = " ".join(["python benchmarks/hidden_effects.py", *(a for a in sys.argv[1:] if a != "--report")])
        from fricmodels.files import write_text

        page = ROOT / "docs" / "hidden_effects.md"
        write_text(page, report(lines, command, page))


if __name__ == "__main__":
    main()
