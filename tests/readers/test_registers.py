"""Numbers that a log shows without their sign."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.errors import InputError
from fricmodels.logcheck.check import findings
from fricmodels.readers import read
from fricmodels.readers.registers import Register, find_register
from fricmodels.sums.plan import plan_for

REGISTERS = (Register(16, True), Register(32, True), Register(16, False), Register(11, False))


def shown(values: np.ndarray, register: Register) -> np.ndarray:
    """Return numbers as they are shown without their sign."""
    meant = values + 2.0 * register.least if register.complement else register.least - values
    return np.where(values < 0, meant, values)


def load(seed: int, size: float) -> np.ndarray:
    """Return a load of both signs, in whole numbers."""
    rng = np.random.default_rng(seed)
    time = np.arange(600.0)
    course = np.sin(0.05 * time + seed) + 0.4 * np.sin(0.13 * time) + 0.02 * rng.standard_normal(600)
    return np.round(size * course / np.abs(course).max())


@pytest.mark.parametrize("register", REGISTERS, ids=str)
@given(seed=st.integers(0, 1000), size=st.floats(60.0, 1000.0))
def test_a_load_is_read_with_its_sign(register: Register, seed: int, size: float) -> None:
    values = load(seed, size)
    found = find_register(shown(values, register))
    assert found == register
    assert np.array_equal(found.signed(shown(values, register)), values)


@pytest.mark.parametrize("register", REGISTERS, ids=str)
@pytest.mark.parametrize("friction", [40.0, 120.0, 250.0])
def test_a_load_that_jumps_where_dry_friction_turns_is_read_with_its_sign(register: Register, friction: float) -> None:
    course = load(2, 400.0)
    values = course + np.round(friction * np.sign(course + 0.5))
    values[::37] = np.resize([1.0, -1.0], len(values[::37]))  # at rest
    found = find_register(shown(values, register))
    assert found == register
    assert np.array_equal(found.signed(shown(values, register)), values)


@pytest.mark.parametrize("seed", range(5))
def test_what_jumps_all_over_its_range_by_itself_stays(seed: int) -> None:
    rng = np.random.default_rng(seed)
    assert find_register(np.round(rng.uniform(0.0, 2047.0, 600))) is None
    assert find_register(np.round(np.repeat(rng.uniform(0.0, 2047.0, 60), 10))) is None


@pytest.mark.parametrize(
    "values",
    [
        load(1, 800.0),  # with its sign
        np.abs(load(1, 800.0)),
        np.abs(load(1, 2000.0)),  # through 1024 by itself
        load(1, 800.0) + 0.5,
        np.round(32768 + load(1, 3000.0)),  # about the middle of its range
        np.where(load(1, 1.0) > 0, 1100.0, 0.0) + np.arange(600) % 5,  # switched on and off
        np.where(load(1, 1.0) > 0, 60000.0, 0.0) + np.arange(600) % 5,
        np.arange(600.0),
        np.zeros(600),
    ],
)
def test_what_has_its_sign_stays(values: np.ndarray) -> None:
    assert find_register(values) is None


def test_it_is_said(tmp_path: Path) -> None:
    time = 0.01 * np.arange(600.0)
    torque, velocity = load(3, 500.0), np.cos(0.05 * np.arange(600.0) + 3)
    path = tmp_path / "servo.csv"
    table = np.column_stack([time, velocity, shown(torque, REGISTERS[0])])
    np.savetxt(path, table, delimiter=",", header="time_s,velocity_rad_s,load", comments="", fmt="%.9g")
    recording = read(path, columns=["torque=load:0.001 N*m"])
    assert recording.torque == pytest.approx(0.001 * torque)
    told = [str(finding) for finding in findings(recording) if finding.kind == "unsigned"]
    assert len(told) == 1
    assert "register of 16 bits" in told[0]
    with pytest.raises(InputError, match="the torque was written without its sign"):
        plan_for(recording, "coulomb-viscous")


def test_a_clock_that_is_coarser_than_the_samples(tmp_path: Path) -> None:
    """As that of an operating system that ticks every 15.6 ms."""
    time = 0.0156 * np.floor(0.0149 * np.arange(700.0) / 0.0156)
    velocity = np.cos(0.05 * np.arange(700.0))
    path = tmp_path / "ticks.csv"

    def write(velocity: np.ndarray) -> None:
        table = np.column_stack([time, velocity, np.sign(velocity) + 0.1 * velocity])
        np.savetxt(path, table, delimiter=",", header="time_s,velocity_rad_s,torque_Nm", comments="", fmt="%.9g")

    write(velocity)
    with pytest.raises(InputError, match=r"coarser than the samples; .* --column time=row:14\.91ms"):  # true to 0.1 %
        read(path)
    assert read(path, columns=["time=row:14.91ms"]).interval == pytest.approx(0.01491)
    repeated = np.r_[False, np.diff(time) == 0.0]
    write(np.where(repeated, np.r_[0.0, velocity[:-1]], velocity))  # written twice
    with pytest.raises(InputError, match="drop repeated samples with --gaps drop"):
        read(path)


@pytest.mark.parametrize("begun", [0.0, 0.3, 0.97])
def test_rows_are_counted_from_tick_to_tick(begun: float, tmp_path: Path) -> None:
    """Whole seconds of a log of 20 s at 500 Hz: from the first stamp to the last it is 5 % too short."""
    time = np.floor(begun + 2e-3 * np.arange(10_000))
    velocity = np.cos(0.05 * np.arange(10_000))
    path = tmp_path / "seconds.csv"
    table = np.column_stack([time, velocity, np.sign(velocity) + 0.1 * velocity])
    np.savetxt(path, table, delimiter=",", header="time_s,velocity_rad_s,torque_Nm", comments="", fmt="%.9g")
    with pytest.raises(InputError, match=r"coarser than the samples; .* --column time=row:2ms"):
        read(path)


def test_a_few_stamps_that_are_alike_are_slips_and_no_coarse_clock(tmp_path: Path) -> None:
    """Three of a thousand: rows that were counted at their mean interval would all have a wrong stamp."""
    time = 1e-3 * np.arange(1000.0)
    time[[300, 500, 700]] = time[[299, 499, 699]]
    velocity = np.cos(0.05 * np.arange(1000.0))
    table = np.column_stack([time, velocity, np.sign(velocity) + 0.1 * velocity])
    path = tmp_path / "slips.csv"
    np.savetxt(path, table, delimiter=",", header="time_s,velocity_rad_s,torque_Nm", comments="", fmt="%.9g")
    with pytest.raises(InputError, match=r"is repeated; drop repeated samples with --gaps drop"):
        read(path)
    assert len(read(path, gaps="drop")) == 997


@pytest.mark.parametrize("number", ["1.000,5", "12,345,678.9", "1'234.5", "-3 000"])
def test_marks_between_thousands_are_named(tmp_path: Path, number: str) -> None:
    path = tmp_path / "log.csv"
    rows = "".join(f"{0.1 * k};0.5;{number}\n" for k in range(9))
    path.write_text("time_s;velocity_rad_s;torque_Nm\n" + rows, encoding="utf-8")
    with pytest.raises(InputError, match="write it without marks between thousands"):
        read(path)
