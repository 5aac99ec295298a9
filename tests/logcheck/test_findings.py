"""What the log check says of recordings that are spoilt in a known way, and of those that are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.logcheck import Severity, checked, findings
from fricmodels.logcheck.balance import balances, best
from fricmodels.logcheck.view import Log
from fricmodels.recording import Recording
from fricmodels.rig import random_rig
from fricmodels.signals.wrapping import find_wrap, unwrap

INERTIA = 0.05


def drive(samples: int = 8000, seed: int = 0, noise: float = 0.005, **sensors: float) -> Recording:
    """Return a drive with inertia, viscous and Coulomb friction, moved by three sines, with noise on its sensors."""
    rng = np.random.default_rng(seed)
    step = 2e-3
    time = step * np.arange(samples)
    frequencies, sizes, phases = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0]), rng.uniform(0, 6, 3)
    angle = np.outer(time, frequencies) + phases
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / frequencies)
    torque = INERTIA * np.cos(angle) @ (sizes * frequencies) + 0.1 * velocity + 0.6 * np.sign(velocity)
    channels = {
        "time": time,
        "torque": torque + 0.01 * rng.standard_normal(samples),
        "velocity": velocity + noise * 2.6 * rng.standard_normal(samples),
        "position": position + 1e-5 * rng.standard_normal(samples),
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))


CLEAN = drive()


def changed(recording: Recording = CLEAN, **channels: np.ndarray) -> Recording:
    return replace(recording, channels={**recording.channels, **channels})


def without(name: str, recording: Recording = CLEAN) -> Recording:
    return replace(recording, channels={key: values for key, values in recording.channels.items() if key != name})


def kinds(recording: Recording, inertia: float | None = None, *, notes: bool = False) -> dict[str, Severity]:
    found = findings(unwrap(recording), inertia)
    return {one.kind: one.severity for one in found if notes or one.severity is not Severity.NOTE}


def late(values: np.ndarray, samples: int) -> np.ndarray:
    return np.r_[np.full(samples, values[0]), values[:-samples]]


def noise_with_memory(samples: int) -> np.ndarray:
    from scipy.signal import lfilter

    white = np.random.default_rng(3).standard_normal(samples)
    return np.asarray(lfilter([np.sqrt(1 - 0.95**2)], [1.0, -0.95], white))


STOP, WARN = Severity.STOP, Severity.WARN
SPOILT = {
    "sign": (changed(torque=-CLEAN.torque), "torque-sign", STOP),
    "sign without velocity": (without("velocity", changed(torque=-CLEAN.torque)), "torque-sign", STOP),
    "velocity in degrees": (changed(velocity=np.degrees(CLEAN.velocity)), "unit", STOP),
    "position in degrees": (changed(position=np.degrees(CLEAN["position"])), "unit", STOP),
    "velocity in rpm": (changed(velocity=30 / np.pi * CLEAN.velocity), "unit", STOP),
    "velocity turned": (changed(velocity=-CLEAN.velocity), "velocity-sign", STOP),
    "position turned": (changed(position=-CLEAN["position"]), "velocity-sign", WARN),
    "gear": (changed(velocity=7.0 * CLEAN.velocity), "velocity-scale", WARN),
    "other motion": (changed(position=np.roll(CLEAN["position"], 3000)[::-1]), "velocity-scale", WARN),
    "velocity and position": (
        changed(velocity=CLEAN["position"], position=CLEAN.velocity),
        "swapped-columns",
        STOP,
    ),
    "torque and velocity": (changed(velocity=CLEAN.torque, torque=CLEAN.velocity), "swapped-columns", STOP),
    "late velocity": (changed(velocity=late(CLEAN.velocity, 4)), "velocity-lag", WARN),
    "late torque": (changed(torque=late(CLEAN.torque, 8)), "torque-delay", WARN),
    "clipped": (changed(torque=np.clip(CLEAN.torque, -0.9, 0.9)), "saturation", WARN),
    "gap": (CLEAN.select(np.r_[0:4000, 4400:8000]), "gap", WARN),
    "false stamps": (
        changed(time=CLEAN.time + 4e-4 * np.random.default_rng(1).uniform(-1, 1, 8000)),
        "false-stamps",
        WARN,
    ),
    "a bad sample": (changed(torque=np.where(np.arange(8000) == 5000, 40.0, CLEAN.torque)), "spike", WARN),
    "many bad samples": (changed(torque=np.where(np.arange(8000) % 37, 1.0, 30.0) * CLEAN.torque), "spike", WARN),
    "velocity without its sign": (changed(velocity=np.abs(CLEAN.velocity)), "velocity-magnitude", STOP),
    "a bad position": (changed(position=np.where(np.arange(8000) == 99, -90.0, CLEAN["position"])), "spike", WARN),
    "polled": (changed(velocity=np.repeat(CLEAN.velocity[::3], 3)[:8000]), "repeated-samples", WARN),
    "coarse": (changed(torque=0.2 * np.round(CLEAN.torque / 0.2)), "quantisation", WARN),
    "coloured": (changed(velocity=CLEAN.velocity + 0.12 * noise_with_memory(8000)), "coloured-noise", WARN),
    "voltage": (changed(torque=CLEAN.torque + 2.0 * CLEAN.velocity), "not-a-torque", WARN),
    "no motion": (changed(**{n: 1e-3 * CLEAN[n] for n in ("position",)}, velocity=CLEAN.velocity * 1e-3
                          + 0.02 * np.random.default_rng(2).standard_normal(8000)), "little-motion", WARN),
    "one way": (changed(velocity=CLEAN.velocity + 12.0, position=CLEAN["position"] + 12.0 * CLEAN.time),
                "little-motion", WARN),
}  # fmt: skip


def test_a_viscous_part_that_a_coulomb_part_cancels_is_no_voltage():
    """A fit may give both large values of opposite signs: the velocity alone explains little of the torque."""
    spoilt = changed(torque=CLEAN.torque + 0.6 * CLEAN.velocity - 1.9 * np.sign(CLEAN.velocity))
    found = best(balances(Log(spoilt)))
    assert found is not None
    assert found.share("K_v") ** 2 > 0.75 > 0.5 > found.explained_alone("K_v")
    assert "not-a-torque" not in kinds(spoilt, INERTIA)


@pytest.mark.parametrize(
    ("columns", "asked"),
    [
        ({"current": "current=Iq:A"}, False),
        ({"current": "current=Iq"}, True),
        ({"current": "current=Iq:A", "torque": "torque=U:V"}, True),
        ({}, True),
    ],
)
def test_a_current_whose_column_says_its_unit_is_no_voltage(columns: dict[str, str], asked: bool) -> None:
    spoilt = replace(changed(torque=CLEAN.torque + 2.0 * CLEAN.velocity), provenance={"columns": columns})
    assert ("not-a-torque" in kinds(spoilt)) == asked


@pytest.mark.parametrize(("resistance", "asked"), [(1.0, False), (8.0, True)])
def test_a_viscous_drive_with_its_own_inertia_gave_no_voltage(resistance: float, asked: bool) -> None:
    """A hydrostatic table has hardly any other friction; of a voltage the inertia is off by R/k."""
    spoilt = changed(torque=resistance * CLEAN.torque + 16.0 * CLEAN.velocity)
    assert "not-a-torque" in kinds(spoilt)
    assert ("not-a-torque" in kinds(spoilt, INERTIA)) == asked


def test_a_good_recording_is_accused_of_nothing():
    assert kinds(CLEAN, INERTIA) == {}
    assert kinds(without("position"), INERTIA) == {}
    assert kinds(without("velocity"), INERTIA) == {}


@pytest.mark.parametrize("name", SPOILT)
def test_what_is_spoilt_is_named(name):
    recording, kind, severity = SPOILT[name]
    assert kinds(recording).get(kind) == severity


def hanging(friction: float, seed: int = 1) -> Recording:
    """Return an arm that hangs and is swung, with a gravity as large as its inertia torque."""
    base = drive(8000, seed)
    velocity, position = base.velocity, base["position"]
    acceleration = np.gradient(velocity, base.time, edge_order=2)
    smooth = np.convolve(acceleration, np.ones(15) / 15, "same")
    torque = INERTIA * smooth + 0.6 * np.sin(position) + friction * (0.1 * velocity + 0.6 * np.sign(velocity))
    return changed(base, torque=torque + 0.01 * np.random.default_rng(seed).standard_normal(len(torque)))


def test_a_turned_torque_is_told_by_the_inertia_where_there_is_hardly_any_friction():
    recording = hanging(0.01)
    assert "torque-sign" not in kinds(recording)
    turned = changed(recording, torque=-recording.torque)
    (found,) = [one for one in findings(turned) if one.kind == "torque-sign"]
    assert found.severity is STOP
    assert "negative inertia" in found.text
    with_friction = changed(hanging(1.0), torque=-hanging(1.0).torque)
    assert kinds(with_friction)["torque-sign"] is STOP


def test_a_late_torque_that_makes_the_inertia_negative_is_not_turned():
    """Of viscous friction that is late by T the balance has an inertia of −K_v T, and a friction beyond chance.

    A load that is let down does more work than the friction takes up, so that the torque's work is negative.
    """
    fast = CLEAN.velocity - 3.0
    torque = late(fast, 10) + 7.0 + 0.01 * np.random.default_rng(4).standard_normal(len(fast))
    recording = changed(without("position"), velocity=fast, torque=torque)
    found = best(balances(Log(recording)))
    assert found is not None
    assert found.ratio({"J": 1.0}) < -10.0
    assert np.mean(torque * fast) < 0.0
    assert "torque-sign" not in kinds(recording)


@given(st.integers(0, 10**6), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
@settings(max_examples=15, deadline=None)
def test_findings_do_not_depend_on_the_size_of_force_and_angle_units(seed, force, length):
    """Of a linear axis, on which no unit is special; to a power of two, so that no digit changes."""
    sign = -1.0 if seed % 2 else 1.0
    f, x = 2.0 ** round(force), 2.0 ** round(length)
    base = replace(drive(4000, seed), motion=Motion.LINEAR)
    base = changed(base, torque=sign * base.torque)
    other = changed(base, torque=f * base.torque, velocity=x * base.velocity, position=x * base["position"])
    assert kinds(base) == kinds(other)
    assert ("torque-sign" in kinds(base)) == (sign < 0)


@pytest.mark.parametrize("excitation", ["sine", "multisine", "tracking", "trapezoid", "stair", "ramp"])
def test_drives_with_hidden_effects_are_accused_of_nothing_and_with_the_torque_turned_of_its_sign(excitation):
    hidden = {"sine": "cogging", "trapezoid": "rising-stiction", "ramp": "presliding"}.get(excitation)
    rig = random_rig(
        np.random.default_rng(5), [hidden] if hidden else (), excitation=excitation, samples=6000, noise_percent=1.0
    )
    recording = rig.simulate()
    assert kinds(recording, rig.inertia) == {}
    assert kinds(changed(recording, torque=-recording.torque))["torque-sign"] is STOP


def test_an_inertia_tells_that_it_is_the_velocity_that_is_a_tenth_of_its_unit():
    """A velocity in 0.1 rpm that is read in rpm; no unit that was given is proposed once more."""
    columns = {"velocity": "velocity=606Ch:rpm", "position": "position=6064h:count/65536"}
    tenfold = replace(changed(velocity=10 * CLEAN.velocity), provenance={"columns": columns})
    found = [one for one in findings(tenfold, INERTIA) if one.severity is STOP]
    assert [one.kind for one in found] == ["unit"]
    assert "--column 'velocity=606Ch:0.1 rpm'" in found[0].remedy
    assert kinds(tenfold) == {"velocity-scale": WARN}, "without an inertia it may be a gear"
    assert kinds(changed(velocity=10 * CLEAN.velocity), 0.1 * INERTIA).get("unit") is not STOP


@pytest.mark.parametrize(("period", "factor"), [(2 * np.pi, 4.0), (360.0, np.degrees(4.0)), (65536 * 0.001, 40.0)])
def test_a_wrapped_position_goes_on(period, factor):
    position = factor * CLEAN["position"]
    if period not in (2 * np.pi, 360.0):
        position = 0.001 * np.round(position / 0.001)
        period = 0.001 * 2 ** np.ceil(np.log2(np.ptp(position) / 0.001 / 1.5))
    wrapped = np.mod(position - np.median(position), period)
    wrap = find_wrap(wrapped, CLEAN.run)
    assert wrap is not None
    assert wrap.period == pytest.approx(period)
    again = unwrap(changed(position=wrapped))["position"]
    np.testing.assert_allclose(again - again[0], position - position[0], atol=1e-9)


@pytest.mark.parametrize("lost", [0.0, 0.02, 0.05])
def test_a_wrapped_position_goes_on_where_samples_are_lost(lost):
    position, time = np.degrees(4.0 * CLEAN["position"])[::5], CLEAN.time[::5]
    kept = np.random.default_rng(1).random(len(time)) >= lost
    run = np.zeros(int(kept.sum()), dtype=np.int64)
    channels = {"time": time, "torque": CLEAN.torque[::5], "position": np.mod(position, 360.0)}
    log = Recording("lost", CLEAN.motion, {name: values[kept] for name, values in channels.items()}, run)
    np.testing.assert_allclose(np.diff(unwrap(log)["position"]), np.diff(position[kept]), atol=1e-9)


def test_a_position_that_turns_or_jumps_otherwise_is_left_alone():
    assert find_wrap(CLEAN["position"], CLEAN.run) is None
    assert find_wrap(np.r_[np.zeros(50), np.full(50, 3.0), np.zeros(50)], np.zeros(150, dtype=np.int64)) is None
    saw = np.mod(np.arange(300) * 0.7, 5.0)
    assert find_wrap(saw, np.zeros(300, dtype=np.int64)) is None


def test_degrees_show_in_a_wrap_and_in_the_steps_of_an_encoder():
    degrees = np.degrees(4.0 * CLEAN["position"])
    wrapped = without("velocity", changed(position=np.mod(degrees - np.median(degrees), 360.0)))
    assert kinds(wrapped)["unit"] is STOP
    step = 360.0 / 2**14
    counted = without("velocity", changed(position=step * np.round(np.degrees(CLEAN["position"]) / step)))
    assert kinds(counted)["unit"] is STOP
    radians = 2 * np.pi / 2**14
    counted = without("velocity", changed(position=radians * np.round(CLEAN["position"] / radians)))
    assert "unit" not in kinds(counted)


def test_an_end_stop_is_met_in_full_motion():
    limit = np.quantile(CLEAN["position"], 0.7)
    beyond = CLEAN["position"] > limit
    found = kinds(changed(position=np.minimum(CLEAN["position"], limit), velocity=np.where(beyond, 0, CLEAN.velocity)))
    assert found["end-stop"] is WARN


def test_true_jitter_is_only_noted():
    rng = np.random.default_rng(0)
    time = CLEAN.time + 4e-4 * rng.uniform(-1, 1, 8000)
    again = {name: np.interp(time, CLEAN.time, CLEAN[name]) for name in ("torque", "velocity", "position")}
    found = kinds(changed(time=time, **again), notes=True)
    assert found["jitter"] is Severity.NOTE
    assert "false-stamps" not in found


def test_checked_stops_goes_on_when_trusted_and_remembers():
    wrong = changed(torque=-CLEAN.torque)
    with pytest.raises(InputError, match=r"wrong sign.*--column 'torque=COLUMN:-1 N.m', or go on with --trust"):
        checked(wrong)
    said: list[str] = []
    trusted = checked(wrong, trust=True, warn=said.extend)
    assert [one["kind"] for one in trusted.provenance["findings"]] == ["torque-sign"]
    assert len(said) == 1
    assert said[0].startswith("log: the torque has the wrong sign")


def test_short_recordings_are_no_error():
    for samples in (2, 3, 5, 17, 40, 70, 130):
        findings(CLEAN.select(np.arange(samples)))
    constant = changed(velocity=np.r_[1.0, np.zeros(7999)], torque=np.ones(8000))
    findings(without("position", constant))


def test_a_drive_that_stands_still_is_not_a_sensor_that_repeats_itself():
    """Nor are counts that were printed to five digits."""
    jerky = CLEAN["position"].copy()
    for start in range(500, 7500, 500):
        jerky[start + 3 :] -= jerky[start + 3] - jerky[start]
        jerky[start : start + 3] = jerky[start]
    assert "repeated-samples" not in kinds(without("velocity", changed(position=jerky)))
    counts = 9.5873799e-5 * np.round(30.0 * CLEAN["position"] / 9.5873799e-5)
    printed = np.array([float(f"{value:.4e}") for value in counts])
    assert "repeated-samples" not in kinds(without("velocity", changed(position=printed)))


@pytest.mark.parametrize(
    ("column", "said"),
    [
        ("velocity=speed:deg/s", "9 deg/s (0.1571 rad/s)"),
        ("velocity=speed:-1 rpm", "1.5 rpm (0.1571 rad/s)"),
        ("velocity=speed:rad/s", "0.1571 rad/s"),
        ("velocity=speed", "0.1571 rad/s"),
    ],
)
def test_a_size_is_said_in_the_unit_of_its_column(column: str, said: str) -> None:
    log = Log(replace(CLEAN, provenance={"columns": {"velocity": column}}))
    assert log.size("velocity", np.pi / 20) == said


def test_a_torque_that_is_a_current_has_the_size_of_a_torque() -> None:
    log = Log(replace(CLEAN, provenance={"columns": {"current": "current=iq:A"}, "torque_constant": 0.5}))
    assert log.size("torque", 0.25) == "0.25 N m"


def test_what_is_large_for_longer_or_switched_is_no_spike() -> None:
    blow = np.where(np.abs(np.arange(8000) - 5000) < 2, 40.0, CLEAN.torque)
    relay = np.where(np.arange(8000) % 977 == 0, 3.0, -3.0)
    for torque in (CLEAN.torque, blow, relay, np.round(CLEAN.torque)):
        assert not [found for found in findings(changed(torque=torque)) if found.kind == "spike"]


@pytest.mark.parametrize(("unit", "said"), [("rad", "steps of 0.5 rad"), ("", "steps of 0.5,")])
@pytest.mark.parametrize("column", ["other.elbow=q2:rad", "other.elbow=q2", "other.elbow=q2:deg"])
def test_a_further_channel_on_a_grid_is_said_with_its_unit(column: str, unit: str, said: str) -> None:
    elbow = 0.5 * np.round(4.0 * np.sin(3.0 * CLEAN.time) + 0.3 * CLEAN.velocity)
    recording = replace(changed(**{"other.elbow": elbow}), units={"other.elbow": unit})
    recording = replace(recording, provenance={"columns": {"other.elbow": column}})
    found = [one.text for one in findings(recording) if one.channel == "other.elbow"]
    assert any(said in text for text in found)


def test_a_further_channel_that_hardly_takes_values_is_said_and_a_smooth_one_is_not() -> None:
    noise = np.random.default_rng(0).standard_normal(8000)
    for values, kinds_of in ((np.full(8000, 3.0), []), (np.arange(8000.0), []), (np.sign(noise), ["quantisation"])):
        found = findings(changed(**{"other.x": values}))
        assert [one.kind for one in found if one.channel == "other.x"] == kinds_of


@pytest.mark.parametrize(("unit", "said"), [("0.5 deg", "2 × 0.5 deg ("), ("deg", "1 deg (")])
def test_a_unit_that_has_a_size_is_not_run_together_with_a_number(unit: str, said: str) -> None:
    log = Log(replace(CLEAN, provenance={"columns": {"position": f"position=q:{unit}"}}))
    assert log.size("position", np.pi / 180.0).startswith(said)


def test_a_velocity_that_jumps_within_its_range_is_seen_by_the_position() -> None:
    """Ten samples off by a part of the range; the position goes on as before. Spikes of the position are none."""
    rng = np.random.default_rng(5)
    at = 100 + 780 * np.arange(10) + rng.integers(0, 100, 10)
    velocity, position = CLEAN.velocity.copy(), CLEAN["position"].copy()
    size = 0.3 * np.ptp(velocity)
    velocity[at] -= np.sign(velocity[at]) * size
    found = [one for one in findings(changed(velocity=velocity)) if one.kind == "spike"]
    assert [one.channel for one in found] == ["velocity"]
    assert found[0].text.startswith("10 samples of the velocity")
    position[at] += 0.1 * np.ptp(position)
    assert not [one for one in findings(changed(position=position)) if one.channel == "velocity"]


@pytest.mark.parametrize("samples", [300, 450])
def test_a_short_log_tells_the_sign_of_its_torque(samples: int) -> None:
    """With fewer parts than 32, each of which may go together in any way."""
    short = replace(CLEAN.select(slice(0, 10 * samples, 10)), name="short")
    assert "torque-sign" not in kinds(short, INERTIA)
    assert kinds(changed(short, torque=-short.torque), INERTIA)["torque-sign"] is STOP


@pytest.mark.parametrize("samples", [400, 600])
def test_a_coulomb_friction_that_drives_speaks_against_an_exchange(samples: int) -> None:
    """One sine without noise: the velocity goes with the torque less its jumps, as exactly as the other way round."""
    time = 0.01 * np.arange(samples)
    velocity = np.sin(2 * np.pi * time)
    torque = 0.1 * velocity + 0.2 * np.sign(velocity) + 0.02 * np.cos(2 * np.pi * time)
    channels = {"time": time, "torque": np.round(torque, 6), "velocity": np.round(velocity, 6)}
    sine = Recording("sine", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))
    assert "swapped-columns" not in kinds(sine, 0.02)
