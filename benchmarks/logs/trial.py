"""One trial: a recording drawn and written, improved by the command line, and what came out."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from logs.case import Case
from logs.record import drawn, figures, options, write

Row = dict[str, Any]
BASE = "coulomb-viscous"
INTERRUPTED = 130
RUNNING: set[subprocess.Popen[str]] = set()
"""Commands at work, to end them when the benchmark is stopped."""


class Stopped(Exception):
    """The command was interrupted: there is no row."""


def recorded(case: Case, seed: int, folder: Path) -> tuple[Path, dict[str, float]]:
    """Write the log of a case into a folder; return the file, and sizes of what is in it."""
    log, path = drawn(case, seed), folder / f"{case.name}.csv"
    write(case, log, path)
    return path, figures(case, log)


def trial(case: Case, seed: int, folder: Path, longest: float) -> Row:
    """Run one trial; a command that fails, or that takes longer than so many seconds, is a row with its reason."""
    path, sizes = recorded(case, seed, folder)
    out = folder / case.name
    command = ["improve", str(path), "--model", BASE, "--out", str(out), *options(case)]
    row: Row = {"told": options(case), **sizes}
    began = time.perf_counter()
    code, errors = _run([sys.executable, "-m", "fricmodels", *command], longest)
    row["seconds"] = time.perf_counter() - began
    if code == INTERRUPTED:
        raise Stopped
    if code is None:
        return {"status": "failed", "message": f"no answer in {longest:.0f} s", **row}
    if code:
        lines = [line for line in errors.splitlines() if line.strip()]
        reason = next((line for line in lines if line.startswith("error")), lines[-1] if lines else "")
        return {"status": "failed", "message": f"exit code {code}: {reason}", **row}
    document = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    return {"status": "ok", **said(document), **row}


def said(document: Row) -> Row:
    """Return what a diagnosis says: names, whether the rest is unknown, and the errors of each model."""
    rest = document["remaining"] or {}
    names = [effect["class"] for effect in document["effects"]]
    return {
        "verdict": document["verdict"],
        "names": names,
        "unknown": document["verdict"] == "unknown-effect" or bool(rest),
        "remaining": rest.get("text", ""),
        "ladder": [[step["model"], step["held_out_rms_percent"]] for step in document["ladder"]],
        "floor_percent": document["noise_floor_percent"],
    }


def _run(command: list[str], longest: float) -> tuple[int | None, str]:
    """Return the exit code of a command and its standard error; no code where it was ended for taking too long."""
    one = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    process = subprocess.Popen(
        command, env={**os.environ, **one}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    RUNNING.add(process)
    try:
        errors = process.communicate(timeout=longest)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, ""
    finally:
        RUNNING.discard(process)
    return process.returncode, errors
