"""A log without a position: the integral of its velocity stands for it, and what that cannot say is said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

from estimators.batch import Batch
from fricmodels import compare, diagnose
from fricmodels.diagnosis.document import comparison_document, document
from fricmodels.dimension import Motion
from fricmodels.logcheck import findings
from fricmodels.logcheck.summary import summary
from fricmodels.recording import Recording
from fricmodels.report.error_words import error_words
from fricmodels.signals import resting
from fricmodels.signals.integrated import from_zero, with_integrated_position
from fricmodels.weakform.prepared import ready

Array = NDArray[np.float64]
Benchmarks = Callable[[str], ModuleType]
BEGINS = "begins at the same place"


def recorded(made: ModuleType, hidden: str, sensor: str, seed: int = 40) -> tuple[Recording, dict[str, float]]:
    """Return a log of the benchmark's drive with one of its sensors, and the true parameters."""
    velocity, torque, true = made.drawn(seed, hidden)
    channels = {"time": np.arange(len(torque)) / made.RATE, "torque": torque}
    channels["velocity"] = dict(made.sensors(seed, velocity))[sensor]
    return Recording("no position", Motion.ROTARY, channels, np.zeros(len(torque), dtype=np.int64)), true


def test_it_is_the_integral_from_zero_at_each_run() -> None:
    time = np.tile(0.01 * np.arange(200), 2)
    velocity, run = np.cos(3.0 * time), np.repeat([0, 1], 200)
    recording = Recording("two", Motion.ROTARY, {"time": time, "torque": time, "velocity": velocity}, run)
    found = with_integrated_position(recording)
    np.testing.assert_allclose(found["position"], np.sin(3.0 * time) / 3.0, atol=1e-4)
    assert not found.measures("position")
    measured = recording.with_channels(derived=False, position=time)
    assert with_integrated_position(measured) is measured


def noisy(noise: float) -> tuple[Array, Array, NDArray[np.int64]]:
    """Return time, a velocity with noise of a sensor, and the numbers of two runs."""
    time = np.tile(0.001 * np.arange(5000), 2)
    velocity = np.cos(3.0 * time) + noise * np.random.default_rng(3).standard_normal(len(time))
    return time, velocity, np.repeat([0, 1], 5000)


@pytest.mark.parametrize("rounded", [None, 1e-6, 5e-6])
def test_a_position_that_was_computed_is_known_as_such(rounded: float | None) -> None:
    time, velocity, run = noisy(0.01)
    recording = Recording("two", Motion.ROTARY, {"time": time, "torque": time, "velocity": velocity}, run)
    position = with_integrated_position(recording)["position"] + 0.7
    position = position if rounded is None else rounded * np.round(position / rounded)
    computed = recording.with_channels(derived=False, position=position)
    found = ready(computed)
    assert not found.measures("position")
    np.testing.assert_array_equal(found["position"], position)
    assert "no-position" in [one.kind for one in findings(computed)]


@pytest.mark.parametrize("sensor", ["own", "difference", "backward", "exact", "lost noise"])
def test_a_position_with_a_sensor_of_its_own_is_measured(sensor: str) -> None:
    """Also where the velocity is a difference of it, or neither has noise."""
    time, velocity, run = noisy(0.0 if sensor == "exact" else 0.01)
    rng, smooth = np.random.default_rng(4), np.sin(3.0 * time) / 3.0
    position = smooth + 1e-5 * rng.standard_normal(len(time))
    if sensor == "difference":
        velocity = np.gradient(position, 0.001)
    if sensor == "backward":
        velocity = np.r_[0.0, np.diff(position)] / 0.001
    if sensor == "exact":  # a simulator's, which is that integral, too
        position = from_zero(Recording("two", Motion.ROTARY, {"time": time, "torque": time}, run), velocity)
    if sensor == "lost noise":
        position = smooth
    channels = {"time": time, "torque": time, "velocity": velocity, "position": position}
    assert ready(Recording("two", Motion.ROTARY, channels, run)).measures("position")


@pytest.mark.long
def test_a_computed_position_gives_the_answer_of_none(from_benchmarks: Benchmarks) -> None:
    """Taken for a sensor of its own it seemed to be without noise, and made up a compliance and a torque constant."""
    made = from_benchmarks("no_position")
    alone, _ = recorded(made, "", "noise of 20 %")
    computed = alone.with_channels(derived=False, position=with_integrated_position(alone)["position"])
    without, beside = (diagnose(one, "coulomb-viscous", made.INERTIA) for one in (alone, computed))
    assert (without.verdict, beside.verdict) == ("adequate", "adequate")
    first, second = (one.comparison.estimate.parameters for one in (without, beside))
    assert second == pytest.approx(first, rel=1e-9)


