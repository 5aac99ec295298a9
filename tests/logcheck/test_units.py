"""Units that the log check names, and channels that stand still."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.logcheck import Severity, findings
from fricmodels.recording import Recording

INERTIA = 0.02
DEG = 180.0 / np.pi
RPM = 30.0 / np.pi


def drive(angle: float = 1.0, speed: float = 1.0, **units: str) -> Recording:
    """Return a drive whose position and velocity were logged in other units, and read as they were given."""
    time = 2e-3 * np.arange(8000)
    frequencies, sizes = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0])
    phase = np.outer(time, frequencies)
    velocity, position = np.cos(phase) @ sizes, np.sin(phase) @ (sizes / frequencies)
    acceleration = -np.sin(phase) @ (sizes * frequencies)
    rng = np.random.default_rng(0)
    torque = INERTIA * acceleration + 0.05 * velocity + 0.3 * np.sign(velocity) + 0.002 * rng.standard_normal(8000)
    named = {"torque": "torque=torque_Nm", "velocity": "velocity=v", "position": "position=q"}
    columns = named | {channel: f"{named[channel]}:{unit}" for channel, unit in units.items()}
    channels = {
        "time": time,
        "torque": torque,
        "velocity": speed * (velocity + 0.002 * rng.standard_normal(8000)),
        "position": angle * (position + 1e-4 * rng.standard_normal(8000)),
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(8000, np.int64), provenance={"columns": columns})


def on_units(recording: Recording, inertia: float | None = None) -> list[tuple[Severity, str]]:
    return [(one.severity, one.remedy) for one in findings(recording, inertia) if one.kind == "unit"]


def test_an_inertia_and_the_ratio_of_the_motions_say_the_same() -> None:
    """Position in degrees, velocity in rpm: the inertia alone guessed turns for the position."""
    both = "give the unit, as in --column position=q:deg --column velocity=v:rpm"
    assert on_units(drive(DEG, RPM), INERTIA) == [(Severity.STOP, both)]
    assert on_units(drive(DEG, RPM)) == [(Severity.WARN, both)]


@pytest.mark.parametrize("given", ["turn", ""])
def test_a_unit_that_was_given_stays(given: str) -> None:
    units = {"velocity": "rpm"} | ({"position": given} if given else {})
    read = drive(DEG * (2.0 * np.pi if given else 1.0), 1.0, **units)
    assert [remedy for _, remedy in on_units(read, INERTIA)] == ["give the unit, as in --column position=q:deg"]


def test_a_constant_torque_is_told_and_is_no_gravity() -> None:
    clean = drive()
    found = findings(replace(clean, channels={**clean.channels, "torque": np.full(8000, 0.3)}))
    assert [(one.kind, one.channel) for one in found if one.severity is not Severity.NOTE] == [
        ("constant-channel", "torque")
    ]


def test_a_dead_position_is_told_and_colours_no_noise() -> None:
    clean = drive()
    found = findings(replace(clean, channels={**clean.channels, "position": np.zeros(8000)}))
    assert [(one.kind, one.channel) for one in found if one.severity is not Severity.NOTE] == [
        ("constant-channel", "position")
    ]


def test_rpm_are_no_unit_of_a_position() -> None:
    """Gravity after 60 of a velocity in rpm: asked only where no position was measured, and of the velocity."""
    time = 2e-3 * np.arange(20000)
    velocity = 6.0 * np.sin(0.7 * time) + 3.0 * np.sin(1.9 * time)
    angle = np.r_[0.0, np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * 2e-3)]
    torque = 3.0 * np.sin(angle) + 0.1 * velocity + 0.01 * np.random.default_rng(0).standard_normal(20000)
    channels = {"time": time, "torque": torque, "velocity": RPM * velocity}
    found = on_units(Recording("log", Motion.ROTARY, channels, np.zeros(20000, np.int64)))
    assert found == [(Severity.WARN, "if so give the unit, as in --column velocity=COLUMN:rpm")]
    also = {**channels, "position": RPM * angle}
    assert not any("position=COLUMN:rpm" in remedy for _, remedy in on_units(
        Recording("log", Motion.ROTARY, also, np.zeros(20000, np.int64))
    ))  # fmt: skip


def test_a_linear_axis_has_a_force() -> None:
    clean = drive()
    linear = replace(
        clean, motion=Motion.LINEAR, channels={**clean.channels, "torque": np.full(8000, 0.3)}, provenance={}
    )
    said = [str(one) for one in findings(linear) if one.kind == "constant-channel"]
    assert len(said) == 1
    assert said[0].startswith("the force is 0.3 N throughout")


@pytest.mark.parametrize("both", [False, True])
def test_only_what_is_in_degrees_is_proposed_as_such(both: bool) -> None:
    """Who did as told was told the opposite next."""
    clean, step = drive(), 360.0 / 2**14
    degrees = step * np.round(np.degrees(clean["position"]) / step)
    velocity = np.degrees(clean.velocity) if both else clean.velocity
    found = findings(replace(clean, channels={**clean.channels, "position": degrees, "velocity": velocity}))
    (remedy,) = {one.remedy for one in found if one.kind == "unit" and "comes in steps" in one.text}
    assert ("deg/s" in remedy) is both


def minutes(inertia_is_told: bool) -> tuple[str, str]:
    clean = drive()
    columns = {"time": "time=t", **clean.provenance["columns"]}
    read = replace(clean.with_channels(time=clean.time / 60.0), provenance={"columns": columns})
    found = findings(read, INERTIA if inertia_is_told else None)[0]
    return found.kind, found.remedy


def test_a_time_in_minutes_is_told_by_the_ratio_of_the_motions_and_by_the_inertia() -> None:
    """The inertia is sixty times as large, near to the 57 of degrees; the ratio of the motions is 1/60, and no 1/57."""
    assert minutes(True) == ("unit", "give the unit, as in --column time=t:min")
    assert minutes(False) == ("velocity-scale", "if it is a unit, give it, as in --column time=t:min")


@pytest.mark.parametrize(("times", "unit"), [(1e9, "ns"), (1e6, "us"), (1e3, ""), (1.0, ""), (1e-3, "")])
def test_samples_that_are_farther_apart_than_those_of_any_drive(times: float, unit: str) -> None:
    """Two milliseconds in nanoseconds are 23 days; two seconds may be."""
    clean = drive()
    columns = {"time": "time=t", "torque": "torque=torque_Nm", "velocity": "velocity=v"}
    channels = {name: clean[name] for name in ("torque", "velocity")}
    read = replace(clean, channels={"time": times * clean.time, **channels}, provenance={"columns": columns})
    said = [one.remedy for one in findings(read) if one.channel == "time" and one.kind == "unit"]
    assert said == ([f"if it is in {unit} say so, as in --column time=t:{unit}"] if unit else [])


@pytest.mark.parametrize(("counts_a_turn", "told"), [(4096, True), (1440, True), (0, False)])
def test_a_position_in_whole_numbers_is_said_to_be_counts(counts_a_turn: int, told: bool) -> None:
    """No encoder has steps of one radian; one of hundredths is not whole."""
    recording = drive()
    scale = counts_a_turn / (2 * np.pi) if counts_a_turn else 100.0
    position = np.round(scale * recording["position"]) / (1.0 if counts_a_turn else 100.0)
    counted = recording.with_channels(derived=False, position=position)
    said = [one for one in findings(counted) if "counts of an encoder" in one.text]
    assert bool(said) is told
    assert all("--column position=q:count/4096" in one.remedy for one in said)
