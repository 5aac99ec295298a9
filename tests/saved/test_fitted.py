"""The object: known answers, one sample against all, limits at rest, motion against the simulator."""

from __future__ import annotations

import copy
import io
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

import fricmodels
from fricmodels.errors import InputError
from fricmodels.export.targets import export_model
from fricmodels.recording import Recording

VALUES = {"K_v": 0.5, "K_c": 3.0, "gravity.a": 1.0, "gravity.b": -2.0}


@pytest.fixture(scope="module")
def arm(kept: Callable[..., Any]) -> Any:
    return kept("coulomb-viscous+gravity", VALUES)


@pytest.fixture(scope="module")
def remembering(kept: Callable[..., Any]) -> Any:
    return kept("coulomb-viscous+presliding", {"K_v": 0.5, "K_c": 1.0, "presliding.F_1": 2.0, "presliding.F_2": 2.0})


def test_torque_is_the_equation_on_numbers_arrays_tables_and_recordings(arm: Any) -> None:
    velocity, position = np.array([[2.0, -1.0], [0.5, 4.0]]), 0.3
    expected = 0.5 * velocity + 3.0 * np.sign(velocity) + np.cos(position) - 2.0 * np.sin(position)
    np.testing.assert_allclose(arm.torque(velocity=velocity, position=position), expected, rtol=1e-14)
    one = arm.torque(velocity=2.0, position=position)
    assert isinstance(one, float)
    assert one == pytest.approx(expected[0, 0], rel=1e-14)
    for columns in (("velocity", "position"), ("velocity_rad_s", "position_rad")):
        table = pd.DataFrame({columns[0]: velocity.ravel(), columns[1]: position}, index=[5, 6, 7, 8])
        series = arm.torque(table)
        assert list(series.index) == [5, 6, 7, 8]
        np.testing.assert_allclose(series, expected.ravel(), rtol=1e-14)


def test_a_word_that_is_none_is_refused_and_not_taken_for_another(arm: Any) -> None:
    for word in ("hold", "Held", "zoh"):
        with pytest.raises(InputError, match=f"between_samples is linear or held, not '{word}'"):
            arm.simulate(np.ones(9), interval=1e-3, between_samples=word)
    with pytest.raises(InputError, match="nothing to simulate"):
        arm.simulate([], interval=1e-3)
    with pytest.raises(InputError, match=r"no signal 'velocit'; did you mean 'velocity'\?"):
        arm.outside(velocit=[400.0])
    with pytest.raises(InputError, match=r"a model is wanted, got FittedModel; give its \.model"):
        fricmodels.Model.of(arm)


def test_what_goes_with_the_clock_of_one_recording_says_so(arm: Any, kept: Callable[..., Any]) -> None:
    assert arm.of_the_clock == ""
    assert kept("coulomb-viscous+step-change").of_the_clock.startswith("step-change goes with the time since")
    both = kept("coulomb-viscous+drift+gravity+step-change")
    assert both.of_the_clock.startswith("drift and step-change go with the time since")
    assert both.of_the_clock in export_model(both, "c").notes
    assert "drift and step-change go with the time since" in export_model(both, "c").text


def test_a_recording_gives_what_the_drive_gives(made: Callable[..., Recording], kept: Callable[..., Any]) -> None:
    recording = made(samples=500)
    for name in ("coulomb-viscous+cogging", "coulomb-viscous+presliding", "square-root+frictional-lag"):
        model = kept(name)
        own = model.drive.friction(recording, model.parameters, width=model.document.rest_width)
        np.testing.assert_allclose(model.torque(recording), own, rtol=1e-7, atol=1e-7)


def test_sample_by_sample_is_all_at_once(remembering: Any) -> None:
    time = np.arange(800) * 1e-3
    velocity = np.sin(9 * time) + 0.2 * np.sin(41 * time)
    expected = remembering.torque(velocity=velocity, time=time)
    before, found = None, []
    for v in velocity:
        torque, before = remembering.follow(before, 1e-3, velocity=v)
        found.append(torque)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    assert np.ptp(expected[:20]) > 0.1  # it does build up


def test_a_run_begins_anew(remembering: Any) -> None:
    time, velocity = np.arange(100) * 1e-3, np.full(100, 0.3)
    once = remembering.torque(velocity=velocity, time=time)
    twice = remembering.torque(
        velocity=np.tile(velocity, 2), time=np.tile(time, 2), run=np.repeat([0, 1], 100)
    )  # fmt: skip
    np.testing.assert_array_equal(twice, np.tile(once, 2))


def test_compensation_at_rest(arm: Any) -> None:
    held = 1.0 * np.cos(0.3) - 2.0 * np.sin(0.3)
    at_zero = {"velocity": 0.0, "position": 0.3}
    assert arm.compensation(**at_zero) == pytest.approx(held, rel=1e-6)
    assert arm.compensation(**at_zero, at_rest="reference", reference=0.1) == pytest.approx(held + 3.0, rel=1e-6)
    assert arm.compensation(**at_zero, at_rest="reference", reference=-0.1) == pytest.approx(held - 3.0, rel=1e-6)
    assert arm.compensation(**at_zero, at_rest="reference", reference=0.0) == pytest.approx(held, rel=1e-6)
    assert arm.compensation(**at_zero, at_rest="smooth", width=0.1) == pytest.approx(held, rel=1e-6)