@pytest.mark.parametrize(
    ("hidden", "sensor"),
    [
        ("gravity", "rounded to 1 rpm"),
        pytest.param("cogging", "noise of 20 %", marks=pytest.mark.long),
        pytest.param("gravity", "noise of 20 %", marks=pytest.mark.long),
        pytest.param("gravity", "mean of 20 samples", marks=pytest.mark.long),
        pytest.param("cogging", "rounded to 1 rpm", marks=pytest.mark.long),
        pytest.param("cogging", "mean of 20 samples", marks=pytest.mark.long),
    ],
)
def test_what_goes_with_the_position_is_named(from_benchmarks: Benchmarks, hidden: str, sensor: str) -> None:
    made = from_benchmarks("no_position")
    recording, _ = recorded(made, hidden, sensor, seed=41)
    names = [one.names for one in diagnose(recording, "coulomb-viscous", made.INERTIA).findings]
    assert (hidden,) in names


@pytest.mark.long
def test_nothing_hidden_has_no_name(from_benchmarks: Benchmarks) -> None:
    made = from_benchmarks("no_position")
    recording, _ = recorded(made, "", "rounded to 1 rpm")
    assert diagnose(recording, "coulomb-viscous", made.INERTIA).verdict == "adequate"


@pytest.mark.long
@pytest.mark.parametrize("seed", [40, 43])
def test_intervals_reckon_with_how_the_integral_wanders(from_benchmarks: Benchmarks, seed: int) -> None:
    made = from_benchmarks("no_position")
    recording, true = recorded(made, "cogging", "noise of 20 %", seed)
    fit = compare(recording, "coulomb-viscous+cogging", made.INERTIA).estimate
    for key in ("K_c", "cogging.k"):
        assert abs(fit.parameters[key] - true[key]) < 2.5 * fit.standard_errors[key]


def test_an_estimator_by_itself_takes_the_same_position(from_benchmarks: Benchmarks) -> None:
    made = from_benchmarks("no_position")
    recording, _ = recorded(made, "gravity", "noise of 1 %")
    whole = ready(recording)
    drive = compare(recording, "coulomb-viscous+gravity", made.INERTIA).drive
    raw = replace(whole, channels={name: whole[name] for name in ("time", "torque", "velocity")}, derived=frozenset())
    found, expected = (Batch({}).fit(drive, each) for each in (raw, whole))
    assert found.parameters["gravity.b"] == pytest.approx(expected.parameters["gravity.b"], rel=0.02)


@pytest.mark.long
def test_it_is_said_where_something_goes_with_it(from_benchmarks: Benchmarks) -> None:
    made = from_benchmarks("no_position")
    recording = recorded(made, "gravity", "noise of 1 %")[0].select(slice(0, 8000))
    assert BEGINS in error_words(document(diagnose(recording, "coulomb-viscous", made.INERTIA)))
    assert BEGINS not in error_words(comparison_document(compare(recording, "coulomb-viscous", made.INERTIA)))
    position = with_integrated_position(recording)["position"]
    noise = 1e-4 * np.random.default_rng(5).standard_normal(len(recording))  # of a sensor of its own
    given = recording.with_channels(derived=False, position=position + noise)
    assert BEGINS not in error_words(document(diagnose(given, "coulomb-viscous", made.INERTIA)))
    kinds = [finding.kind for finding in summary(recording, made.INERTIA).findings]
    assert "no-position" in kinds
    assert "no-position" not in [finding.kind for finding in summary(given, made.INERTIA).findings]


def test_rests_in_noise_that_lasts_as_long_as_they_do_are_found(from_benchmarks: Benchmarks) -> None:
    """Beside motion its noise seems seven times smaller than it is, and in that band the drive never rests."""
    case, *_ = from_benchmarks("rough.trials").case_of("null", "", 11, 5401)
    recording = from_benchmarks("rough.record").record(case)
    assert 0.3 < np.mean(resting(ready(recording))) < 0.45
    fit = compare(recording, "coulomb-viscous").estimate
    true = case.drive.plant.coulomb_forward
    assert abs(fit.parameters["K_c"] - true) < min(1.96 * fit.standard_errors["K_c"], 0.1 * true)
