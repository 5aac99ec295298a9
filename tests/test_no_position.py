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
from fricmodels.diagnosis.comparison import kept_back
from fricmodels.diagnosis.document import comparison_document, document
from fricmodels.dimension import Motion
from fricmodels.logcheck.summary import summary
from fricmodels.recording import Recording
from fricmodels.report.answer import error_words
from fricmodels.signals import resting
from fricmodels.signals.integrated import with_integrated_position
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


@pytest.mark.parametrize(
    ("hidden", "sensor"),
    [
        ("gravity", "rounded to 1 rpm"),
        ("cogging", "noise of 20 %"),
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


def test_nothing_hidden_has_no_name(from_benchmarks: Benchmarks) -> None:
    made = from_benchmarks("no_position")
    recording, _ = recorded(made, "", "rounded to 1 rpm")
    assert diagnose(recording, "coulomb-viscous", made.INERTIA).verdict == "adequate"


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
    train, _ = kept_back(ready(recording))
    drive = compare(recording, "coulomb-viscous+gravity", made.INERTIA).drive
    raw = replace(train, channels={name: train[name] for name in ("time", "torque", "velocity")}, derived=frozenset())
    found, expected = (Batch({}).fit(drive, each) for each in (replace(raw, origin=None), replace(train, origin=None)))
    assert found.parameters["gravity.b"] == pytest.approx(expected.parameters["gravity.b"], rel=0.02)


def test_it_is_said_where_something_goes_with_it(from_benchmarks: Benchmarks) -> None:
    made = from_benchmarks("no_position")
    recording = recorded(made, "gravity", "noise of 1 %")[0].select(slice(0, 8000))
    assert BEGINS in error_words(document(diagnose(recording, "coulomb-viscous", made.INERTIA)))
    assert BEGINS not in error_words(comparison_document(compare(recording, "coulomb-viscous", made.INERTIA)))
    given = recording.with_channels(derived=False, position=with_integrated_position(recording)["position"])
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
