"""The kink of the velocity at a reversal, which smoothing rounds off."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals import stretches
from fricmodels.simulation import simulate
from fricmodels.weakform.kinks import with_kinks
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.smoothed import smoothed

INERTIA, COULOMB, STEP = 0.003, 0.06, 0.002
DRIVE = Drive(Model.parse("coulomb-viscous"), INERTIA)
FRICTION = {"J": INERTIA, "K_v": 0.01, "K_c": COULOMB}
PUSH = ((1.3, 0.09), (2.9, 0.08), (4.1, 0.05))


def clock(count: int = 6000) -> Array:
    return np.asarray(STEP * np.arange(count), dtype=np.float64)


def push(time: Array) -> Array:
    return np.asarray(sum(size * np.sin(2 * np.pi * f * time + f) for f, size in PUSH))


def driven() -> tuple[Array, Array, Array]:
    """Return time, torque and velocity of a drive whose torque does not jump where it turns."""
    time = clock()
    torque = push(time)
    return time, torque, simulate(DRIVE, FRICTION, time, torque, substeps=20).velocity


def recorded(time: Array, torque: Array, velocity: Array, counts: float) -> Recording:
    """Return what an encoder and a current sensor record."""
    position = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (velocity[1:] + velocity[:-1]))])
    step = 2 * np.pi / counts
    channels = {"time": time, "torque": torque, "position": step * np.round(position / step)}
    return ready(Recording("driven", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))


def given_back(recording: Recording, friction: dict[str, float] = FRICTION) -> tuple[Array, Array]:
    """Return the smoothed velocity without and with its kinks."""
    motion = smoothed(recording)
    limits = DRIVE.sticking_interval(motion.recording, friction)
    slow = np.zeros(len(recording), dtype=bool)
    args = motion.recording, motion.velocity, motion.half_width, slow, limits, friction["J"]
    return motion.velocity, with_kinks(*args)


def about_reversals(velocity: Array) -> Array:
    turns = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    near = np.unique(turns[:, None] + np.arange(-4, 6))
    return near[(near >= 20) & (near < len(velocity) - 20)]


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_coarse_encoder_has_its_reversals_back(direction: float) -> None:
    time, torque, velocity = driven()
    plain, kinked = given_back(recorded(time, direction * torque, direction * velocity, 2048))
    near = about_reversals(velocity)
    before, after = (np.sqrt(np.mean((one - direction * velocity)[near] ** 2)) for one in (plain, kinked))
    assert after < 0.6 * before
    changed = plain != kinked
    assert changed.any()
    assert np.mean(changed) < 0.3, "about reversals alone"


def test_a_drive_that_is_held_to_a_smooth_motion_gets_no_kink() -> None:
    """Its controller makes up for the friction that jumps: so does the torque, and the velocity has no kink."""
    time = clock()
    velocity: Array = np.asarray(2.0 * np.cos(2 * np.pi * 1.3 * time) + 1.5 * np.cos(2 * np.pi * 2.9 * time + 1.0))
    torque = np.asarray(INERTIA * np.gradient(velocity, STEP) + 0.01 * velocity + COULOMB * np.sign(velocity))
    plain, kinked = given_back(recorded(time, torque, velocity, 2048))
    near = about_reversals(velocity)
    wrong, right = (np.sqrt(np.mean((one - velocity)[near] ** 2)) for one in (kinked, plain))
    assert wrong < 1.02 * right


def test_a_friction_that_is_not_there_gives_nothing_back() -> None:
    """Without friction the velocity has no kink, whatever a model says."""
    time = clock()
    torque = push(time)
    free = simulate(DRIVE, {**FRICTION, "K_c": 0.0}, time, torque, substeps=20).velocity
    plain, kinked = given_back(recorded(time, torque, free, 2048))
    assert np.abs(kinked - plain).max() < 0.2 * np.abs(plain).std()
    near = about_reversals(free)
    wrong, right = (np.sqrt(np.mean((one - free)[near] ** 2)) for one in (kinked, plain))
    assert wrong < 1.2 * right


def test_a_filter_that_no_noise_makes_wide_takes_nothing() -> None:
    time, torque, velocity = driven()
    plain, kinked = given_back(recorded(time, torque, velocity, 1e9))
    assert kinked is plain


def test_nothing_is_given_back_across_a_gap() -> None:
    """Where a stretch ends the drive may have turned unseen; no sample within the filter's reach of it changes."""
    time, torque, velocity = driven()
    turns = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)[4::5]
    lost = np.unique(turns[:, None] + np.arange(4, 60))  # from four samples behind a reversal on
    kept = np.setdiff1d(np.arange(len(time)), lost)
    recording = ready(recorded(time, torque, velocity, 2048).select(kept))
    plain, kinked = given_back(recording)
    reach = smoothed(recording).half_width + recording.derived_over
    assert reach > 5
    parts = stretches(recording.time, recording.run)
    assert len(parts) == 4
    for part in parts:
        same = (plain == kinked)[part]
        assert same[:reach].all()
        assert same[-reach:].all()
    assert (plain != kinked).any()


def test_runs_whose_clocks_meet_are_two() -> None:
    """The last sample of one has the time of the first sample of the next."""
    time, torque, velocity = driven()
    half = len(time) // 2
    one, two = (recorded(time[:half], torque[part], velocity[part], 2048) for part in (slice(half), slice(half, None)))
    channels = {name: np.concatenate([one[name], two[name]]) for name in ("torque", "position")}
    channels["time"] = np.concatenate([one.time, one.time[-1] + two.time])
    both = ready(Recording("both", Motion.ROTARY, channels, np.repeat([0, 1], half)))
    plain, kinked = given_back(both)
    near = about_reversals(velocity)
    before, after = (np.sqrt(np.mean((found - velocity)[near] ** 2)) for found in (plain, kinked))
    assert after < 0.6 * before
