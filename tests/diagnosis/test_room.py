"""What a diagnosis needs of memory: some bytes a sample, and no more of them than were measured (docs/fleet.md)."""

from __future__ import annotations

import gc
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from fricmodels.arrays import Array
from fricmodels.diagnosis.comparison import Comparison, compare_fit, kept_back
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report.figures import against
from fricmodels.score import balance, torque
from fricmodels.signals import lanczos
from fricmodels.weakform.prepared import ready

INERTIA, VISCOUS, COULOMB = 0.05, 0.1, 0.4


def arm(count: int) -> dict[str, np.ndarray]:
    """Return time, torque and velocity of a joint at 1 kHz that a model explains but for the noise of its velocity."""
    time = 0.001 * np.arange(count)
    velocity, slope = np.zeros(count), np.zeros(count)
    for omega, amplitude in ((1.95, 4.0), (4.84, 3.0), (8.98, 2.0)):
        velocity += amplitude * np.sin(omega * time)
        slope += amplitude * omega * np.cos(omega * time)
    torque = INERTIA * slope + VISCOUS * velocity + COULOMB * np.sign(velocity)
    velocity += 0.01 * np.random.default_rng(1).standard_normal(count)
    return {"time": time, "torque": torque, "velocity": velocity}


def compared(count: int) -> Comparison:
    recording = Recording("arm", Motion.ROTARY, arm(count), np.zeros(count, dtype=np.int64))
    train, test = kept_back(ready(recording))
    drive = Drive(Model.of("coulomb-viscous"), INERTIA)
    return compare_fit(train, test, drive, {"K_v": VISCOUS, "K_c": COULOMB}, {})


def bytes_a_sample(work: Callable[[Comparison], Any], few: Comparison, many: Comparison) -> float:
    """Return by how many bytes for each further sample the most grows that some work holds at a time."""

    def most(one: Comparison) -> int:
        gc.collect()
        tracemalloc.start(1)
        try:
            work(one)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    first, last = most(few), most(many)
    return (last - first) / (len(many.train) + len(many.test) - len(few.train) - len(few.test))


def test_bytes_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    for module, name in ((balance, "_BLOCK"), (torque, "_INTERVALS"), (against, "_BLOCK"), (lanczos, "_AT_ONCE")):
        monkeypatch.setattr(module, name, 1 << 12)
    few, many = compared(40_000), compared(100_000)

    def filtered(one: Comparison) -> Array:
        return torque.filtered_torque_error(one.drive, one.estimate.parameters, one.train, 7)

    assert bytes_a_sample(filtered, few, many) < 42  # 30; 50 with the friction of whole stretches at once
    assert bytes_a_sample(lambda one: against.error_over(one, "velocity"), few, many) < 65  # 50; 120 by whole channels


_MEASURED = """
import sys
from pathlib import Path
from fricmodels.cli import _run
assert _run(sys.argv[1:]) == 0
print("peak", Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0], file=sys.stderr)
"""


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="the system says there how much memory a program had")
def test_a_long_recording_is_diagnosed_in_little_memory(tmp_path: Path) -> None:
    path, peaks = tmp_path / "arm.parquet", {}
    for count in (1_000_000, 3_000_000):
        pd.DataFrame(arm(count)).set_axis(["time_s", "torque_Nm", "velocity_rad_s"], axis=1).to_parquet(path)
        command = ["diagnose", str(path), "--model", "coulomb-viscous", "--inertia", str(INERTIA)]
        done = subprocess.run(
            [sys.executable, "-c", _MEASURED, *command], capture_output=True, text=True, check=True, timeout=600
        )
        peaks[count] = 1000 * int(done.stderr.rpartition("peak")[2])
    assert peaks[1_000_000] < 1.05e9  # 0.93
    assert peaks[3_000_000] - peaks[1_000_000] < 2_000_000 * 190  # what is 2.6 GB for ten million
