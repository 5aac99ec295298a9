"""The bench of the source: its physics, and the error of M1 to M6 on measured logs beside the published one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fricmodels_bam import LAWS, CoulombViscous, LoadDependent
from fricmodels_bam.bench import GRAVITY, LENGTH, MASS, STEP, Bench, Log, read_logs
from fricmodels_bam.identify import identify
from fricmodels_bam.published import XL330

LOGS = Path(__file__).parents[4] / "shared" / "data" / "bam_xl330" / "xl330_pendulum_16logs.csv"
MOTOR = {"k_t": 0.38, "R": 3.6, "armature": 0.002, "q_offset": 0.0}


def log(goal: float, *, start: float, on: bool, samples: int = 1200, gain: int = 400) -> Log:
    """Return a log with one goal."""
    inputs = np.tile([goal, float(on), float(gain), 7.4], (samples, 1))
    return Log("goal", gain, np.full(samples, start), 0.0, inputs)


def test_a_free_pendulum_swings_at_its_own_frequency() -> None:
    """Without friction, by the formula of small angles."""
    bench = Bench(CoulombViscous)
    position = bench.positions(log(0.0, start=0.02, on=False), {**MOTOR, "K_v": 0.0, "K_c": 0.0})
    inertia = MASS * LENGTH**2 + MOTOR["armature"]
    period = 2 * np.pi * np.sqrt(inertia / (MASS * GRAVITY * LENGTH))
    down = np.flatnonzero((position[:-1] > 0) & (position[1:] <= 0))
    assert np.mean(np.diff(down)) * STEP == pytest.approx(period, rel=0.01)


def test_friction_holds_a_load_below_it() -> None:
    """Switched off, the pendulum stays where gravity is less than the dry friction."""
    bench = Bench(CoulombViscous)
    torque = MASS * GRAVITY * LENGTH * np.sin(0.3)
    held = bench.positions(log(0.0, start=0.3, on=False), {**MOTOR, "K_v": 0.0, "K_c": 1.01 * torque})
    let_go = bench.positions(log(0.0, start=0.3, on=False), {**MOTOR, "K_v": 0.0, "K_c": 0.9 * torque})
    assert np.ptp(held) == 0.0
    assert let_go[-1] < 0.29


def test_load_friction_keeps_the_servo_behind_its_goal() -> None:
    """While the goal rises slowly, friction adds to the load and the position lags by more."""
    rising = log(0.0, start=0.0, on=True)
    rising.inputs[:, 0] = np.linspace(0.0, 1.2, len(rising.inputs))
    ends = [
        Bench(LoadDependent).positions(rising, {**MOTOR, "K_v": 0.005, "K_c": 0.01, "K_l": share})[-1]
        for share in (0.0, 0.1, 0.2)
    ]
    assert 0.0 < ends[2] < ends[1] < ends[0] < 1.2


def test_identified_from_simulated_logs() -> None:
    """Positions of a servo with load friction: M3 explains them, M1 and M2 cannot."""
    truth = XL330["bam-m3"].values
    logs = []
    for gain in (200, 800):
        time = np.arange(1200) * STEP
        goal = np.sin(time) + 0.5 * np.sin(2.7 * time)
        inputs = np.column_stack([goal, np.ones_like(time), np.full_like(time, gain), np.full_like(time, 7.4)])
        blank = Log("sines", gain, np.zeros(1200), 0.0, inputs)
        logs.append(Log("sines", gain, Bench(LoadDependent).positions(blank, truth), 0.0, inputs))
    found = identify(logs, evaluations=100)
    error = {law.name: Bench(law).error(logs, found[law.name]) for law in LAWS}
    assert error["bam-m3"] < 0.2 * min(error["bam-m1"], error["bam-m2"])
    assert found["bam-m3"]["K_l"] == pytest.approx(truth["K_l"], rel=0.1)


@pytest.mark.measured
@pytest.mark.skipif(not LOGS.is_file(), reason="../shared/data/bam_xl330 is not there")
@pytest.mark.long
def test_what_helps_on_the_measured_servo_is_what_the_authors_found() -> None:
    """Published for the XL-330, change from M1: M2 −0.1 %, M3 −26 %, M4 −29 %, M5 −32 %, M6 −31 %."""
    logs = read_logs(LOGS)
    assert len(logs) == 16
    found = identify(logs)
    error = {law.name: Bench(law).error(logs, found[law.name]) for law in LAWS}
    change = {name: error[name] / error["bam-m1"] - 1 for name in error}
    published = {name: XL330[name].error / XL330["bam-m1"].error - 1 for name in error}
    assert abs(change["bam-m2"]) < 0.02
    for name in ("bam-m3", "bam-m4", "bam-m5", "bam-m6"):
        assert change[name] == pytest.approx(published[name], abs=0.10)
    transferred = {law.name: Bench(law).error(logs, XL330[law.name].values) for law in LAWS}
    assert transferred["bam-m3"] < 0.9 * transferred["bam-m1"]
    assert 0.95 < transferred["bam-m2"] / transferred["bam-m1"] < 1.05
