"""Whether a diagnosis says the same on every processor, and of a recording whose last digits are others.

Recordings of the hidden-effect challenge are diagnosed with the OpenBLAS kernels of several processors, each in a
process of its own, and once more with every sample changed by a relative 1e-9. With ``--challenge rough`` they are of
drives whose sensors have noise and steps, as real ones have. What is compared is what is printed: the verdict, the
names in their order, and every number with the digits shown.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from hidden.draw import EFFECTS, generator

if TYPE_CHECKING:
    from fricmodels.recording import Recording

ROOT = Path(__file__).resolve().parent.parent
KERNELS = ("Haswell", "SkylakeX", "Zen", "Sandybridge")
UNSET, CHANGED = "unset", "changed by 1e-9"
NOTHING = "nothing"
FEW = ("presliding", "backlash", "joint-compliance", "frictional-lag", "rising-stiction")
"""Drawn first: effects with memory, whose parameters are searched for."""
_EACH = (*FEW, NOTHING, *(effect for effect in EFFECTS if effect not in FEW), NOTHING, NOTHING)
ROUNDS = {"hidden": (NOTHING, *_EACH), "rough": ("several", *_EACH)}
"""What is hidden in turn in the recordings of each challenge."""
CHANGE = 1e-9
Row = dict[str, Any]
Given = tuple["Recording", str, float | None]


def drawn(folder: Path, challenge: str, count: int, seed: int) -> Iterator[tuple[str, Path]]:
    """Yield names and files of the first recordings of a challenge, drawn where they are not stored."""
    of = {"hidden": _of_the_rig, "rough": _rough}[challenge]
    for place in range(count):
        kind = ROUNDS[challenge][place % len(ROUNDS[challenge])]
        name = f"{kind}-{place}"
        path = folder / f"{challenge}-{seed}-{name}.npz"
        if not path.exists():
            recording, law, inertia = of(kind, place, seed)
            told = {"law": law, "inertia": inertia, "motion": recording.motion.value}
            channels = {f"_{key}": values for key, values in recording.channels.items()}
            np.savez(path, run=recording.run, of=json.dumps(told), **channels)
        yield name, path


def _of_the_rig(effect: str, place: int, seed: int) -> Given:
    """Return a recording of the hidden-effect challenge, the law of its drive, and its inertia."""
    from fricmodels.errors import FricmodelsError
    from fricmodels.rig import random_rig

    rng = generator(seed, "processors", effect, place, place // len(ROUNDS["hidden"]))
    while True:
        try:
            rig = random_rig(rng, [] if effect == NOTHING else [effect])
            return rig.simulate(), rig.friction.law, rig.inertia
        except (FricmodelsError, ValueError):  # a drive that is stuck or runs away
            continue


def _rough(kind: str, place: int, seed: int) -> Given:
    """Return a recording of the rough drives, the law that is given, and the inertia where it is told."""
    from rough.record import record
    from rough.trials import BASE, case_of

    what, name = ("null", "") if kind == NOTHING else (kind, "") if kind == "several" else ("single", kind)
    case = case_of(what, name, place, seed)[0]
    return record(case), BASE, case.inertia


def answer(path: Path, *, change: float = 0.0, ladder: bool = False) -> Row:
    """Return what is said of a stored recording: verdict, names, and the printed lines.

    Args:
        path: of the recording.
        change: by which every sample but the time is changed, relative, uniformly between plus and minus.
        ladder: whether effects are added until nothing is missing.
    """
    from rich.console import Console

    from fricmodels.diagnosis import diagnose, improve
    from fricmodels.diagnosis.present import show_diagnosis, show_ladder, show_parameters
    from fricmodels.dimension import Motion
    from fricmodels.errors import FricmodelsError
    from fricmodels.model import Model
    from fricmodels.recording import Recording
    from fricmodels.results.words import noise_text

    rng = np.random.default_rng(1)
    with np.load(path) as data:
        of = json.loads(str(data["of"]))
        run = data["run"]
        channels = {key[1:]: data[key] for key in data.files if key.startswith("_")}
    for name in channels if change else ():
        if name != "time":
            channels[name] = channels[name] * (1 + change * rng.uniform(-1, 1, len(run)))
    recording = Recording(path.stem, Motion(of["motion"]), channels, run)
    console = Console(file=io.StringIO(), width=160)
    try:
        if ladder:
            climbed = improve(recording, Model.parse(of["law"]), of["inertia"])
            diagnosis = climbed.last
            names = [f"with {r.added}" if r.added else f"without {r.removed}" for r in climbed.rungs[1:]]
            show_ladder(console, climbed)
        else:
            diagnosis = diagnose(recording, Model.parse(of["law"]), of["inertia"])
            names = [name for finding in diagnosis.findings for name in finding.names]
    except FricmodelsError as error:
        return {"verdict": "refused", "names": [], "lines": [str(error)]}
    comparison = diagnosis.comparison
    errors = comparison.errors
    noise = noise_text(comparison.noise_floor_percent)
    shown = f"{errors.SI:.3g} {errors.percent:.3g} {errors.held_out_percent:.3g} {noise}"
    console.print(f"errors {shown}")
    show_parameters(console, comparison)
    show_diagnosis(console, diagnosis)
    lines = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    words = [" ".join(line.split()) for line in lines if set(line) - set(" ─━")]  # rules are as wide as the numbers
    return {"verdict": diagnosis.verdict, "names": names, "lines": words}


def answers(kernel: str, paths: list[Path], *, ladder: bool) -> Iterator[Row]:
    """Yield the answers for recordings, from a process with the OpenBLAS kernels of a processor."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    environment.pop("OPENBLAS_CORETYPE", None)
    if kernel in KERNELS:
        environment["OPENBLAS_CORETYPE"] = kernel
    command = [sys.executable, __file__, "--answer", kernel, *(["--improve"] if ladder else [])]
    with subprocess.Popen(
        command, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        for path in paths:
            process.stdin.write(f"{path}\n")
            process.stdin.flush()
            yield dict(json.loads(process.stdout.readline()))
        process.stdin.close()


def difference(first: Row, other: Row) -> tuple[str, list[str]]:
    """Return in what two answers differ, ``verdict``, ``names`` or ``digits``, and where; both empty if in nothing."""
    for kind in ("verdict", "names"):
        if first[kind] != other[kind]:
            return kind, [f"{first[kind]} | {other[kind]}"]
    where = [f"{a} | {b}" for a, b in zip(first["lines"], other["lines"], strict=False) if a != b]
    if len(first["lines"]) != len(other["lines"]):
        where.append("more lines")
    return ("digits" if where else ""), where


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--recordings", type=int, default=208, help=f"how many; {len(_EACH) + 1} are one of each effect"
    )
    parser.add_argument("--challenge", choices=ROUNDS, default="hidden")
    parser.add_argument("--begin", type=int, default=0, help="leave out so many of them")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--improve", action="store_true", help="compare whole ladders")
    parser.add_argument("--only", action="append", choices=(UNSET, *KERNELS, CHANGED), help="beside unset (repeatable)")
    parser.add_argument("--every-line", action="store_true", help="print all lines that differ, not the first alone")
    parser.add_argument("--out", default=str(ROOT / "runs" / "processors"), help="where recordings are stored")
    parser.add_argument("--answer", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.answer:
        for line in sys.stdin:
            change = CHANGE if arguments.answer == CHANGED else 0.0
            row = answer(Path(line.strip()), change=change, ladder=arguments.improve)
            print(json.dumps(row), flush=True)
        return
    folder = Path(arguments.out)
    folder.mkdir(parents=True, exist_ok=True)
    stored = list(drawn(folder, arguments.challenge, arguments.recordings, arguments.seed))[arguments.begin :]
    paths = [path for _, path in stored]
    cases = [case for case in (*KERNELS, CHANGED) if not arguments.only or case in arguments.only]
    runs = [answers(case, paths, ladder=arguments.improve) for case in (UNSET, *cases)]
    began, count = time.perf_counter(), dict.fromkeys(cases, 0)
    for done, (name, _) in enumerate(stored, 1):
        first, *others = (next(run) for run in runs)
        for case, other in zip(cases, others, strict=True):
            kind, where = difference(first, other)
            if kind:
                count[case] += 1
                print(f"{name}, {case}: {kind} differ: {where[0]}", flush=True)
                for line in where[1:] if arguments.every_line else ():
                    print(f"    {line}", flush=True)
        left = (time.perf_counter() - began) / done * (len(stored) - done)
        print(f"{done}/{len(stored)} {name} {first['verdict']} {first['names']}  {left / 60:.1f} min left", flush=True)
    for case in cases:
        print(f"{case}: {len(stored) - count[case]} of {len(stored)} recordings the same")


if __name__ == "__main__":
    main()
