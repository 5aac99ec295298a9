"""Play: what is missing within the gap, the blow at its end, and the simulated drive, whose play is written apart."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.score.torque import filtered_torque_error
from fricmodels.signals import lanczos_derivative, prepare
from fricmodels.simulation import simulate

Array = NDArray[np.float64]

J_L, WIDTH, BRAKING, SPEED, DRY = 2.0, 0.03, 1.5, 3.0, 3.0
VALUES = {"J_l": J_L, "w": WIDTH, "a": BRAKING, "omega_v": SPEED, "F": DRY, "b": 0.0}


def drive(inertia: float = 4.5) -> Drive:
    return Drive(Model.only(load().effects["backlash"]()), inertia)


def values(**changed: float) -> dict[str, float]:
    return {f"backlash.{symbol}": value for symbol, value in {**VALUES, **changed}.items()}


def turning(rate: float = 1000.0, pace: float = 1.0, load_torque: Array | float = 0.0) -> Recording:
    """A motor that turns evenly at ``pace`` rad/s² from −1 to 1 rad/s, twice there and once back."""
    leg = 2.0 / pace
    time = np.arange(round(3 * leg * rate)) / rate
    phase = np.mod(time, 2 * leg)
    acceleration = np.where(phase < leg, pace, -pace)
    velocity = np.where(phase < leg, -1 + pace * phase, 3 - pace * phase)
    channels = {"time": time, "torque": 0 * time, "velocity": velocity, "acceleration": acceleration}
    given = np.broadcast_to(np.asarray(load_torque, dtype=float), time.shape)
    return Recording("made", Motion.ROTARY, {**channels, "load_torque": given}, np.zeros(len(time), dtype=np.int64))


def test_only_the_gap_is_crossed_without_the_load() -> None:
    """At a pace at which its friction keeps the load on the flank, it is missing from the turn on, over the width."""
    recording = turning()
    found = drive().friction(recording, values())
    time, velocity, acceleration = recording.time, recording.velocity, recording["acceleration"]
    crossing = np.sqrt(2 * WIDTH)
    for turn in (1.0, 3.0, 5.0):
        gap = (time > turn + 0.01) & (time < turn + crossing - 0.01)
        expected = -J_L * (acceleration + BRAKING * np.sign(velocity) + BRAKING / SPEED * velocity)
        np.testing.assert_allclose(found[gap], expected[gap], rtol=1e-9)
        after = (time > turn + crossing + 0.05) & (time < turn + 1.9)
        assert np.max(np.abs(found[after])) < 1e-4


@pytest.mark.parametrize("rate", [300.0, 1000.0, 10_000.0])
def test_the_blow_is_the_momentum_of_the_load(rate: float) -> None:
    """However finely it is sampled: J_l times the speed at which the motor meets the load at rest."""
    recording = turning(rate)
    found = drive().friction(recording, values())
    crossing = np.sqrt(2 * WIDTH)
    gap = (recording.time >= 1.0) & (recording.time < 1.9)
    missing = np.minimum(found[gap] * np.sign(recording.velocity[gap]), 0)
    blow = np.sum(found[gap] - missing) / rate
    assert blow == pytest.approx(J_L * crossing, rel=3 / (rate * crossing))


def test_a_load_that_the_load_torque_presses_to_one_flank_never_leaves_it() -> None:
    pressed = turning(load_torque=4 * DRY)
    assert np.any(drive().friction(turning(), values()))
    assert not np.any(drive().friction(pressed, values()))


@pytest.mark.parametrize("share", [-0.6, 0.3])
def test_a_constant_load_torque_is_a_difference_between_the_directions(share: float) -> None:
    loaded = drive().friction(turning(load_torque=share * DRY), values())
    np.testing.assert_allclose(drive().friction(turning(), values(b=share)), loaded, rtol=1e-12)
    assert np.max(np.abs(loaded - drive().friction(turning(), values()))) > 0.1


def test_a_recording_without_a_load_torque_has_none() -> None:
    with_none = turning()
    without = Recording(
        "made", with_none.motion, {k: v for k, v in with_none.channels.items() if k != "load_torque"}, with_none.run
    )
    np.testing.assert_array_equal(drive().friction(without, values()), drive().friction(with_none, values()))
    assert "load_torque" in drive().model.needs - drive().model.required


def test_a_motor_that_brakes_harder_than_the_load_by_itself_leaves_it_before_the_turn() -> None:
    recording = turning(pace=6.0)
    found = drive().friction(recording, values())
    before = (recording.time > 0.35) & (recording.time < 0.36)
    assert np.any(found[before] != 0)


def test_a_shifted_start_and_the_other_direction_change_nothing_but_the_sign() -> None:
    recording = turning()
    mirrored = recording.with_channels(velocity=-recording.velocity, acceleration=-recording["acceleration"])
    later = recording.with_channels(time=recording.time + 7.0)
    there = drive().friction(recording, values())
    moving = recording.velocity != 0
    np.testing.assert_allclose(drive().friction(mirrored, values())[moving], -there[moving], atol=1e-9)
    np.testing.assert_allclose(drive().friction(later, values()), there, atol=1e-6 * np.max(np.abs(there)))
    harder = drive().friction(recording, values(b=0.3))
    easier = drive().friction(mirrored, values(b=-0.3))
    np.testing.assert_allclose(easier[moving], -harder[moving], atol=1e-9)


def test_a_simulated_blow_conserves_momentum() -> None:
    """A motor without friction: it crosses the gap with its own inertia, and strikes."""
    inertia, time = 4.5, np.arange(3000) / 1000.0
    torque = np.where(time < 0.1, -1.0, 2.0)
    tied = simulate(drive(inertia), values(a=50.0), time, torque, substeps=8).velocity
    turn = int(np.argmax((tied > 0) & (time > 0.1)))
    free = (time > time[turn] + 0.01) & (tied < 0.9 * np.max(tied[turn : turn + 400])) & (time < time[turn] + 0.1)
    slope = np.polyfit(time[free], tied[free], 1)[0]
    assert slope > 2.0 / inertia  # the load's part of the friction and inertia is missing


EVEN, UNEVEN = {"viscous": 4.0, "coulomb": 10.0}, {"viscous": (4.0, 4.0), "coulomb": (13.0, 7.0)}
RIGS = {
    "unloaded": {},
    "uneven": {"friction": UNEVEN},
    "loaded": {"load": {"bias": 1.0, "amplitude": 9.0, "frequency": 0.31}},
    "fast": {"excitation": {"kind": "tracking", "velocity": 2.0, "frequency": 0.5, "lines": 5, "bandwidth": 15.0}},
}


@pytest.mark.parametrize("name", RIGS)
def test_the_simulated_drive_leaves_what_the_effect_says(name: str) -> None:
    """Its play has another contact, a spring and a damper, and its load sticks and slides between the samples."""
    play = {"name": "backlash", "gap": 0.04, "contact_frequency": 120.0, "damping_ratio": 0.7}
    made = {
        "inertia": 2.0,
        "friction": EVEN,
        "effects": [{**play, "load_inertia_share": 0.4, "load_friction_share": 0.6}],
        "excitation": {"kind": "ramp", "velocity": 2.0, "period": 4.0, "bandwidth": 15.0},
        "rate": 500,
        "samples": 10_000,
        "seed": 3,
        **RIGS[name],
    }
    rig = Rig.model_validate(made)
    recording = rig.noiseless().simulate()
    _, acceleration = lanczos_derivative(recording.time, recording.velocity, 1)
    recording = recording.with_channels(acceleration=acceleration)
    truth = {"J_l": 0.8, "w": 0.04, "a": 6.0 / 0.8, "omega_v": 10.0 / 4.0, "F": 6.0}
    truth["b"] = 0.3 if name == "uneven" else 0.0
    said = drive(2.0).friction(recording, values(**truth))
    left = rig.effect_torque()
    clear = np.convolve(np.abs(recording.velocity) < 0.02, np.ones(5), "same") == 0

    def smooth(torque: Array) -> Array:
        return np.convolve(torque, np.hanning(18)[1:-1] / np.sum(np.hanning(18)), "same")

    kept = np.convolve(~clear, np.ones(17), "same") == 0
    before, after = smooth(left)[kept], smooth(left - said)[kept]
    assert np.sum(after**2) < 0.15 * np.sum(before**2)


def test_a_motor_that_is_pushed_at_rest_may_have_closed_its_gap() -> None:
    """It stands in the gap after a move, as far as its samples tell, and is held by friction that only motor and load
    have together: sensors do not see by how little the gap is open. More than both is an error all the same."""
    rate, friction, whole = 500.0, 4.0, Drive(Model.parse("coulomb-viscous+backlash"), 4.5)
    time = np.arange(round(4 * rate)) / rate
    velocity = np.clip(0.68 - 1.7 * np.abs(time - 1.0), 0.0, None)  # its friction lets the load run on a little
    own = {"K_v": 0.5, "K_c": friction, **values()}
    moving = np.where(velocity > 0.0, 4.5 * np.gradient(velocity, time) + 0.5 * velocity + friction, 0.0)

    def at_rest(pushed: float) -> Array:
        torque = np.where(time > 2.5, pushed, moving)
        recording = Recording(
            "made", Motion.ROTARY, {"time": time, "torque": torque, "velocity": velocity}, np.zeros(len(time), np.int64)
        )
        ready = prepare(recording)
        states = whole.states(ready, whole.split(own)[1])
        assert 0.0 < abs(states[0][-1]) < 0.5 * WIDTH, "it stands within the gap"
        return filtered_torque_error(whole, own, ready)[time > 3.0]

    in_gap = friction - J_L * BRAKING
    assert np.all(at_rest(0.5 * (in_gap + friction)) == 0.0)
    np.testing.assert_allclose(at_rest(friction + 1.0), 1.0, atol=1e-9)
