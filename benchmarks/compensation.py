"""What compensation is worth on rigs with a hidden effect, drawn as the hidden-effect challenge draws them.

Rows go to a JSONL file as they come; running again does only what is missing. ``--report`` writes the tables of
docs/compensation.md between its marks.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
EFFECTS = (
    "stribeck", "nonlinear-viscous", "load-friction", "directional-efficiency", "torque-gain", "inertia-error",
    "gravity", "stiffness", "cogging", "position-friction", "torque-ripple", "presliding", "frictional-lag",
    "rising-stiction", "backlash", "asymmetry", "torque-offset", "joint-compliance", "thermal", "drift", "step-change",
    "sensor-delay",
)  # fmt: skip
LONGEST = 900.0
BEGIN, END = "<!-- figures -->", "<!-- end of figures -->"
MODES = {
    "at the reference": {},
    "measured, direction of the reference": {"at": "measured"},
    "measured, nothing at rest": {"at": "measured", "at_rest": "none"},
    "measured, smooth": {"at": "measured", "at_rest": "smooth"},
    "measured, sign of the velocity": {"at": "measured", "at_rest": "smooth", "turn": 1e-5},
}
"""Where and how the improved model is used; the first is what `compensate` does."""
ROBUST = tuple(MODES)[:2]
TOO_MUCH = 1.3
"""All torques of the model times this: what too much compensation does."""
Row = dict[str, Any]


def code() -> str:
    """Return a fingerprint of the code under test."""
    import fricmodels

    digest = hashlib.sha256(Path(__file__).read_bytes())
    for path in sorted(Path(fricmodels.__file__).parent.rglob("*.py")):
        if not {"cli", "report", "tournament", "readers", "export", "notebook"} & set(path.parts):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def figures_of(run: Any) -> Row:
    return {"rms": run.figures.rms_error, "limit_cycle": run.figures.limit_cycle, "counts": run.figures.rest_counts}


def trial(effect: str, index: int, seed: int, motions: int) -> Row:
    """Draw a rig whose hidden effect matters, identify it, and drive it along other motions."""
    from fricmodels.compensation import run_with, study
    from fricmodels.tracking import Experiment
    from hidden.draw import generator, mattering

    began = time.process_time()
    drawn = mattering(generator(seed, "compensation", effect, index), effect)
    if drawn is None:
        return {"status": "undrawn"}
    found = study(drawn.rig, motions=motions)
    first, model = found.experiments[0], found.models["improved"]
    modes = {}
    for title, how in MODES.items():
        other = Experiment(drawn.rig, first.settings.model_copy(update=how))
        modes[title] = {"once": figures_of(run_with(model, other))}
        if title in ROBUST:
            compensator = other.compensator(model.drive, model.parameters, model.document.rest_width)
            modes[title]["too much"] = figures_of(other.run(compensator.times(TOO_MUCH)))
    return {
        "status": "ok",
        "drive": drawn.rig.motion.value,
        "excitation": drawn.rig.excitation.kind,
        "size_percent": drawn.size_percent,
        "named": list(found.named),
        "verdict": found.verdict,
        "improved": found.models["improved"].name,
        "bandwidth_Hz": [one.bandwidth for one in found.experiments],
        "encoder_step": first.encoder_step,
        "ways": {
            way.name: {
                "rms": way.rms_error,
                "largest": way.largest_error,
                "limit_cycle": way.limit_cycle,
                "rest_counts": max((f.rest_counts for f in way.figures), default=None),
                "effort": max((f.rms_torque for f in way.figures), default=None),
                "each": [f.rms_error for f in way.figures],
                "message": way.message,
            }
            for way in found.ways
        },
        "modes": modes,
        "rig": drawn.rig.model_dump(mode="json"),
        "seconds": time.process_time() - began,
    }


def run(arguments: argparse.Namespace) -> list[Row]:
    """Run what is missing and return all rows."""
    from concurrent.futures import as_completed

    from pebble import ProcessPool

    path, fingerprint = Path(arguments.out), code()
    path.parent.mkdir(parents=True, exist_ok=True)
    rows: dict[str, Row] = {}
    if path.exists():
        stored = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
        rows = {row["key"]: row for row in stored if arguments.any_code or row["code"] == fingerprint}
    only = arguments.only or EFFECTS
    wanted = {f"{e}:{i}:{arguments.seed}": (e, i) for i in range(arguments.drives) for e in only}
    rows = {key: row for key, row in rows.items() if key in wanted}
    waiting = {key: job for key, job in wanted.items() if rows.get(key, {}).get("status", "failed") == "failed"}
    print(f"{len(wanted)} drives, {len(wanted) - len(waiting)} of them stored", flush=True)
    context = multiprocessing.get_context("spawn")
    if waiting and not arguments.no_run:
        with ProcessPool(arguments.jobs, context=context) as pool, path.open("a", encoding="utf-8") as file:
            futures = {
                pool.schedule(trial, args=[*job, arguments.seed, arguments.motions], timeout=LONGEST): key
                for key, job in waiting.items()
            }
            for done, future in enumerate(as_completed(futures), start=1):
                key = futures[future]
                try:
                    row = future.result()
                except Exception as error:
                    row = {"status": "failed", "message": f"{type(error).__name__}: {error}".splitlines()[0]}
                rows[key] = {"key": key, "code": fingerprint, "effect": waiting[key][0], **row}
                file.write(json.dumps(rows[key]) + "\n")
                file.flush()
                print(f"{done}/{len(waiting)} {key} {_short(rows[key])}", flush=True)
    return list(rows.values())


def _short(row: Row) -> str:
    if row["status"] != "ok":
        return f"{row['status']} {row.get('message', '')}"
    none = row["ways"]["none"]["rms"]
    shares = ", ".join(f"{n} {100 * w['rms'] / none:.3g}%" for n, w in row["ways"].items() if n != "none")
    cycles = [n for n, w in row["ways"].items() if w["limit_cycle"]]
    return f"{row['improved']}: {shares}{' LIMIT CYCLE ' + ','.join(cycles) if cycles else ''} ({row['seconds']:.0f} s)"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=3, help="drives of each effect (3)")
    parser.add_argument("--motions", type=int, default=2, help="motions of each drive (2)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", action="append", choices=EFFECTS, help="this effect (repeatable)")
    parser.add_argument("--out", default=str(ROOT / "runs" / "compensation.jsonl"))
    parser.add_argument("--any-code", action="store_true", help="use stored rows of other versions of the code too")
    parser.add_argument("--no-run", action="store_true", help="only print what is stored")
    parser.add_argument("--report", action="store_true", help="write the tables of docs/compensation.md")
    arguments = parser.parse_args()
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"))
    rows = run(arguments)
    if not any(row["status"] == "ok" for row in rows):
        return
    from compensation_figures import lines

    found = lines(rows)
    print("\n".join(found))
    if arguments.report:
        page = ROOT / "docs" / "compensation.md"
        text = page.read_text(encoding="utf-8")
        begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
        page.write_text(text[:begin] + "\n" + "\n".join(found) + "\n" + text[end:], encoding="utf-8")


if __name__ == "__main__":
    main()
