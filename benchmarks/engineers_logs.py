"""What is named in logs as engineers have them: eight makes of drives, 90 recordings whose truth is known.

A joint of a collaborative robot, one of a research arm, a bus servo, a small motor, a ball screw, a direct drive, a
belt and a hydraulic axis make moves between places, Fourier series, steps of the speed, jogs, sines and chirps. Each
log is a CSV file with the columns, units and digits of its make. In 20 nothing is hidden, in 43 one effect of the list,
in 15 several, in 12 a cause that no list has. The simulator shares nothing with the rig, nor with the rough drives; see
``benchmarks/logs``. Rows go to a JSONL file as they come; running again does only what is missing.

    python benchmarks/engineers_logs.py [--jobs 2] [--seed 0] [--only NAME] [--kind clean]
    python benchmarks/engineers_logs.py --folder FOLDER --recordings
"""

from __future__ import annotations

import argparse
import hashlib
import json
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from logs.case import KINDS, Case
from logs.cases import CASES
from logs.judge import judge, summary
from logs.trial import RUNNING, Row, Stopped, recorded, trial

ROOT = Path(__file__).resolve().parent.parent


def chosen(arguments: argparse.Namespace) -> list[Case]:
    """Return the cases that are asked for; a name may be a part of it."""
    cases = [case for case in CASES if not arguments.kind or case.kind in arguments.kind]
    return [case for case in cases if not arguments.only or any(part in case.name for part in arguments.only)]


def code() -> str:
    """Return a fingerprint of the code under test and of the cases."""
    import fricmodels

    digest = hashlib.sha256()
    for folder in (Path(fricmodels.__file__).parent, Path(__file__).parent / "logs"):
        for path in sorted(folder.rglob("*.py")):
            if path.name != "judge.py":
                digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def stored(path: Path) -> dict[str, Row]:
    """Return the rows of a file by key; a line that was cut short is left out, and ended."""
    rows: dict[str, Row] = {}
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    if text and not text.endswith("\n"):
        with path.open("a", encoding="utf-8") as file:
            file.write("\n")
    for line in text.splitlines():
        try:
            row = json.loads(line)
        except json.JSONDecodeError:
            continue
        rows[row["key"]] = row
    return rows


@contextmanager
def place(folder: str | None) -> Iterator[Path]:
    """Give the folder of the recordings, a temporary one unless it is told."""
    if folder is None:
        with TemporaryDirectory() as temporary:
            yield Path(temporary)
    else:
        Path(folder).mkdir(parents=True, exist_ok=True)
        yield Path(folder)


def run(arguments: argparse.Namespace, cases: list[Case], folder: Path) -> dict[str, Row]:
    """Run what is missing and return all rows by key."""
    path, fingerprint = Path(arguments.out), code()
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = stored(path)
    waiting = [case for case in cases if _waits(rows.get(key(case, arguments.seed)), arguments.retry)]
    print(f"{len(cases)} recordings, {len(cases) - len(waiting)} of them stored in {path.name}", flush=True)
    if not waiting or arguments.no_run:
        return rows
    began = time.perf_counter()
    pool = ThreadPoolExecutor(arguments.jobs)
    futures = {pool.submit(trial, case, arguments.seed, folder, arguments.longest): case for case in waiting}
    with path.open("a", encoding="utf-8") as file:
        try:
            for done, future in enumerate(as_completed(futures), 1):
                case = futures[future]
                try:
                    found = future.result()
                except Stopped:
                    raise KeyboardInterrupt from None
                except Exception as error:
                    reason = f"{type(error).__name__}: {error}".splitlines()[0]
                    found = {"status": "failed", "message": reason, "hidden_percent": 0.0}
                row = {
                    "key": key(case, arguments.seed),
                    "code": fingerprint,
                    "kind": case.kind,
                    "make": case.make.name,
                    "truth": case.truth,
                    **found,
                }
                rows[row["key"]] = row
                file.write(json.dumps(row) + "\n")
                file.flush()
                left = (len(waiting) - done) * (time.perf_counter() - began) / done
                answer = judge(case, row).text if row["status"] == "ok" else row["message"]
                print(f"{done}/{len(waiting)}  {left / 60:.1f} min left  {case.name} → {answer}", flush=True)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in tuple(RUNNING):
                process.kill()
            print("stopped; run again for the rest", flush=True)
    return rows


def key(case: Case, seed: int) -> str:
    """Return what a row is called."""
    return f"{case.name}:{seed}"


def _waits(row: Row | None, retry: bool) -> bool:
    return row is None or (retry and row["status"] == "failed")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", action="append", metavar="NAME", help="these cases; a part of a name (repeatable)")
    parser.add_argument("--kind", action="append", choices=KINDS, help="this kind of case (repeatable)")
    parser.add_argument("--seed", type=int, default=0, help="another one draws fresh recordings of the same cases")
    parser.add_argument("--out", default=str(ROOT / "runs" / "engineers_logs.jsonl"))
    parser.add_argument("--folder", help="where recordings and answers stay; a temporary one if not given")
    parser.add_argument("--recordings", action="store_true", help="only write the recordings, into --folder")
    parser.add_argument("--longest", type=float, default=600.0, help="seconds after which a recording is given up")
    parser.add_argument("--retry", action="store_true", help="run again what failed")
    parser.add_argument("--no-run", action="store_true", help="only print what is stored")
    arguments = parser.parse_args()
    cases = chosen(arguments)
    if not cases:
        parser.error("no case has such a name")
    if arguments.recordings and arguments.folder is None:
        parser.error("--recordings needs --folder")
    with place(arguments.folder) as folder:
        if arguments.recordings:
            for case in cases:
                path, sizes = recorded(case, arguments.seed, folder)
                print(f"{path.name}: {sizes['samples']} samples, {case.truth or 'nothing hidden'}", flush=True)
            return
        rows = run(arguments, cases, folder)
    known = [(case, rows[key(case, arguments.seed)]) for case in cases if key(case, arguments.seed) in rows]
    print("\n".join(summary(known)))


if __name__ == "__main__":
    main()
