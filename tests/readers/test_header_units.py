"""Units that stand in the names of columns."""

from __future__ import annotations

import re

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.logcheck import Severity, findings
from fricmodels.readers import read
from fricmodels.readers.header_units import contradicting, stated_unit, without_unit


@pytest.mark.parametrize(
    ("column", "channel", "unit"),
    [
        ("Speed [rpm]", "velocity", "rpm"),
        ("pos_deg", "position", "deg"),
        ("i (mA)", "current", "mA"),
        ("Torque (N m)", "torque", "N*m"),
        ("q [°]", "position", "deg"),
        ("vel_rads", "velocity", "rad/s"),
        ("stamp_ms", "time", "ms"),
        ("acc [m/s²]", "acceleration", "m/s^2"),
        ("motor_volt_V", "torque", "V"),
        ("i_A", "torque", "A"),
        ("torque_A", "torque", None),
        ("q_m", "position", None),
        ("speed", "velocity", None),
        ("q [0]", "position", None),
        ("velocity (measured)", "velocity", None),
        ("pos_deg", "velocity", None),
        ("rpm", "velocity", None),
        ("Drehzahl [U/min]", "velocity", "U/min"),
        ("n [1/min]", "velocity", "1/min"),
        ("ActPos[rev]", "position", "rev"),
        ("Velocity (rev/s)", "velocity", "rev/s"),
        ("ActVel[rev/min]", "velocity", "rev/min"),
        ("Position (U)", "position", "U"),
        ("pos_rev", "position", "turn"),
        ("q_revs", "position", "turn"),
        ("acc_rev_s2", "acceleration", "turn/s^2"),
        ("other [U]", "other.voltage", None),
        ("n [min⁻¹]", "velocity", "min⁻¹"),
        ("Torque (kgf.cm)", "torque", "kgf.cm"),
        ("Torque (lb-in)", "torque", "lb-in"),
        ("speed_MMPS", "velocity", "mm/s"),
        ("torque_NM", "torque", "N*m"),
        ("pos_nm", "position", "nm"),
        ("torque_kgf_cm", "torque", "kgf*cm"),
        ("stamp (UTC)", "time", None),
        ("temp [C]", "temperature", "C"),
        ("link [foo]", "other.link", None),
        ("pos_mrad", "position", "mrad"),
        ("pos_arcmin", "position", "arcmin"),
        ("vel_mrads", "velocity", "mrad/s"),
        ("vel_mrad_s", "velocity", "mrad/s"),
        ("vel_mrad/s", "velocity", "mrad/s"),
        ("vel_um_s", "velocity", "um/s"),
        ("v_mps", "velocity", "m/s"),
        ("acc_mm_s2", "acceleration", "mm/s^2"),
        ("torque_inlb", "torque", "lbf*in"),
        ("torque_in-lb", "torque", "lbf*in"),
        ("torque_lbin", "torque", "lbf*in"),
        ("torque_oz_in", "torque", "ozf*in"),
        ("tau_kg_cm", "torque", "kgf*cm"),
        ("x_s", "position", None),
        ("pos_deg_s", "position", None),
        ("vel_deg", "velocity", None),
        ("t/ms", "time", "ms"),
        ("phi/°", "position", "deg"),
        ("M / mNm", "torque", "mNm"),
        ("n/min⁻¹", "velocity", "min⁻¹"),
        ("omega/(rad/s)", "velocity", "rad/s"),
        ("torque/A", "torque", None),
        ("arm/elbow", "position", None),
        ("/joint/deg", "position", None),
    ],
)
def test_the_unit_in_a_name(column, channel, unit):
    assert stated_unit(column, channel) == unit


def test_a_name_without_its_unit():
    assert without_unit("torque_in-lb") == "torque"
    assert without_unit("vel_mrad_s") == "vel"
    assert without_unit("Position/mm") == "Position"
    assert without_unit("arm/elbow") == "arm/elbow"


def log(tmp_path, header):
    time = np.arange(200) * 5.0
    rows = np.column_stack([time, np.cos(time / 100), 60 * np.sin(time / 100)])
    path = tmp_path / "log.csv"
    path.write_text("\n".join([header, *(",".join(f"{v:.6f}" for v in row) for row in rows)]), encoding="utf-8")
    return path


def test_a_scope_in_turns_is_read(tmp_path):
    path = log(tmp_path, "Time[ms],ActTrq[Nm],ActVel[rev/min]")
    columns = ["time=Time[ms]", "torque=ActTrq[Nm]", "velocity=ActVel[rev/min]"]
    assert read(path, columns=columns).velocity.max() == pytest.approx(2 * np.pi, rel=1e-3)
    path = log(tmp_path, "Time [ms],Torque [Nm],Velocity (rev/s)")  # called as channels: no mapping is needed
    assert read(path).velocity.max() == pytest.approx(120 * np.pi, rel=1e-3)
    path = log(tmp_path, "Time [ms],Torque [Nm],ActPos")
    found = read(path, columns=["position=ActPos:rev"])["position"]
    assert found.max() == pytest.approx(120 * np.pi, rel=1e-3)


def test_a_row_of_units_below_names_of_channels_is_read_without_a_mapping(tmp_path):
    found = read(log(tmp_path, "Time;Torque;Speed\n[ms];[mNm];[rpm]".replace(";", ",")))
    assert found.velocity.max() == pytest.approx(2 * np.pi, rel=1e-3)
    assert found.torque[0] == pytest.approx(1e-3)
    assert found.interval == pytest.approx(5e-3)
    with pytest.raises(InputError, match="torque-constant"):
        read(log(tmp_path, "Time,Torque,Speed\n[ms],[A],[rpm]"))


