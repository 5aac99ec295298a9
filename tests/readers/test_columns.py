import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.readers.columns import Column, assign, parse
from fricmodels.readers.standard_names import NAMES, STANDARD

UNITS = [None, "deg/s", "rpm", "0.5 um", "count/2000", "N m"]
column_names = st.text(min_size=1, max_size=20).map(str.strip).filter(bool)


@settings(deadline=None)
@given(st.sampled_from(NAMES), column_names, st.sampled_from(UNITS))
def test_what_is_written_is_read_back(name, column, unit):
    written = Column(name, column, unit)
    assert parse(str(written), [column]) == written


@given(column_names, column_names)
def test_a_column_of_the_whole_name_comes_first(left, right):
    whole = f"{left}:{right}"
    assert parse(f"velocity={whole}", [whole, left]) == Column("velocity", whole)


@pytest.mark.parametrize(
    ("specification", "present", "column", "unit"),
    [
        ("velocity=qd:deg/s", ["qd"], "qd", "deg/s"),
        ("velocity=joint 1: speed", ["joint 1: speed"], "joint 1: speed", None),
        ("velocity=joint 1: speed:deg/s", ["joint 1: speed"], "joint 1: speed", "deg/s"),
        ("velocity=a=b", ["a=b"], "a=b", None),
        (" velocity = qd : rpm ", ["qd"], "qd", "rpm"),
    ],
)
def test_spaces_equal_signs_and_colons(specification, present, column, unit):
    assert parse(specification, present) == Column("velocity", column, unit)


@pytest.mark.parametrize(
    ("specification", "message"),
    [
        ("velocity=qd:dogs", "unknown unit 'dogs'"),
        ("velocty=qd", "did you mean 'velocity'"),
        ("velocity=QD1", "did you mean 'qd'"),
        ("velocity=nothing:deg/s", "no column 'nothing' for the velocity"),
        ("velocity", "CHANNEL=COLUMN"),
        ("velocity=", "CHANNEL=COLUMN"),
    ],
)
def test_errors_name_the_way_out(specification, message):
    with pytest.raises(InputError, match=message) as error:
        parse(specification, ["qd", "tau"])
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("motion", list(Motion))
def test_standard_names_need_no_mapping(motion):
    found, kind = assign([], list(STANDARD[motion].values()), None)
    assert kind is motion
    assert {channel: column.column for channel, column in found.items()} == STANDARD[motion]


@pytest.mark.parametrize(
    ("columns", "present", "motion"),
    [
        (["force=f", "position=x"], ["time_s", "f", "x"], Motion.LINEAR),
        (["torque=f", "position=x:mm"], ["time_s", "f", "x"], Motion.LINEAR),
        (["torque=f", "position=x:deg"], ["time_s", "f", "x"], Motion.ROTARY),
        (["time=t"], ["t", "force_N", "velocity_m_s"], Motion.LINEAR),
        (["torque=f", "position=x"], ["time_s", "f", "x"], Motion.ROTARY),
    ],
)
def test_motion_is_told_from_names_and_units(columns, present, motion):
    assert assign(columns, present, None)[1] is motion


def test_mixed_motion_is_refused():
    with pytest.raises(InputError, match="mixes a linear axis"):
        assign(["force=f", "velocity=v:rpm"], ["time_s", "f", "v"], None)


@pytest.mark.parametrize(
    ("present", "message"),
    [
        (
            ["t", "torque_Nm", "velocity_rad_s"],
            "the time: none is called time_s; map one with --column time=t.*columns: t,",
        ),
        (["time_s", "tau", "velocity_rad_s"], "torque or current: .*--column torque=tau"),
        (
            ["t", "tau", "qd"],
            "the time, the torque or current and the velocity or position: none is called time_s, torque_Nm, "
            r"current_A, velocity_rad_s or position_rad; map them with --column time=t\[:UNIT\] "
            r"--column torque=tau\[:UNIT\] --column velocity=qd\[:UNIT\]; columns: t, tau, qd",
        ),
        (["time_s", "torque_Nm", "qd"], "velocity or position: .*--column velocity=qd"),
        (["time_s", "torque_Nm", "x1"], "--column velocity=COLUMN"),
        (["time_s", "i", "theta"], r"--column current=i\[:UNIT\] --column position=theta\[:UNIT\]"),
        (
            ["stamp [ms]", "torque_Nm", "omega_rpm"],  # what states its unit needs none; a blank needs quotes
            r"with --column 'time=stamp \[ms\]' --column velocity=omega_rpm; columns",
        ),
    ],
)
def test_a_missing_channel_is_named_with_a_suggestion(present, message):
    with pytest.raises(InputError, match=message):
        assign([], present, None)


