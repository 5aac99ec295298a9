"""A torque that is a command of one size for each direction of the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from fricmodels.diagnosis import compare, improve
from fricmodels.dimension import Motion
from fricmodels.effects.run_offset import RunOffset
from fricmodels.errors import InputError
from fricmodels.logcheck import Severity, findings
from fricmodels.recording import Recording
from fricmodels.signals.switched import one_value_in_each

MASS, VISCOUS, COULOMB, PERIOD, SAMPLES = 6.9, 340.0, 28.7, 5e-3, 120


def responses(*commands: float, gap: float = 0.0) -> Recording:
    """Return step responses of a cart from rest, each a run; the position in steps of 15 micrometres."""
    time = PERIOD * np.arange(SAMPLES)
    parts = []
    for command in commands:
        decay = np.exp(-VISCOUS / MASS * PERIOD)
        final = (command - COULOMB * np.sign(command)) / VISCOUS
        velocity = lfilter([1.0 - decay], [1.0, -decay], np.r_[0.0, np.full(SAMPLES - 1, final)])
        position = final * time - MASS / VISCOUS * velocity  # the exact integral of it
        parts.append(np.round(position / 1.5e-5) * 1.5e-5)
    run = np.repeat(np.arange(len(commands)), SAMPLES)
    channels = {"time": time[np.tile(np.arange(SAMPLES), len(commands))] + 2.0 * run}
    channels |= {"torque": np.repeat(np.array(commands), SAMPLES), "position": np.concatenate(parts)}
    return Recording("cart", Motion.LINEAR, channels, run.astype(np.int64))


def said(recording: Recording, inertia: float | None = None) -> Severity | None:
    return next((one.severity for one in findings(recording, inertia) if one.kind == "one-command"), None)


@pytest.mark.parametrize("backward", [-150.0, -100.0])
def test_one_size_each_way_stops(backward: float) -> None:
    recording = responses(150.0, backward)
    assert said(recording) is Severity.STOP
    assert said(recording, MASS) is None


def test_several_sizes_tell_the_drive() -> None:
    assert said(responses(100.0, -100.0, 200.0, -200.0)) is None


def test_a_torque_that_never_changes_is_another_finding() -> None:
    recording = responses(150.0, 150.0)
    assert said(recording) is None
    assert "little-motion" in {one.kind for one in findings(recording)}


def begun_from_rest(recording: Recording, rows: int) -> Recording:
    """Return a recording of one run before which nothing pushed and nothing moved."""
    before = np.zeros(rows)
    time = np.r_[recording.time[0] + PERIOD * (np.arange(rows) - rows), recording.time]
    channels = {name: np.r_[before, values] for name, values in recording.channels.items()}
    return replace(recording, channels={**channels, "time": time}, run=np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("command", [150.0, -150.0])
def test_one_step_in_one_direction_stops_as_every_fit_of_it_does(command: float) -> None:
    recording = begun_from_rest(responses(command), 60)
    (stop,) = [one for one in findings(recording) if one.kind == "one-command"]
    assert stop.severity is Severity.STOP
    assert f"is {command:g} N wherever the axis moves and nothing else" in stop.text
    assert said(recording, MASS) is None
    with pytest.raises(InputError, match="give the inertia"):
        compare(recording, "coulomb-viscous")


def test_a_measured_torque_is_none() -> None:
    recording = responses(150.0, -150.0)
    measured = recording.torque + 0.1 * np.random.default_rng(0).standard_normal(len(recording))
    assert said(replace(recording, channels={**recording.channels, "torque": measured})) is None


def test_one_late_row_in_a_hundred_does_not_count() -> None:
    torque, group = np.ones(400), np.repeat([0, 1], 200)
    torque[[7, 203]] = -1.0
    assert one_value_in_each(torque, group)
    torque[[8, 9]] = -1.0
    assert not one_value_in_each(torque, group)


def test_no_offset_of_a_run_stands_for_its_command() -> None:
    """Noise of the motion leaves something to explain; an offset in each run would explain all of the torque."""
    recording = responses(100.0, -100.0, 150.0, -150.0, 250.0, -250.0)
    time, position = recording.time, recording["position"]
    swing = 1e-4 * np.sin(40.0 * time)
    shaken = replace(recording, channels={**recording.channels, "position": position + swing})
    ladder = improve(shaken, "coulomb-viscous")
    assert "run-offset" not in [rung.added for rung in ladder.rungs]
    assert ladder.rungs[-1].comparison.estimate.parameters["K_v"] == pytest.approx(VISCOUS, rel=0.05)


def test_runs_of_one_torque_all_the_same_may_have_offsets() -> None:
    """So it is where drives coast, whose torque is 0 in all runs."""
    steps, coasting = responses(100.0, -150.0), responses(100.0, -150.0)
    coasting = replace(coasting, channels={**coasting.channels, "torque": np.zeros(len(coasting))})
    assert not RunOffset.candidates(steps)
    assert RunOffset.candidates(coasting)
