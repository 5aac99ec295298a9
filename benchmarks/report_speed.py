"""How long a report takes after the fits, and how large it is.

A tournament of 6 laws × 3 estimators × 4 recordings, and one of a recording of two million samples, each reported by
``fricmodels report DIR`` in a fresh process, imports and reading of the recordings included; then the report on a
ladder on the same two million samples, the fits and tests of effects apart. Every report is written three times; the
three must be the same bytes. Run: ``python benchmarks/report_speed.py``.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fricmodels.tournament.demonstration import LAWS

TRUE = {"K_v1": 1.0e-4, "K_v2": 6.6e-5, "K_c1": 1.0e-2, "K_c2": 6.6e-3}
INERTIA = 4.87e-6
LONG = 2_000_000


def record(path: Path, samples: int, seed: int) -> Path:
    """Write a recording of a motor with cogging under a torque of several frequencies."""
    import pandas as pd

    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.simulation import simulate

    rng = np.random.default_rng(seed)
    time_s = 1e-3 * np.arange(samples)
    phases = 2 * np.pi * np.outer([0.37, 0.9, 2.3], time_s) + rng.uniform(0, 6, (3, 1))
    torque = 0.012 * np.sin(phases).sum(axis=0)
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), INERTIA)
    velocity = simulate(drive, {"J": INERTIA, **TRUE}, time_s, torque).velocity
    position = np.concatenate([[0.0], np.cumsum(0.5e-3 * (velocity[1:] + velocity[:-1]))])
    torque = torque + 1e-3 * np.cos(5 * position)
    velocity = velocity + 0.005 * np.sqrt(np.mean(velocity**2)) * rng.standard_normal(samples)
    frame = pd.DataFrame({"time_s": time_s, "torque_Nm": torque, "velocity_rad_s": velocity, "position_rad": position})
    frame.to_parquet(path)
    return path


def tournament(folder: Path, files: list[Path], models: list[str], estimators: list[str]) -> Path:
    """Run a tournament and return its folder."""
    from fricmodels.tournament import run
    from fricmodels.tournament.config import Config

    datasets = [{"name": file.stem, "files": str(file), "inertia": INERTIA} for file in files]
    content = {"name": folder.name, "datasets": datasets, "models": models, "estimators": estimators}
    board = run(Config.model_validate({**content, "simulate": False}), folder, processes=2)
    print(f"  {len(board.rows)} fits, {len(board.failures)} without a result")
    return folder


def fastest(what: str, make: Callable[[Path], None], folder: Path) -> None:
    """Print the fastest and the slowest of three, and the size."""
    seconds, contents = [], set()
    for i in range(3):
        page = folder / f"page{i}.html"
        begin = time.perf_counter()
        make(page)
        seconds.append(time.perf_counter() - begin)
        contents.add(page.read_bytes())
    assert len(contents) == 1, "the same results give the same bytes"
    print(f"{what}: {min(seconds):.1f} to {max(seconds):.1f} s, {len(contents.pop()) / 1e6:.1f} MB")


def by_command(run: Path) -> Callable[[Path], None]:
    command = [sys.executable, "-m", "fricmodels", "report", str(run), "--out"]
    return lambda page: subprocess.run([*command, str(page)], check=True, capture_output=True) and None


def main() -> None:
    from fricmodels.diagnosis import improve
    from fricmodels.model import Model
    from fricmodels.readers import read
    from fricmodels.report import story, write

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = [record(folder / f"motor{i}.parquet", 20_000, i) for i in range(4)]
        many = tournament(folder / "many", files, LAWS, ["rls", "batch", "constant-velocity"])
        fastest("6 laws × 3 estimators × 4 recordings of 20 000 samples", by_command(many), folder)
        long = record(folder / "long.parquet", LONG, 9)
        single = tournament(folder / "single", [long], LAWS[:2], ["rls"])
        fastest("tournament on 2 million samples", by_command(single), folder)
        begin = time.perf_counter()
        ladder = improve(read(long), Model.parse("coulomb-viscous"), INERTIA)
        print(f"  improve: {time.perf_counter() - begin:.1f} s, to {ladder.rungs[-1].model}")

        def of_ladder(page: Path) -> None:
            write(story.of_ladder(ladder), page)

        fastest("ladder on 2 million samples (the slowest is the first, from scratch)", of_ladder, folder)


if __name__ == "__main__":
    main()