def test_a_column_that_is_called_as_another_channel_is_not_suggested():
    with pytest.raises(InputError, match=r"--column force=torque\[:UNIT\]"):
        assign([], ["time_s", "load_torque", "torque", "velocity_m_s"], Motion.LINEAR)


def test_a_duplicated_column_is_refused_only_where_it_is_used():
    present = ["time_s", "torque_Nm", "velocity_rad_s", "note", "note"]
    assign([], present, None)
    with pytest.raises(InputError, match="'torque_Nm' is there 2 times"):
        assign([], [*present, "torque_Nm"], None)


def test_a_channel_is_mapped_once():
    with pytest.raises(InputError, match="mapped twice"):
        assign(["torque=a", "force=b"], ["a", "b"], None)


@pytest.mark.parametrize(
    ("present", "columns", "motion"),
    [
        (
            ["Time [ms]", "Position [deg]", "velocity_deg_s", "Torque (mN m)", "ref [deg]"],
            {"time": "Time [ms]:ms", "position": "Position [deg]:deg", "velocity": "velocity_deg_s:deg/s"},
            Motion.ROTARY,
        ),
        (["time_s", "force [kN]", "Position (mm)"], {"position": "Position (mm):mm"}, Motion.LINEAR),
        (["time_s", "current [A]", "velocity_rad_s", "Velocity [rpm]"], {"velocity": "velocity_rad_s"}, Motion.ROTARY),
        (["Time [s]", "Speed [rpm]", "Torque [mNm]"], {"velocity": "Speed [rpm]:rpm"}, Motion.ROTARY),
        (["time_s", "force [N]", "Speed [mm/s]"], {"velocity": "Speed [mm/s]:mm/s"}, Motion.LINEAR),
        (["time_s", "torque_Nm", "Speed [rpm]", "Velocity [rpm]"], {"velocity": "Velocity [rpm]:rpm"}, Motion.ROTARY),
    ],
)
def test_a_column_called_as_a_channel_that_states_its_unit_needs_no_mapping(present, columns, motion):
    found, kind = assign([], present, None)
    assert kind is motion
    assert all(str(found[channel]).partition("=")[2] == column for channel, column in columns.items())
    assert all(column.column != "ref [deg]" for column in found.values())


@pytest.mark.parametrize(
    "present",
    [
        ["time_s", "torque_Nm", "position [rad]", "Position [deg]"],  # which one is it?
        ["time_s", "torque [Nm]", "position [mm]"],  # a motor's torque, and its axis?
        ["time_s", "torque_Nm", "position"],  # in which unit?
        ["time_s", "torque_Nm", "position [s]"],
        ["time_s", "torque_Nm", "Speed [rpm]", "speed [rad/s]"],
        ["time_s", "torque_Nm", "Speed [rpm]", "velocity"],  # is that one the measured one?
    ],
)
def test_what_only_the_user_knows_is_asked_for(present):
    with pytest.raises(InputError, match="no column for"):
        assign([], present, None)


def test_counts_of_an_encoder_are_asked_for_as_a_position():
    with pytest.raises(InputError, match=r"say how much one is, as in --column 'position=Position \[cnt\]:count/4096'"):
        assign([], ["time_s", "torque_Nm", "Position [cnt]"], None)


