"""Columns that look like a channel which a recording lacks."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.logcheck.check import findings
from fricmodels.readers import read
from fricmodels.readers.column_names import likely, overlooked
from fricmodels.readers.columns import assign


@pytest.mark.parametrize(
    ("free", "used", "column"),
    [
        (["angle_rad"], ["velocity_rad_s", "current_A"], "angle_rad"),
        (["Position [deg]", "temp"], ["Speed [rpm]"], "Position [deg]"),
        (["q1_rad", "q6_rad", "qd1_rad_s"], ["qd6_rad_s", "i6_A"], "q6_rad"),  # the joint whose velocity is taken
        (["q1_rad", "q2_rad"], ["qd6_rad_s"], None),
        (["q1_rad", "q2_rad"], ["velocity_rad_s"], None),  # which of them is not known
        (["goal_position", "position_ref", "pos_cmd"], ["velocity_rad_s"], None),  # what was asked for
        (["goal_position", "pos"], ["velocity_rad_s"], "pos"),
        (["supply_V", "quality"], ["velocity_rad_s"], None),
    ],
)
def test_the_column_that_looks_like_the_position(free: Sequence[str], used: Sequence[str], column: str | None) -> None:
    assert overlooked("position", free, used) == column


def test_a_column_with_the_number_of_a_joint_is_proposed() -> None:
    assert likely(("velocity", "position"), ["tau_3", "qd3_rad_s", "q3_rad"]) == ("velocity", "qd3_rad_s")
    assert likely(("velocity", "position"), ["tau_3", "q3_rad"]) == ("position", "q3_rad")


@pytest.mark.parametrize(
    ("name", "channel"),
    [
        ("leftSpeed", "velocity"),
        ("ODrive 3 Velocity", "velocity"),
        ("joint angle", "position"),
        ("motorTorqueNm", "torque"),
    ],
)
def test_a_word_within_a_name_proposes_it(name: str, channel: str) -> None:
    assert likely((channel,), ["counter", "quality", name]) == (channel, name)
    assert likely((channel,), [f"desired {name}"]) is None


@pytest.mark.parametrize(
    ("present", "proposed"),
    [
        (
            "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_qd_1 actual_current_0 actual_current_1",
            ["timestamp", "actual_current_0", "actual_qd_0", "actual_q_0"],
        ),
        (
            "time left_s0 left_s1 left_e1 left_s1_velocity left_e1_velocity left_s1_gravity_torque left_s1_effort",
            ["time", "left_s1_effort", "left_s1_velocity"],
        ),
        ("stamp q1 q2 dq1 dq2 tau_J2", ["stamp", "tau_J2", "dq2", "q2"]),
        ("log.t log.q(1) log.q(2) log.dq(1) log.dq(2) log.tau(1)", ["log.t", "log.tau(1)", "log.dq(1)", "log.q(1)"]),
        ("millis() q1 i1", ["millis()", "i1", "q1"]),
        ("t tau1 rotor[rad/s]", ["t", "tau1", "rotor[rad/s]"]),  # the only one with a unit of what is lacking
    ],
)
def test_columns_of_one_joint_are_proposed_as_public_logs_call_them(present: str, proposed: list[str]) -> None:
    with pytest.raises(InputError, match="map them with") as told:
        assign([], present.split(), None)
    options = shlex.split(
        re.sub(r"\[:UNIT\]", "", str(told.value).partition("map them with ")[2].partition("; columns")[0])
    )
    assert [option.partition("=")[2] for option in options if "=" in option] == proposed


def test_a_temperature_is_no_time() -> None:
    assert likely(("time",), ["temp", "temperature"]) is None


def test_columns_with_german_names_and_a_unit_of_several_joints_are_proposed() -> None:
    axes = [f"A{i} {what}" for what in ("Istposition [°]", "Istgeschwindigkeit [°/s]", "Moment [Nm]") for i in (1, 2)]
    asked_for = ["A1 Sollposition [°]", "A1 Sollgeschwindigkeit [°/s]"]
    with pytest.raises(
        InputError, match=r"'torque=A1 Moment \[Nm\]' --column 'velocity=A1 Istgeschwindigkeit \[°/s\]'"
    ):
        assign([], ["Zeit [s]", *asked_for, *axes], None)


def test_the_joint_that_is_mapped_already_is_the_one_that_is_proposed() -> None:
    present = ["time_s", "q1", "q2", "q3", "dq1", "dq2", "dq3", "tau1", "tau2", "tau3"]
    with pytest.raises(InputError, match=r"--column velocity=dq3\[:UNIT\]"):
        assign(["torque=tau3:Nm"], present, None)


def test_what_was_measured_is_proposed_before_what_was_asked_for_and_its_parts() -> None:
    assert likely(("torque", "current"), ["p_torque", "d_torque", "total_torque"]) == ("torque", "total_torque")
    assert likely(("velocity",), ["velocity_ref", "vel"]) == ("velocity", "vel")
    assert likely(("velocity",), ["velocity_ref"]) == ("velocity", "velocity_ref")


def test_a_unit_in_a_name_says_what_it_is_not(tmp_path: Path) -> None:
    """ "Current" is a word for now, too."""
    path = written(tmp_path, ["Timestamp", "Current Torque [Nm]", "Angular Velocity [rad/s]", "Angle [deg]"])
    with pytest.raises(InputError, match=r"--column 'torque=Current Torque \[Nm\]'"):
        read(path)


def written(folder: Path, names: Sequence[str]) -> Path:
    """Write a motion of half a minute; columns by their names."""
    time = 0.01 * np.arange(3000.0)
    velocity = 2.0 * np.sin(3.0 * time) + np.sin(5.3 * time)
    position = -2.0 / 3.0 * np.cos(3.0 * time) - np.cos(5.3 * time) / 5.3
    torque = 0.02 * np.gradient(velocity, time) + 0.1 * velocity + 0.3 * np.sign(velocity)
    path = folder / "log.csv"
    table = np.column_stack([time, torque, velocity, position])
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="", fmt="%.9g")
    return path


def test_a_column_that_nothing_uses_is_told_with_the_option_that_takes_it(tmp_path: Path) -> None:
    recording = read(written(tmp_path, ["time_s", "torque_Nm", "velocity_rad_s", "angle_rad"]))
    assert "position" not in recording
    found = [finding for finding in findings(recording) if finding.kind == "unused-column"]
    assert [str(finding) for finding in found] == [
        "the column 'angle_rad' is not used, and looks like the position; --column position=angle_rad takes it"
    ]
    again = read(tmp_path / "log.csv", columns=["position=angle_rad"])
    assert np.ptp(again["position"]) == pytest.approx(1.71, abs=0.01)
    assert "unused-column" not in {finding.kind for finding in findings(again)}


def test_what_is_used_and_what_is_called_otherwise_is_no_matter(tmp_path: Path) -> None:
    for last in ("position_rad", "supply_V"):
        recording = read(written(tmp_path, ["time_s", "torque_Nm", "velocity_rad_s", last]))
        assert "unused-column" not in {finding.kind for finding in findings(recording)}


def test_a_log_without_a_time_counts_its_rows(tmp_path: Path) -> None:
    path = written(tmp_path, ["stamp", "torque_Nm", "velocity_rad_s", "position_rad"])
    with pytest.raises(InputError, match=r"or at a known interval --column time=row:5ms; columns"):
        read(written(tmp_path, ["x", "torque_Nm", "velocity_rad_s", "position_rad"]))
    counted = read(path, columns=["time=row:10ms"])
    np.testing.assert_allclose(counted.time, 0.01 * np.arange(3000.0))
    np.testing.assert_array_equal(counted.time, read(path, columns=["time=row:0.01 s"]).time)
    assert counted.provenance["columns"]["time"] == "time=row:10ms"
    for wrong, message in (
        ("time=row", "give the interval between two"),
        ("time=row:", "give the interval between two"),
        ("time=row:parsecs per", "no column 'row:parsecs per'|unknown unit"),
        ("time=row:rad", "does not measure the time"),
        ("velocity=row:rad/s", "there is no column 'row'"),
    ):
        with pytest.raises(InputError, match=message):
            read(path, columns=[wrong])


def test_a_column_that_is_called_row_is_that_column(tmp_path: Path) -> None:
    path = written(tmp_path, ["row", "torque_Nm", "velocity_rad_s", "position_rad"])
    assert read(path, columns=["time=row:s"]).time[-1] == pytest.approx(29.99)
    assert read(path, columns=["time=row"]).time[-1] == pytest.approx(29.99)


def test_rows_are_counted_on_through_blocks_and_files_of_other_formats(tmp_path: Path) -> None:
    import pandas as pd

    from fricmodels.readers.blocks import blocks

    table = pd.read_csv(written(tmp_path, ["stamp", "torque_Nm", "velocity_rad_s", "position_rad"]))
    table.to_parquet(tmp_path / "log.parquet")
    opened = blocks(tmp_path / "log.parquet", columns=["time=row:10ms"])
    time = np.concatenate([block.channels["time"] for block in opened.of(["time", "torque"])])
    np.testing.assert_allclose(time, 0.01 * np.arange(3000.0))
    np.testing.assert_array_equal(time, read(tmp_path / "log.parquet", columns=["time=row:10ms"]).time)
    alone = np.concatenate([block.channels["time"] for block in opened.of(["time"])])
    np.testing.assert_array_equal(alone, time)


def test_a_column_in_a_unit_that_does_not_measure_the_channel_is_proposed_with_one(tmp_path: Path) -> None:
    """A speed in Hz: as it stands, the option that takes it would be refused."""
    recording = read(written(tmp_path, ["time_s", "torque_Nm", "Speed [Hz]", "position_rad"]))
    (found,) = [finding for finding in findings(recording) if finding.kind == "unused-column"]
    assert found.remedy == "--column 'velocity=Speed [Hz]:UNIT' takes it"
    again = read(tmp_path / "log.csv", columns=["velocity=Speed [Hz]:turn/s"])
    assert again.measures("velocity")
