"""The motion that a model makes of the measured torque, in windows, beside the measured one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.kernels import Interpreted, Scan
from fricmodels.model import Model
from fricmodels.motion import Simulator, replayed, stretch_of, undetermined
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.weakform.prepared import ready

TRUE = {"J": 0.01, "K_v": 0.05, "K_c": 0.03, "cogging.a": 0.05, "cogging.b": 0.0, "cogging.k": 7.0}
TRUE |= {"cogging.a_2": 0.0, "cogging.b_2": 0.0}
MADE = Drive(Model.parse("coulomb-viscous+cogging"))
PLAIN = Drive(Model.parse("coulomb-viscous"))
PERIOD = 0.8


def recorded(count: int = 6000, **given: Any) -> Recording:
    time = np.arange(count) * 1e-3
    torque = 0.4 * np.sin(2 * np.pi * time / PERIOD)
    made = simulate(MADE, TRUE, time, torque, with_position=True, **given)
    if given.get("noise"):
        drawn = 2e-3 * np.random.default_rng(1).standard_normal(count)
        made = replace(made, channels={**made.channels, "position": made["position"] + drawn})
    return ready(replace(made, provenance={}))


def test_the_true_model_moves_as_the_drive_did_within_noise_and_a_smaller_one_visibly_does_not() -> None:
    stretch = stretch_of(recorded(noise=0.5))
    found = replayed([(PLAIN, TRUE), (MADE, TRUE)], stretch)
    plain, true = found.models
    assert true.error < 1.3 * found.noise, "within noise"
    assert found.noise < 1.3 * true.error, "and noise is not overstated"
    assert plain.error > 10 * true.error
    assert true.percent == pytest.approx(100 * true.error / np.sqrt(np.mean(stretch.recording.velocity**2)), rel=1e-3)


def test_without_noise_hardly_anything_is_left() -> None:
    """The velocity is derived from the position, over samples on both sides of a reversal too."""
    found = replayed([(MADE, TRUE)], stretch_of(recorded()))
    assert found.models[0].percent < 0.05


def test_a_window_is_the_time_between_two_reversals() -> None:
    recording = recorded()
    stretch = stretch_of(recording)
    assert stretch.stroke
    assert stretch.window == pytest.approx(PERIOD / 2, rel=0.05)
    assert stretch.recording is recording
    assert not stretch.excerpt
    anew = np.flatnonzero(np.diff(stretch.place)) + 1
    starts = [predicted.start for predicted, _ in Simulator(MADE, recording, horizon=stretch.horizon).starts]
    assert anew.tolist() == starts[1:], "lines are interrupted where the simulation begins anew"


def test_a_drive_that_never_reverses_is_simulated_in_one_piece() -> None:
    time = np.arange(2000) * 1e-3
    torque = 0.3 + 0.05 * np.sin(2 * np.pi * time / PERIOD)
    made = simulate(PLAIN, TRUE, time, torque, initial_velocity=5.0, with_position=True)
    stretch = stretch_of(ready(replace(made, provenance={})))
    assert stretch.horizon is None
    assert not stretch.stroke
    assert stretch.window == pytest.approx(1.999)
    assert replayed([(PLAIN, TRUE)], stretch).models[0].percent < 0.01


def test_of_a_long_recording_whole_windows_are_taken_that_are_spread_over_it() -> None:
    recording = recorded(30_000)
    stretch, whole = stretch_of(recording, 4_000), stretch_of(recording)
    assert stretch.excerpt
    assert 3_000 < len(stretch.recording) <= 4_000
    assert stretch.window == pytest.approx(whole.window)
    begins = stretch.recording.time[np.flatnonzero(np.diff(stretch.place)) + 1]
    assert begins[-1] > 20.0
    assert np.ptp(np.diff(begins)) < 2 * stretch.window
    found, full = (replayed([(PLAIN, TRUE)], each).models[0] for each in (stretch, whole))
    assert found.error == pytest.approx(full.error, rel=0.3), "an excerpt tells what all of it does"


def test_a_window_longer_than_what_is_simulated_is_cut() -> None:
    stretch = stretch_of(recorded(), 200)
    assert len(stretch.recording) == 200
    assert not stretch.stroke
    assert stretch.window == pytest.approx(0.199)


@pytest.mark.parametrize(
    "name", ["coulomb-viscous", "asymmetric-coulomb-viscous+stribeck", "coulomb-viscous+presliding"]
)
def test_interpreted_and_compiled_recursions_agree(name: str) -> None:
    drive = Drive(Model.parse(name))
    recording = recorded(1500)
    values = {p.key: 0.02 for p in drive.model.parameters} | {"J": 0.01}
    compiled = Simulator(drive, recording, horizon=300)(values)
    interpreted = Simulator(drive, recording, horizon=300, compiled=False)(values)
    for one, other in zip(compiled, interpreted, strict=True):
        assert one == pytest.approx(other, rel=1e-9, abs=1e-9)


def test_both_recursions_stop_where_the_state_is_no_longer_finite() -> None:
    import casadi

    state, given, constant = casadi.SX.sym("x"), casadi.SX.sym("u"), casadi.SX.sym("c")
    step = casadi.Function("step", [state, given, constant], [constant * state * state + given, state])
    rows = np.full((1300, 1), 1.5)
    for stride in (1, 2):
        _, outputs, done = Scan(step)([1.0], rows, [2.0], stride=stride)
        _, found, count = Interpreted(step)([1.0], rows, [2.0], stride=stride)
        assert count == done
        np.testing.assert_array_equal(found, outputs)
    steady, _, done = Interpreted(step)([0.0], rows, [0.0])
    assert (steady, done) == (pytest.approx([1.5]), 1300), "over several calls"


def test_it_is_said_why_a_motion_is_not_simulated() -> None:
    linear = Drive(Model.parse("coulomb-viscous"), motion=PLAIN.motion.LINEAR)
    assert undetermined(PLAIN, 0.0, None) == "the inertia is zero"
    assert undetermined(PLAIN, 0.01, 0.006) == "this recording does not determine the inertia"
    assert undetermined(linear, 0.01, None) == "this recording does not determine the mass"
    assert undetermined(PLAIN, 0.01, 0.001) == ""
    assert undetermined(Drive(PLAIN.model, 0.01), 0.01, None) == "", "it was given"
    stiff = {**TRUE, "J": 1e-300}
    with pytest.raises(InputError, match=r"1e-300 kg m², is next to none: .* and samples are 0\.001 s apart"):
        replayed([(MADE, stiff)], stretch_of(recorded(800)))
    driven = {**TRUE, "K_v": -1e3}
    with pytest.raises(InputError, match="cogging grows without bound before the recording ends"):
        replayed([(MADE, driven)], stretch_of(recorded(800)))
