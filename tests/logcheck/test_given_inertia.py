"""An inertia that the recording contradicts is said to be wrong, first of all; one that it cannot judge is not."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.logcheck import Finding, Severity, findings
from fricmodels.logcheck.balance import balances
from fricmodels.logcheck.given_inertia import told
from fricmodels.logcheck.view import Log
from fricmodels.recording import Recording

INERTIA = 0.05
FREQUENCIES, SIZES = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0])
COLUMNS = {"time": "time=t", "torque": "torque=tau", "velocity": "velocity=dq", "position": "position=q"}


def drive(samples: int = 8000, noise: float = 0.013, waves: int = 3, load: float = 0.0) -> Recording:
    """Return a drive with inertia, a load that is not told, friction, noise on its sensors, moved by some sines."""
    rng = np.random.default_rng(0)
    time = 2e-3 * np.arange(samples)
    frequencies, sizes = FREQUENCIES[:waves], SIZES[:waves]
    angle = np.outer(time, frequencies) + rng.uniform(0, 6, waves)
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / frequencies)
    torque = (INERTIA + load) * np.cos(angle) @ (sizes * frequencies) + 0.1 * velocity + 0.6 * np.sign(velocity)
    channels = {
        "time": time,
        "torque": torque + 0.01 * rng.standard_normal(samples),
        "velocity": velocity + noise * rng.standard_normal(samples),
        "position": position + 1e-5 * rng.standard_normal(samples),
    }
    return Recording(
        "log", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64), provenance={"columns": dict(COLUMNS)}
    )


CLEAN = drive()


def changed(recording: Recording = CLEAN, **factors: float) -> Recording:
    """Return a recording with channels so many times what they are; without those whose factor is 0."""
    channels = {n: v * factors.get(n, 1.0) for n, v in recording.channels.items() if factors.get(n) != 0.0}
    return replace(recording, channels=channels)


def grave(recording: Recording, inertia: float | None) -> list[Finding]:
    return [one for one in findings(recording, inertia) if one.severity is not Severity.NOTE]


@pytest.mark.parametrize("times", [1e-6, 0.01, 0.1, 10.0, 30.0, 1e3, 1e4, 1e7, 1e12])
def test_an_inertia_that_is_far_off_is_named_first_with_the_one_that_the_recording_tells(times: float) -> None:
    first = grave(CLEAN, times * INERTIA)[0]
    assert (first.kind, first.severity) == ("inertia", Severity.STOP)
    said = re.match(r"the inertia that is given, (\S+) kg m², is (\S+) times the one", first.text)
    assert said is not None
    assert float(said[1]) == pytest.approx(times * INERTIA, rel=0.01)
    assert float(said[2]) == pytest.approx(times, rel=0.01)
    assert "the recording tells, 0.05 ±" in first.text
    assert "leave it out" in first.remedy


@pytest.mark.parametrize(("times", "unit"), [(1e3, "g m²"), (1e4, "kg cm²"), (1e6, "kg mm²"), (1e7, "g cm²")])
def test_a_unit_of_the_inertia_that_fits_is_named(times: float, unit: str) -> None:
    (first,) = grave(CLEAN, times * INERTIA)
    assert f"as one in {unit} is" in first.text
    assert "in kg m², 0.05," in first.remedy


@pytest.mark.parametrize("times", [1 / 3, 0.5, 1.0, 2.0, 2.9])
@pytest.mark.parametrize("without", [(), ("position",), ("velocity",)])
def test_up_to_three_times_is_left_to_the_diagnosis(times: float, without: tuple[str, ...]) -> None:
    assert grave(changed(**dict.fromkeys(without, 0.0)), 1.01 * times * INERTIA) == []


def test_some_times_off_is_a_warning_where_no_unit_fits() -> None:
    """A load of three times the inertia that is not told; the diagnosis names it, too."""
    (first,) = grave(drive(load=3.0 * INERTIA), INERTIA)
    assert (first.kind, first.severity) == ("inertia", Severity.WARN)


def test_noise_of_the_velocity_does_not_make_the_inertia_smaller() -> None:
    """Noise that makes nine tenths of the acceleration over four samples."""
    noisy = drive(noise=0.25)
    short = min(balances(Log(noisy)), key=lambda row: row.width)
    alone = np.linalg.lstsq(short.columns, short.target)[0]
    assert alone[short.names.index("J")] < INERTIA / 3
    assert all(abs(one.value / INERTIA - 1.0) < 0.1 for one in told([short]))
    assert grave(noisy, INERTIA) == []


def test_one_sine_tells_no_inertia() -> None:
    """Its acceleration goes with its position, so that a spring may be all of it."""
    sine = drive(waves=1)
    assert grave(sine, 100.0 * INERTIA) == []


@pytest.mark.parametrize(
    ("factor", "speed", "angle"),
    [(180 / np.pi, "deg/s", "deg"), (30 / np.pi, "rpm", "turn"), (1 / 2 / np.pi, "turn/s", "turn")],
)
def test_units_of_the_motion_stand_beside_the_inertia(factor: float, speed: str, angle: str) -> None:
    both = changed(velocity=factor, position=factor)
    assert "unit" not in [one.kind for one in grave(both, None)]
    (first,) = grave(both, INERTIA)
    assert (first.kind, first.severity) == ("inertia", Severity.STOP)
    assert f"dq) in {speed} and the position (position=q) in {angle} would do the same" in first.text
    assert f"--column velocity=dq:{speed} --column position=q:{angle}" in first.remedy
    (alone,) = grave(changed(velocity=factor, position=0.0), INERTIA)
    assert f"in {speed} would do the same" in alone.text


def test_a_position_in_degrees_beside_a_velocity_in_rpm() -> None:
    """Their ratio says that a unit is wrong, and the inertia is right with it: one cause, said once."""
    (found,) = grave(changed(velocity=30 / np.pi, position=180 / np.pi), INERTIA)
    assert (found.kind, found.severity) == ("unit", Severity.STOP)
    assert "position=q:deg" in found.remedy
    assert "velocity=dq:rpm" in found.remedy


def test_a_torque_in_millinewtonmetres_stands_beside_the_inertia() -> None:
    (first,) = grave(changed(torque=1e3), INERTIA)
    assert first.kind == "inertia"
    assert "--column 'torque=tau:mN*m'" in first.remedy


@pytest.mark.parametrize(("times", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
@pytest.mark.parametrize("inertia", [None, INERTIA])
def test_a_time_in_another_unit_is_told_by_velocity_and_position(
    times: float, unit: str, inertia: float | None
) -> None:
    first, *others = grave(changed(time=times), inertia)
    assert (first.kind, first.severity, first.channel) == ("unit", Severity.STOP, "time")
    assert f"--column time=t:{unit}" in first.remedy
    assert not any("torque=" in one.remedy for one in others)


@pytest.mark.parametrize(("times", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
@pytest.mark.parametrize("channel", ["position", "velocity"])
def test_a_time_in_another_unit_is_told_by_the_inertia(times: float, unit: str, channel: str) -> None:
    """Beside a velocity, the acceleration is so many times too small; beside a position, the square of it."""
    first, *others = grave(changed(time=times, **{channel: 0.0}), INERTIA)
    assert (first.kind, first.severity, first.channel) == ("unit", Severity.STOP, "time")
    assert f"--column time=t:{unit}" in first.remedy
    assert not any("torque=" in one.remedy for one in others)


def test_a_time_in_seconds_that_is_read_in_milliseconds() -> None:
    columns = {**COLUMNS, "time": "time=t:ms"}
    read = replace(changed(time=1e-3), provenance={"columns": columns})
    first = grave(read, None)[0]
    assert (first.channel, first.severity) == ("time", Severity.STOP)
    assert "--column time=t:s" in first.remedy


def test_a_velocity_of_another_power_of_ten_at_a_usual_rate_is_not_the_time() -> None:
    (found,) = grave(changed(velocity=1e3), None)
    assert (found.kind, found.severity, found.channel) == ("velocity-scale", Severity.WARN, "velocity")
    assert "as between milli and one, or with a time in another unit" in found.text
    (found,) = grave(changed(velocity=1e6), None)
    assert "as between micro and one" in found.text


@pytest.mark.parametrize("inertia", [0.0, -0.0, -1.0, np.nan, np.inf])
def test_an_inertia_that_no_drive_has_is_refused(inertia: float) -> None:
    with pytest.raises(InputError, match="inertia must be positive and finite"):
        findings(CLEAN, inertia)


@pytest.mark.parametrize(
    ("channel", "was", "times", "unit"),
    [
        ("torque", "kN*m", 1e3, "N*m"),
        ("torque", "mN*m", 1e-3, "N*m"),
        ("torque", "N*cm", 1e-2, "N*m"),
        ("torque", "N*m", 1e3, "mN*m"),
        ("torque", "A", 1e3, "mA"),
        ("torque", "mA", 1e-3, "A"),
        ("velocity", "rpm", np.pi / 30, "rad/s"),
        ("velocity", "deg/s", np.pi / 180, "rad/s"),
        ("velocity", "deg/s", 1 / 6, "rpm"),
        ("velocity", "turn/s", 60.0, "rpm"),
    ],
)
def test_the_unit_that_is_proposed_is_told_from_the_one_that_was_read(
    channel: str, was: str, times: float, unit: str
) -> None:
    """A column was read in a unit that its header states, and is in another one."""
    columns = {**COLUMNS, channel: f"{COLUMNS[channel]}:{was}"}
    wrong = replace(changed(**{channel: times, "position": 0.0}), provenance={"columns": columns})
    (first,) = grave(wrong, INERTIA)
    assert first.kind == "inertia"
    assert f"--column {COLUMNS[channel]}:{unit}" in first.remedy.replace("'", "")
