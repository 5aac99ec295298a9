"""The firmware as what drives a simulation: it is the source's bench, without the errors of its steps."""

from __future__ import annotations

import numpy as np
import pytest
from fricmodels_bam.bench import LENGTH, MASS, STEP, Bench, Log
from fricmodels_bam.firmware import ENABLED, GAIN, GOAL, IDLE, SUPPLY, Firmware, SaggingSupply
from fricmodels_bam.m3 import LoadDependent
from fricmodels_bam.published import XL330

from fricmodels import Recording
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.loop import Loop
from fricmodels.model import Model
from fricmodels.motion import Simulator


def swung(supply: float = 7.3) -> tuple[Log, Recording]:
    """Goals that lift the pendulum and let it go, as a log and as a recording."""
    time = np.arange(800) * STEP
    goal, on = 0.8 * np.sin(2.0 * time), np.where(time < 3.0, 1.0, 0.0)
    inputs = np.column_stack([goal, on, np.full(800, 400.0), np.full(800, supply)])
    still = np.zeros(800)
    channels = {"time": time, "torque": still, "position": still, "velocity": still}
    channels |= {GOAL: goal, ENABLED: on, GAIN: inputs[:, 2], SUPPLY: inputs[:, 3], IDLE: inputs[:, 3]}
    log = Log("swung", 400, still, 0.0, inputs)
    return log, Recording("swung", Motion.ROTARY, channels, np.zeros(800, dtype=np.int64))


def simulated(loop: Loop, recording: Recording, **more: float) -> np.ndarray:
    """Return the position with published parameters of M3."""
    known = dict(XL330["bam-m3"].values)
    values = {"J": MASS * LENGTH**2 + known.pop("armature"), **more}
    values |= {f"loop.{key}" if key in ("k_t", "R", "q_offset") else key: value for key, value in known.items()}
    return Simulator(Drive(Model(LoadDependent())), recording, loop=loop, initial_samples=1)(values)[0]


def test_the_firmware_moves_the_pendulum_as_the_bench_does() -> None:
    """To within what the explicit steps of the bench cost."""
    log, recording = swung()
    bench = Bench(LoadDependent).positions(log, XL330["bam-m3"].values)
    own = simulated(Firmware(), recording)
    assert np.ptp(own) > 0.8
    # The bench steps explicitly by 5 ms; where it stops and starts the two differ by that.
    assert np.mean(np.abs(own[:-1] - bench[1:])) < 0.02


def test_a_supply_without_resistance_does_not_sag() -> None:
    """And one with a resistance moves less."""
    _, recording = swung()
    stiff = simulated(Firmware(), recording)
    assert np.max(np.abs(simulated(SaggingSupply(), recording, **{"loop.rho": 0.0}) - stiff)) < 1e-12
    assert np.max(np.abs(simulated(SaggingSupply(), recording, **{"loop.rho": 1.0}))) < np.max(np.abs(stiff))


@pytest.mark.parametrize("loop", [Firmware(), SaggingSupply()])
def test_the_pendulum_hangs_at_rest_while_the_goal_is_there(loop: Loop) -> None:
    """Nothing moves by itself."""
    _, recording = swung()
    still = recording.with_channels(**{GOAL: np.zeros(800)})
    assert np.max(np.abs(simulated(loop, still, **{"loop.rho": 0.3}))) < 1e-12
