"""How it goes with many fits, many rows and long recordings, each as a ratio or a bound measured in one run.

1. 2 000 fits by one and by two worker processes: how much sooner two end.
2. What a job costs beside its fit, and whether 10, 1 000 and 100 000 jobs cost alike, in time and in memory.
3. 100 000 rows exported in every format, and a board of many datasets ranked per dataset.
4. Long recordings fitted, scored and diagnosed: seconds and peak memory for 1 and for 10 million samples.
5. From Parquet to parameters by sums: samples a second, beside reading alone; ten files added, against one.

Run: ``python benchmarks/scale.py [--only workers|jobs|export|samples|sums] [--quick]``.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

MOTOR = {
    "model": "coulomb-viscous",
    "parameters": {"K_v": 1e-4, "K_c": 1e-2},
    "inertia": 4.87e-6,
    "amplitude": 0.03,
    "frequency": 39.54,
    "noise_percent": 2,
}


def config(seeds: int, **motor: Any) -> Any:
    """Return a tournament of so many recordings, each fitted once."""
    from fricmodels.tournament.config import Config

    datasets = [{"name": "motor", "simulate": {**MOTOR, "seeds": seeds, **motor}}]
    content = {"datasets": datasets, "models": "coulomb-viscous", "estimators": "batch", "simulate": False}
    return Config.model_validate(content)


def workers(quick: bool) -> None:
    """Time the same fits by one and by two processes, one after the other, starts of processes included.

    The ratio of seconds says how the machine was, too: on a busy one see what both cost in CPU. What two processes cost
    beyond one, and what the planning process does alone, is all that keeps two quiet cores from twice the speed.
    """
    from fricmodels.tournament import run

    fits = 200 if quick else 2000
    taken, cost, alone = {}, {}, {}
    for processes in (1, 2):
        with tempfile.TemporaryDirectory() as folder:
            begin, before = time.perf_counter(), _cpu()
            board = run(config(fits), folder, processes=processes)
            taken[processes], after = time.perf_counter() - begin, _cpu()
            alone[processes], cost[processes] = after[0] - before[0], sum(after) - sum(before)
            assert not board.failures
    load = os.getloadavg()[1]
    print(f"{fits} fits: {taken[1]:.1f} s by one process, {taken[2]:.1f} s by two: {taken[1] / taken[2]:.2f} times "
          f"(load of the machine {load:.1f} on {os.cpu_count()} cores)")  # fmt: skip
    possible = cost[1] / max(cost[2] / 2, alone[2])
    print(f"CPU: {cost[1]:.1f} s by one process, {cost[2]:.1f} s by two, {alone[2]:.1f} s of it by the one that plans "
          f"({1e3 * alone[2] / fits:.2f} ms a fit); on two quiet cores at most {possible:.2f} times")  # fmt: skip


def _cpu() -> tuple[float, float]:
    """Return the CPU seconds of this process, and of those that it started and that have ended."""
    own, others = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime, others.ru_utime + others.ru_stime


def peak() -> float:
    """Return the most memory of this process so far [GB].

    Of its own program: what ``getrusage`` says may be that of the process which started it.
    """
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1e6


def _nothing(job: Any) -> dict[str, Any]:
    """Return the row of a job that took no time, in the place of a fit."""
    from fricmodels.fit import Status

    row = job.row(Status.OK, seconds=0.0)
    row.update(rms_torque_error_percent=1.0, held_out_rms_torque_error_percent=1.0)
    return dict(row)


def jobs(quick: bool) -> None:
    """Time what is done for a job beside its fit: planning, keeping, ranking, writing; each number of jobs apart."""
    for count in (10, 1000, 10_000 if quick else 100_000):
        code = f"import scale; scale.only_overhead({count})"
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=Path(__file__).parent, capture_output=True, text=True, check=True
        )
        print(done.stdout.strip())


def only_overhead(count: int) -> None:
    """Run a tournament of jobs that take no time; print milliseconds and kilobytes a job."""
    from fricmodels.tournament import execution, plan, run

    plan(config(1))
    vars(execution)["execute"] = _nothing
    before, least = resource.getrusage(resource.RUSAGE_SELF), peak()
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        run(config(count), folder, executor="serial")
        wall = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_SELF)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    memory = 1e6 * (peak() - least) / count
    print(f"{count} jobs: {1e3 * wall / count:.2f} ms each beside the fit ({1e3 * cpu / count:.2f} ms of CPU), "
          f"{memory:.1f} kB each, {peak():.2f} GB in all")  # fmt: skip


def export(quick: bool) -> None:
    """Time every format of a large board, of 20 datasets."""
    from fricmodels.export import export as exported
    from fricmodels.export.columns import tables
    from fricmodels.tournament.leaderboard import Leaderboard

    count = 10_000 if quick else 100_000
    rows = [_row(number) for number in range(count)]
    board = Leaderboard.ranked(rows)
    for form in ("csv", "json", "parquet", "md", "html", "latex"):
        begin = time.process_time()
        content = exported(board, form)
        print(f"{count} rows as {form}: {time.process_time() - begin:.2f} s of CPU, {len(content) / 1e6:.1f} MB")
    titles = [table.title for table in tables(Leaderboard.ranked(rows[:2000]), 3, None)]
    print(f"tables of a board of 20 datasets: {len(titles)}, the first called '{titles[0]}'")


def _row(number: int) -> dict[str, Any]:
    error = (number * 7919 % 10_007) / 100
    return {
        "model": f"coulomb-viscous+effect{number % 7}", "estimator": "batch", "dataset": f"arm{number % 20}",
        "tags": {"seed": number // 20}, "rms_torque_error_percent": error,
        "held_out_rms_torque_error_percent": error + 0.5, "rms_torque_error_band_ms": None,
        "rms_torque_error_bands": [], "parameters": {"K_v": 1e-4, "K_c": 1e-2},
        "standard_errors": {"K_v": 1e-6, "K_c": 1e-5}, "true_parameters": None, "seconds": 0.1, "status": "ok",
        "message": "", "not_identified": {}, "no_interval": {}, "settings": {}, "key": str(number),
    }  # fmt: skip


def samples(quick: bool) -> None:
    """Fit, score and diagnose long recordings, each by commands of their own; print seconds and peak memory."""
    for count in (100_000, 1_000_000) if quick else (1_000_000, 10_000_000):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "arm.parquet"
            _arm(path, count)
            model = [str(path), "--model", "coulomb-viscous", "--inertia", "0.05"]
            for command in (
                ["fit", *model, "--out", f"{folder}/arm.model.json"],
                ["compare", *model],
                ["diagnose", *model],
            ):
                code = f"import scale; scale.measured({json.dumps(command)})"
                done = subprocess.run(
                    [sys.executable, "-c", code], cwd=Path(__file__).parent, capture_output=True, text=True, check=True
                )
                print(f"{count} samples, {command[0]}: {done.stderr.strip().splitlines()[-1]}", flush=True)


def measured(command: list[str]) -> None:
    """Run a command here; say on standard error what it took."""
    from fricmodels.cli import _run

    code = _run(command)
    used = resource.getrusage(resource.RUSAGE_SELF)
    print(
        f"{used.ru_utime + used.ru_stime:.1f} s of CPU, {peak():.2f} GB, exit code {code}",
        file=sys.stderr,
    )


def _arm(path: Path, count: int) -> None:
    import numpy as np
    import pandas as pd

    time_s = 0.001 * np.arange(count)
    parts = [(0.31, 4.0), (0.77, 3.0), (1.43, 2.0)]
    velocity = sum(a * np.sin(6.283185307179586 * f * time_s) for f, a in parts)
    slope = sum(a * 6.283185307179586 * f * np.cos(6.283185307179586 * f * time_s) for f, a in parts)
    torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity)
    noisy = velocity + 0.01 * np.random.default_rng(1).standard_normal(count)
    pd.DataFrame({"time_s": time_s, "torque_Nm": torque, "velocity_rad_s": noisy}).to_parquet(path)


def sums(quick: bool) -> None:
    """Time sums of a linear law from Parquet, all on one thread; compare ten files added with one of ten runs."""
    import pandas as pd
    import pyarrow
    import pyarrow.parquet

    from fricmodels import sums as made

    pyarrow.set_cpu_count(1)
    count = 1_000_000 if quick else 10_000_000
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.parquet"
        _arm(path, count)
        begin = time.process_time()
        with pyarrow.parquet.ParquetFile(path) as file:
            for batch in file.iter_batches(columns=["time_s", "torque_Nm", "velocity_rad_s"], use_threads=False):
                for column in batch.columns:
                    column.to_numpy().sum()
        print(f"{count} samples read alone: {count / (time.process_time() - begin) / 1e6:.1f} M samples/s")
        begin = time.process_time()
        plan = made.plan_for(made.pilot(path), "coulomb-viscous")
        print(f"plan from a part of it: {time.process_time() - begin:.1f} s of CPU, once")
        for model in ("coulomb-viscous", "asymmetric-coulomb-viscous"):
            own = plan if model == plan.model else made.plan_for(made.pilot(path), model)
            made.of_file(path, own)
            rates = []
            for _ in range(3):
                begin = time.process_time()
                found = made.solved(made.of_file(path, own))
                rates.append(count / (time.process_time() - begin) / 1e6)
            print(f"from Parquet to parameters, {model}: {sorted(rates)[1]:.1f} M samples/s of CPU (three times: "
                  f"{', '.join(f'{rate:.1f}' for rate in rates)}); {len(made.of_file(path, own).to_json())} bytes; "
                  f"{ {key: round(value, 6) for key, value in found.parameters.items()} }")  # fmt: skip
        table = pd.read_parquet(path)
        table["run"] = table.index * 10 // count
        table.to_parquet(path)
        whole = made.solved(made.of_file(path, plan))
        each = []
        for number, part in table.groupby("run"):
            part.drop(columns="run").to_parquet(Path(folder) / f"{number}.parquet")
            each.append(made.of_file(Path(folder) / f"{number}.parquet", plan))
        merged = made.solved(made.added(each))
        apart = max(abs(merged.parameters[key] / value - 1) for key, value in whole.parameters.items())
        print(f"ten files added against one file of ten runs: parameters differ by {apart:.1e}")
        code = f"import scale; scale.summed({str(path)!r})"
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=Path(__file__).parent, capture_output=True, text=True, check=True
        )
        print(f"memory of the sums of a file of {count} samples: {done.stdout.strip()}")


def summed(path: str) -> None:
    """Make a plan and sums of a file here; say how much memory that took."""
    from fricmodels import sums as made

    made.of_file(path, made.plan_for(made.pilot(path), "coulomb-viscous"))
    print(f"{peak():.2f} GB")


PARTS = {"workers": workers, "jobs": jobs, "export": export, "samples": samples, "sums": sums}


def main() -> None:
    """Measure all parts, or one."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--only", choices=[*PARTS])
    parser.add_argument("--quick", action="store_true", help="a tenth of everything")
    given = parser.parse_args()
    for name, part in PARTS.items():
        if given.only in (None, name):
            part(given.quick)


if __name__ == "__main__":
    main()