def test_it_is_read_and_an_option_overrules_it(tmp_path):
    path = log(tmp_path, "t [ms],tau [mN m],Speed [rpm]")
    names = ["time=t [ms]", "torque=tau [mN m]"]
    found = read(path, columns=[*names, "velocity=Speed [rpm]"])
    assert found.velocity.max() == pytest.approx(2 * np.pi, rel=1e-3)
    assert found.torque[0] == pytest.approx(1e-3)
    assert found.interval == pytest.approx(5e-3)
    assert read(path, columns=[*names, "velocity=Speed [rpm]:rad/s"]).velocity.max() == pytest.approx(60, rel=1e-3)


@pytest.mark.parametrize("unit", ["cnt", "counts", "cnt/sec", "0.1%", "‰", "inc", "LSB", "p.u."])
@pytest.mark.parametrize("channel", ["position", "velocity", "torque"])
def test_counts_and_shares_have_no_size(unit, channel):
    """A servo's scope writes them; taken for rad or N m every number would be wrong by orders of magnitude."""
    with pytest.raises(InputError, match=re.escape(f"is in '{unit}', which has no size; say how much one is")):
        stated_unit(f"Actual [{unit}]", channel)


def test_the_way_out_of_counts_is_read(tmp_path):
    path = log(tmp_path, "t [ms],tau [0.1%],pos [cnt]")
    columns = ["time=t [ms]", "torque=tau [0.1%]", "position=pos [cnt]"]
    with pytest.raises(InputError) as refused:
        read(path, columns=columns)
    assert "--column 'torque=tau [0.1%]:0.0024 N*m'" in str(refused.value)
    found = read(path, columns=[columns[0], "torque=tau [0.1%]:0.0024 N*m", "position=pos [cnt]:count/4096"])
    assert found.torque[0] == pytest.approx(0.0024)
    assert found["position"].max() == pytest.approx(60 * 2 * np.pi / 4096, rel=1e-3)


def test_a_voltage_is_no_torque(tmp_path):
    path = log(tmp_path, "t_ms,u [V],speed_rpm")
    with pytest.raises(InputError, match="a voltage is not a torque"):
        read(path, columns=["time=t_ms", "torque=u [V]", "velocity=speed_rpm"])


@pytest.mark.parametrize(
    ("header", "channel"),
    [
        ("v [foo]", "velocity"),
        ("v [deg]", "velocity"),
        ("T (foo/bar)", "torque"),
        ("n [1/s]", "velocity"),
        ("i (Arms/2)", "current"),
    ],
)
def test_brackets_that_are_not_understood_are_never_si(header, channel):
    with pytest.raises(InputError, match=re.escape(f"--column '{channel}={header}:UNIT'")):
        stated_unit(header, channel)


def test_words_in_brackets_that_may_be_a_unit_are_told(tmp_path):
    columns = ["time=t [ms]", "torque=tau (kpcmm)", "velocity=v (measured)"]
    path = log(tmp_path, "t [ms],tau (kpcmm),v (measured)")
    found = read(path, columns=columns)
    said = [finding for finding in findings(found) if "kpcmm" in str(finding)]
    assert [finding.severity for finding in said] == [Severity.WARN]
    assert "--column 'torque=tau (kpcmm):UNIT'" in str(said[0])
    assert not any("(measured)' is not known" in str(finding) for finding in findings(found))
    given = read(path, columns=[columns[0], "torque=tau (kpcmm):mN*m", columns[2]])
    assert "unread_units" not in given.provenance


@pytest.mark.parametrize(
    ("given", "is_told"),
    [("rad/s", True), ("deg/s", True), ("rpm", False), ("rev/min", False), ("rpm/50", False), ("-rpm", False)],
)
def test_a_unit_that_the_name_contradicts_is_told(tmp_path, given, is_told):
    """The unit that is asked for counts, and a number in it is meant; a name that states another one is told."""
    path = log(tmp_path, "t_ms,tau_Nm,speed_rpm")
    found = read(path, columns=["time=t_ms", "torque=tau_Nm", f"velocity=speed_rpm:{given}"])
    said = [str(finding) for finding in findings(found) if "its name states 'rpm'" in str(finding)]
    assert len(said) == is_told


def test_a_current_in_another_unit_than_its_name_states_is_told(tmp_path):
    path = log(tmp_path, "t_ms,i_mA,speed_rpm")
    columns = ["time=t_ms", "current=i_mA:A", "velocity=speed_rpm"]
    told = read(path, columns=columns, torque_constant=0.1).provenance["unread_units"]
    assert told == {"current": "its name states 'mA'"}


def test_a_name_that_ends_in_a_unit_of_something_else_is_told() -> None:
    """A velocity in a column ``vel_deg`` may be in deg/s; a torque in ``alpha_deg`` is an angle."""
    assert contradicting("vel_deg", "velocity") == "deg"
    assert contradicting("alpha_deg", "torque") == "deg"
    assert contradicting("speed_rpm", "position") == "rpm"
    for column, channel in (
        ("vel_deg_s", "velocity"),
        ("pos_deg", "position"),
        ("speed_rpm", "velocity"),
        ("q_m", "torque"),
    ):
        assert contradicting(column, channel) is None
