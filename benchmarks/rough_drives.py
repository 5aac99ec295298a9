"""The challenge on rough drives: what is named where drives, loops and sensors are as real as a simulation can be.

The simulator shares nothing with the rig of ``fricmodels`` nor with its effects; see ``benchmarks/rough``. Rows go to a
JSONL file as they come; running again does only what is missing. ``--report`` writes docs/rough_drives.md.
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

from rough.figures import page, summary

ROOT = Path(__file__).resolve().parent.parent
Row = dict[str, Any]
Job = tuple[str, str, int]
LONGEST = 300.0
"""Seconds after which a trial is given up."""


def jobs(arguments: argparse.Namespace) -> Iterator[Job]:
    """Yield every trial, in an order in which an early end leaves some of each."""
    from rough.effects import LISTED, UNLISTED

    each = {
        "single": (tuple(LISTED), arguments.singles),
        "several": (("",), arguments.several),
        "beside": (tuple(UNLISTED), arguments.beside),
        "unlisted": (tuple(UNLISTED), arguments.unlisted),
        "null": (("",), arguments.nulls),
    }
    kinds = {kind: each[kind] for kind in arguments.kind or each}
    rounds = max(count for _, count in kinds.values())
    for index in range(rounds):
        for kind, (names, count) in kinds.items():
            for i in range(index * count // rounds, (index + 1) * count // rounds):
                yield from ((kind, name, i) for name in names if not arguments.only or name in arguments.only)


def code() -> str:
    """Return a fingerprint of the code under test and of the challenge."""
    import fricmodels

    digest = hashlib.sha256()
    for folder in (Path(fricmodels.__file__).parent, Path(__file__).parent / "rough"):
        for path in sorted(folder.rglob("*.py")):
            if path.name != "figures.py" and not {"cli", "report", "tournament", "readers", "export"} & set(path.parts):
                digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def run(arguments: argparse.Namespace) -> list[Row]:
    """Run what is missing and return all rows that are asked for."""
    from concurrent.futures import as_completed

    from pebble import ProcessPool

    from rough.trials import trial

    path, fingerprint = Path(arguments.out), code()
    path.parent.mkdir(parents=True, exist_ok=True)
    stored = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    known = {row["key"]: row for row in stored if arguments.any_code or row["code"] == fingerprint}
    wanted = {":".join([*map(str, job), str(arguments.seed)]): job for job in jobs(arguments)}
    rows = {key: known[key] for key in wanted if key in known and known[key]["status"] != "failed"}
    waiting = {key: job for key, job in wanted.items() if key not in rows}
    print(f"{len(wanted)} trials, {len(rows)} of them stored in {path.name}", flush=True)
    if not waiting or arguments.no_run:
        return list(rows.values())
    began = time.perf_counter()
    context = multiprocessing.get_context("spawn")
    with ProcessPool(arguments.jobs, context=context) as pool, path.open("a", encoding="utf-8") as file:
        futures = {pool.schedule(trial, args=[*job, arguments.seed], timeout=LONGEST): k for k, job in waiting.items()}
        try:
            for done, future in enumerate(as_completed(futures), 1):
                key = futures[future]
                kind, name, index = wanted[key]
                try:
                    row = future.result()
                except Exception as error:
                    row = {"status": "failed", "message": f"{type(error).__name__}: {error}".splitlines()[0]}
                rows[key] = {"key": key, "code": fingerprint, "kind": kind, "name": name, "index": index, **row}
                file.write(json.dumps(rows[key]) + "\n")
                file.flush()
                left = (len(waiting) - done) * (time.perf_counter() - began) / done
                if done % arguments.every == 0 or done == len(waiting):
                    answer = row.get("last_names", row["status"])
                    print(f"{done}/{len(waiting)}  {left / 60:.1f} min left  {key} → {answer}", flush=True)
        except KeyboardInterrupt:
            pool.stop()
            print("stopped; run again for the rest", flush=True)
    return list(rows.values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nulls", type=int, default=500, help="recordings with nothing hidden")
    parser.add_argument("--singles", type=int, default=10, help="recordings of each listed effect")
    parser.add_argument("--several", type=int, default=100, help="recordings with two to four listed effects")
    parser.add_argument("--beside", type=int, default=10, help="recordings of each unlisted effect beside a listed one")
    parser.add_argument("--unlisted", type=int, default=8, help="recordings of each unlisted effect")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--kind", action="append", help="this kind of trial (repeatable)")
    parser.add_argument("--only", action="append", help="this effect (repeatable)")
    parser.add_argument("--out", default=str(ROOT / "runs" / "rough_drives.jsonl"))
    parser.add_argument("--also", action="append", default=[], help="rows of another run that count too (repeatable)")
    parser.add_argument("--every", type=int, default=10, help="trials between lines of progress")
    parser.add_argument("--any-code", action="store_true", help="use stored rows of other versions of the code too")
    parser.add_argument("--no-run", action="store_true", help="only print what is stored")
    parser.add_argument("--report", action="store_true", help="write docs/rough_drives.md")
    arguments = parser.parse_args()
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"))
    others = [line for path in arguments.also for line in Path(path).read_text(encoding="utf-8").splitlines()]
    lines = summary([*run(arguments), *(row for row in map(json.loads, others) if row["status"] != "failed")])
    print("\n".join(lines))
    if arguments.report:
        from fricmodels.files import write_text

        command = " ".join(["python benchmarks/rough_drives.py", *(a for a in sys.argv[1:] if a != "--report")])
        target = ROOT / "docs" / "rough_drives.md"
        write_text(target, page(lines, command, target))


if __name__ == "__main__":
    main()