def test_smooth_compensation_is_smooth_and_ends_in_the_torque(arm: Any) -> None:
    velocity = np.linspace(-2, 2, 40001)
    smooth = arm.compensation(velocity=velocity, position=0.0, at_rest="smooth", width=0.05)
    torque = arm.torque(velocity=velocity, position=0.0)
    step = velocity[1] - velocity[0]
    assert np.max(np.abs(np.diff(smooth))) < 1.1 * step * (3.0 / 0.05 + 0.5)
    far = np.abs(velocity) > 20 * 0.05
    np.testing.assert_allclose(smooth[far], torque[far], rtol=1e-12)
    for rest in ("none", "reference"):
        other = arm.compensation(velocity=velocity, position=0.0, at_rest=rest, reference=1.0, width=0.05)
        moving = np.abs(velocity) > 0.05
        np.testing.assert_allclose(other[moving], torque[moving], rtol=1e-14)


def test_what_friction_loses_compensation_gives_back(arm: Any) -> None:
    """A drive with its compensation and no other torque keeps its speed."""
    now = arm.start(velocity=1.0)
    for _ in range(300):
        push = arm.compensation(velocity=now.velocity, position=now.position)
        now = arm.step(now, push, 1e-4)
    assert now.velocity == pytest.approx(1.0, abs=1e-4)
    assert now.position == pytest.approx(0.03, rel=1e-3)


@pytest.mark.parametrize("name", ["coulomb-viscous+gravity", "exponential-stick-slip+presliding"])
def test_stepping_is_simulating(kept: Callable[..., Any], name: str) -> None:
    model = kept(name, {"K_c": 3.0, "K_v": 1.0})
    torque = 6.0 * np.sin(0.02 * np.arange(600))
    whole = model.simulate(torque, {"velocity": 0.2, "position": 0.1}, interval=2e-3, between_samples="held")
    now, velocity = model.start(velocity=0.2, position=0.1), []
    for push in torque:
        velocity.append(now.velocity)
        now = model.step(now, push, 2e-3)
    np.testing.assert_allclose(velocity, whole.velocity, rtol=1e-10, atol=1e-12)
    assert np.min(whole.velocity) < 0.1 < np.max(whole.velocity)
    assert np.any(whole.velocity == 0.0)  # it sticks


def test_a_simulation_can_go_on_where_one_ended(remembering: Any) -> None:
    torque = 5.0 * np.sin(0.05 * np.arange(200))
    now = remembering.start()
    for push in torque[:100]:
        now = remembering.step(now, push, 1e-3)
    whole = remembering.simulate(torque, interval=1e-3, between_samples="held")
    rest = remembering.simulate(torque[100:], now, interval=1e-3, between_samples="held")
    np.testing.assert_allclose(rest.velocity, whole.velocity[100:], rtol=1e-10, atol=1e-12)
    assert rest.time[0] == pytest.approx(0.1)


def test_a_drive_that_is_pushed_too_little_stays(arm: Any) -> None:
    still = arm.simulate(np.full(50, 1.0 + 2.9), interval=1e-3)
    assert np.all(still.velocity == 0.0)
    moves = arm.simulate(np.full(50, 1.0 + 3.1), interval=1e-3)
    assert moves.velocity[-1] == pytest.approx(0.1 / 2.0 * 0.049, rel=0.05)


def test_pickle_and_copy(remembering: Any) -> None:
    again = pickle.load(io.BytesIO(pickle.dumps(remembering)))
    assert again == remembering
    assert again.torque(velocity=0.3, states=[0.2]) == remembering.torque(velocity=0.3, states=[0.2])
    assert copy.copy(remembering) == copy.deepcopy(remembering) == remembering


def test_what_is_there_is_shown() -> None:
    assert {"FittedModel", "load", "keep", "keep_fit", "compare", "improve"} <= set(dir(fricmodels))
    shown = set(dir(fricmodels))
    assert set(fricmodels.__all__) <= shown
    assert not {"Any", "TYPE_CHECKING", "annotations", "importlib"} & shown


def test_outside_of_what_was_recorded(arm: Any) -> None:
    low, high = arm.ranges["velocity"]
    assert arm.outside(velocity=[low, high]) == {}
    assert arm.outside(velocity=[0.0, 2 * high, 0.0, 3 * low]) == {"velocity": 0.5}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: m.torque(velocity=1.0), "position"),
        (lambda m: m.torque(velocity=1.0, position=0.0, speed=2.0), "no signal 'speed'"),
        (lambda m: m.torque([1.0, 2.0]), "velocity=…"),
        (lambda m: m.torque(velocity=np.zeros(3), position=np.zeros(2)), r"velocity \(3,\), position \(2,\)"),
        (lambda m: m.torque(velocity="fast", position=0.0), "must be numbers"),
        (lambda m: m.compensation(velocity=0.0, position=0.0, at_rest="smooth"), "width"),
        (lambda m: m.compensation(velocity=0.0, position=0.0, at_rest="reference"), "reference"),
        (lambda m: m.compensation(velocity=0.0, position=0.0, at_rest="soft"), "'none'"),
        (lambda m: m.compensation(velocity=0.0, position=0.0, at_rest="smooth", width=-1.0), "positive"),
        (lambda m: m.simulate([1.0, 2.0]), "interval"),
        (lambda m: m.simulate([1.0, 2.0], {"speed": 1.0}, interval=1e-3), "'speed'"),
        (lambda m: m.step(m.start(), 1.0, 0.0), "positive"),
    ],
)
def test_what_is_missing_is_named(arm: Any, call: Callable[[Any], Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        call(arm)


def test_a_memory_needs_a_time_or_states(remembering: Any) -> None:
    with pytest.raises(InputError, match="follow"):
        remembering.torque(velocity=1.0)
    with pytest.raises(InputError, match="2 were given"):
        remembering.torque(velocity=1.0, states=[0.0, 1.0])
