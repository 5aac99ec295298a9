"""Recordings that are extreme and valid: other units by seventy decades, gigahertz, epoch stamps, whole nanoseconds.

The physics is the same in all of them, and so is the answer, to rounding.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.readers import read
from fricmodels.recording import Recording

INERTIA = 0.05
TRUTH = {"K_v": 0.1, "K_c": 0.4}
SAMPLES = 3000
STEP = 2.0**-8
ESTIMATORS = ("batch", "rls")
DRIVE = Drive(Model.parse("coulomb-viscous"), INERTIA)


def motion() -> Recording:
    time = STEP * np.arange(SAMPLES)
    velocity = 3.0 * np.sin(2.1 * time) + 1.5 * np.sin(5.3 * time)
    slope = 6.3 * np.cos(2.1 * time) + 7.95 * np.cos(5.3 * time)
    noisy = velocity + 0.01 * np.random.default_rng(1).standard_normal(SAMPLES)
    torque = INERTIA * slope + TRUTH["K_v"] * velocity + TRUTH["K_c"] * np.sign(velocity)
    channels = {"time": time, "velocity": noisy, "torque": torque}
    return Recording("arm", DRIVE.motion, channels, np.zeros(SAMPLES, dtype=np.int64))


def answer(recording: Recording, drive: Drive, estimator: str) -> list[float]:
    fit = load().estimators[estimator]().fit(drive, recording)
    assert fit.status == "ok", fit.message
    return [fit.parameters[key] for key in drive.keys] + [fit.standard_errors[key] for key in drive.keys]


def alike(found: Any, estimator: str) -> None:
    """Values are the same to rounding; standard errors change by up to a tenth and a little with the unit of time."""
    np.testing.assert_allclose(found[:2], expected(estimator)[:2], rtol=1e-6)
    np.testing.assert_allclose(found[2:], expected(estimator)[2:], rtol=2e-1)


@cache
def expected(estimator: str) -> list[float]:
    return answer(motion(), DRIVE, estimator)


LENGTHS = [pytest.param(4, id="short"), pytest.param(60, id="long", marks=pytest.mark.long)]


@pytest.mark.parametrize("examples", LENGTHS)
@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_the_size_of_units_does_not_matter(estimator: str, examples: int) -> None:
    powers = st.integers(-240, 240)

    @settings(max_examples=examples, deadline=None, database=None, derandomize=examples < 10,
              suppress_health_check=[*HealthCheck], phases=[Phase.explicit, Phase.generate])  # fmt: skip
    @given(powers, st.integers(-30, 30), st.integers(-30, 30))
    def same(force: int, displacement: int, time: int) -> None:
        scales = Scales(force=2.0**force, displacement=2.0**displacement, time=2.0**time)
        drive = DRIVE.scaled(scales)
        found = answer(motion().scaled(scales), drive, estimator)
        sizes = DRIVE.parameter_scales(scales)
        back = np.array(found) * np.concatenate([sizes, sizes])
        alike(back, estimator)

    same()


def table(time: Any) -> pd.DataFrame:
    recording = motion()
    return pd.DataFrame({"time_s": time, "torque_Nm": recording.torque, "velocity_rad_s": recording.velocity})


EPOCH = 1_795_305_600_000_000_000
CLOCKS: dict[str, tuple[Any, list[str]]] = {
    "epoch stamps in seconds": (lambda t: 1_795_305_600.0 + t, []),
    "epoch stamps in whole nanoseconds": (lambda t: EPOCH + (t * 1e9).astype("int64"), ["time=time_s:ns"]),
    "whole nanoseconds from zero": (lambda t: (t * 1e9).astype("int64"), ["time=time_s:ns"]),
    "microseconds before zero": (lambda t: (t * 1e6).astype("int64") - 10**12, ["time=time_s:us"]),
}


@pytest.mark.parametrize("clock", CLOCKS)
def test_where_the_clock_begins_does_not_matter(clock: str, tmp_path: Path) -> None:
    make, columns = CLOCKS[clock]
    path = tmp_path / "log.parquet"
    table(make(motion().time)).to_parquet(path)
    found = answer(read(path, columns=columns), DRIVE, "batch")
    np.testing.assert_allclose(found, expected("batch"), rtol=2e-3)  # stamps of a double near 1.8e9 s are 0.24 µs apart


def test_a_gigahertz(tmp_path: Path) -> None:
    """The same motion in a time 2⁻²² as long: some nanoseconds from sample to sample."""
    fast = Scales(force=1.0, displacement=1.0, time=2.0**22)
    drive = DRIVE.scaled(fast)
    path = tmp_path / "log.parquet"
    recording = motion().scaled(fast)
    columns = {"time_s": recording.time, "torque_Nm": recording.torque, "velocity_rad_s": recording.velocity}
    pd.DataFrame(columns).to_parquet(path)
    assert 1 / recording.interval > 1e9
    found = np.array(answer(read(path), drive, "batch"))
    sizes = DRIVE.parameter_scales(fast)
    alike(found * np.concatenate([sizes, sizes]), "batch")