@pytest.mark.parametrize("position", ["Position [deg]", "position_rad", "position"])
def test_a_speed_beside_a_position_may_have_no_sign_and_is_not_taken(position):
    """A log of both was read by its position, and would be refused for a speed that is never negative."""
    mapped = ["position=position:rad"] if position == "position" else []
    found, _ = assign(mapped, ["time_s", "torque_Nm", position, "Speed [rpm]"], None)
    assert found["position"].column == position
    assert "velocity" not in found


def test_a_mapping_goes_before_a_name_with_a_unit():
    found, _ = assign(["position=q:deg"], ["time_s", "torque_Nm", "position [rad]", "q"], None)
    assert found["position"] == Column("position", "q", "deg")
    found, _ = assign([], ["time_s", "force_N", "position [mm]", "velocity [rpm]"], Motion.LINEAR)
    assert found["position"].unit == "mm"
    assert "velocity" not in found


@pytest.mark.parametrize("written", [str.upper, str.title, str.lower])
def test_standard_names_in_any_case(written):
    present = [written(name) for name in ("time_s", "torque_Nm", "velocity_rad_s", "position_rad")]
    found, motion = assign((), present, None)
    assert {channel: column.column for channel, column in found.items()} == dict(
        zip(("time", "torque", "velocity", "position"), present, strict=True)
    )
    assert motion is Motion.ROTARY


def test_a_name_in_two_cases_is_taken_as_it_is_written():
    found, _ = assign((), ["time_s", "TIME_S", "torque_Nm", "velocity_rad_s"], None)
    assert found["time"].column == "time_s"


ROTARY_NAMES = ["time_s", "torque_Nm", "velocity_rad_s"]


@pytest.mark.parametrize(
    ("columns", "motion", "cause"),
    [
        ((), Motion.LINEAR, "torque_Nm and velocity_rad_s are columns of a rotary drive; leave out --linear"),
        (("force=torque_Nm:N*m",), Motion.LINEAR, "'force=torque_Nm:N*m' is in a unit of a rotary drive; leave out"),
        (("velocity=velocity_rad_s:m/s",), None, "'velocity=velocity_rad_s:m/s' is that of a linear one: correct it"),
    ],
)
def test_the_other_kind_of_motion_is_named_as_the_cause(columns, motion, cause):
    with pytest.raises(InputError, match=re.escape(cause)):
        assign(columns, ROTARY_NAMES, motion)


def test_the_only_column_of_a_matrix():
    assert parse("position=q(1)", ["q"]) == Column("position", "q")
    with pytest.raises(InputError):
        parse("position=q(2)", ["q"])


def test_a_column_in_an_angle_beside_a_linear_axis_without_a_force_is_no_accident() -> None:
    """A force is a torque by another name: what may be one is asked for by its unit, too."""
    with pytest.raises(InputError, match="no column for the time, the force or current and the velocity or position"):
        assign([], ["1e-05", "qd [deg/s]"], Motion.LINEAR)
    with pytest.raises(InputError, match="--column 'force=motor force \\[kN\\]"):
        assign([], ["time_s", "velocity_m_s", "force angle [deg]", "motor force [kN]"], Motion.LINEAR)


@pytest.mark.parametrize(
    ("present", "motion", "option"),
    [
        (["time_s", "velocity_rad_s", "M [Nm]", "U [V]"], Motion.ROTARY, "--column 'torque=M [Nm]'"),
        (["time_s", "velocity_m_s", "F [kN]"], Motion.LINEAR, "--column 'force=F [kN]'"),
        (["time_s", "velocity_rad_s", "Ph1 [mA]", "U [V]"], Motion.ROTARY, "--column 'current=Ph1 [mA]'"),
        (["time_s", "torque_Nm", "n1 [rpm]"], Motion.ROTARY, "--column 'velocity=n1 [rpm]'"),
        (["time_s", "velocity_rad_s", "M1 [Nm]", "M2 [Nm]"], Motion.ROTARY, "--column torque=COLUMN"),
    ],
)
def test_a_column_that_alone_states_a_unit_of_what_is_lacking_is_proposed(
    present: list[str], motion: Motion, option: str
) -> None:
    with pytest.raises(InputError, match=re.escape(option)):
        assign([], present, motion)
