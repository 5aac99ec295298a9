"""A diagnosis of drives with waves over position that pass within a few samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType, SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, compare, diagnose
from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.diagnose import _confirmed_ripple
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.explain import explain
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.refits import Refits
from fricmodels.diagnosis.ripple import FastRipple
from fricmodels.diagnosis.verdict import LookAlikes
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.ripple import Waves

INERTIA = 2.0


@pytest.fixture(scope="module")
def benchmark(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    """Return the module that makes such drives."""
    return from_benchmarks("fast_ripple")


KINDS = [("cogging", 3.0), ("position-friction", 5.0), ("cogging", 8.0)]


@pytest.mark.long
@pytest.mark.parametrize(("kind", "per_wave"), KINDS)
def test_a_fast_wave_is_named_with_its_wave_number_and_amplitude(
    benchmark: ModuleType, kind: str, per_wave: float
) -> None:
    outcome = benchmark.judged(benchmark.trial(kind, per_wave, 10))
    assert outcome.right
    assert not outcome.false
    assert abs(outcome.error) < 0.2


@pytest.mark.long
@pytest.mark.parametrize("seed", [10, 12])
def test_a_torque_off_the_list_is_not_called_a_friction(benchmark: ModuleType, seed: int) -> None:
    """What goes with the direction explains less than half of a torque that does not."""
    recording = benchmark.trial("cogging", 5.0, seed).recording
    found = diagnose(recording, "coulomb-viscous", INERTIA, leave_out=["cogging", "torque-ripple"])
    assert found.ripple is not None
    assert found.ripple.found is None
    assert not found.findings


@pytest.mark.long
def test_k_is_named_and_not_2k(benchmark: ModuleType) -> None:
    outcome = benchmark.judged(benchmark.trial("cogging, k and 2k (1 : 2)", 6.0, 12))
    assert outcome.right
    assert not outcome.double


@pytest.fixture(scope="module")
def clean(benchmark: ModuleType) -> Diagnosis:
    """Return the diagnosis of a drive without a wave."""
    return diagnose(benchmark.trial("", 5.0, 14).recording, "coulomb-viscous", INERTIA)


def test_nothing_is_named_on_a_clean_drive(clean: Diagnosis) -> None:
    assert clean.verdict == "adequate"
    assert clean.ripple is None


def test_what_would_have_been_seen_has_a_band(benchmark: ModuleType, clean: Diagnosis) -> None:
    """From one period over the travel to half a wave a sample; what is twice the size there is named."""
    recording = clean.comparison.train
    band = clean.visibility["cogging"].band
    assert band is not None
    assert band[0] == pytest.approx(2 * np.pi / np.ptp(recording["position"]), rel=0.05)
    passed = np.abs(recording.velocity) * recording.interval
    assert band[1] * np.median(passed) == pytest.approx(np.pi, rel=0.2)
    assert clean.visibility["torque-offset"].band is None
    assert document(clean).could_have_been_seen["cogging"].band == pytest.approx(band)
    data = document(clean).plain()["could_have_been_seen"]
    assert "band" not in data["torque-offset"]


@pytest.mark.long
def test_one_period_over_the_travel_is_named(benchmark: ModuleType) -> None:
    """A gear's output side turns less than once."""
    one = benchmark.trial("cogging", 250.0, 16)
    periods = one.k * float(np.ptp(one.recording["position"])) / (2 * np.pi)
    assert 1.0 < periods < 1.2
    found = diagnose(one.recording, "coulomb-viscous", INERTIA)
    assert found.findings[0].tested.name == "cogging"
    assert found.findings[0].tested.parameters["k"] == pytest.approx(one.k, rel=0.01)


@pytest.mark.long
def test_less_than_a_period_is_given_to_the_position_and_to_no_wave(benchmark: ModuleType) -> None:
    """Any smooth course over the position is as good; a wave of a whole period is not it."""
    one = benchmark.trial("cogging", 450.0, 16)
    assert one.k * float(np.ptp(one.recording["position"])) < 0.7 * 2 * np.pi
    found = diagnose(one.recording, "coulomb-viscous", INERTIA)
    assert not found.findings
    assert found.view is not None
    assert found.view.channels == "position"


@pytest.mark.long
def test_the_wave_is_told_in_words(benchmark: ModuleType) -> None:
    found = diagnose(benchmark.trial("cogging", 5.0, 18).recording, "coulomb-viscous", INERTIA)
    assert found.ripple is not None
    assert "a wave over position: k = " in explain(found)
    assert "a turn" in explain(found)


@pytest.mark.long
def test_gravity_on_a_spindle_that_turns_within_a_few_samples_is_gravity() -> None:
    """Once a turn is once a turn, however fast: it is named, and a model that has it explains it."""
    fine, rate, seconds = 20, 50.0, 60.0
    time = (np.arange(int(seconds * rate * fine)) + 0.5) / (rate * fine)
    angles = 2 * np.pi * np.outer([0.23, 0.61, 1.07], time) + np.array([0.3, 1.1, 2.0])[:, None]
    amplitudes, omega = np.array([60.0, 40.0, 20.0]), 2 * np.pi * np.array([0.23, 0.61, 1.07])
    velocity, acceleration = amplitudes @ np.sin(angles), (amplitudes * omega) @ np.cos(angles)
    position = -(amplitudes / omega) @ np.cos(angles)
    gravity = 0.1 * np.cos(position) - 0.2 * np.sin(position)
    torque = 0.007 * acceleration + 1.3 * np.sign(velocity) + 0.001 * velocity + gravity
    middle = slice(fine // 2, None, fine)
    rng = np.random.default_rng(3)
    measured = torque.reshape(-1, fine).mean(axis=1)
    channels = {
        "time": time[middle],
        "velocity": velocity[middle],
        "position": position[middle],
        "torque": measured + 0.005 * rng.standard_normal(len(measured)),
    }
    recording = Recording("spindle", Motion.ROTARY, channels, np.zeros(len(measured), dtype=np.int64))
    diagnosis = diagnose(recording, "coulomb-viscous", 0.007)
    assert diagnosis.findings[0].names[0] == "gravity"
    fitted = compare(recording, "coulomb-viscous+gravity", 0.007)
    assert fitted.errors.held_out_percent < 0.5 * diagnosis.comparison.errors.held_out_percent
    found = fitted.estimate.parameters
    assert (found["gravity.a"], found["gravity.b"]) == pytest.approx((0.1, -0.2), abs=0.03)


class Fits:
    """Fits of a model with one effect more, whose test errors in a narrow and in a wide window are known."""

    def __init__(self, **errors: tuple[float, float]) -> None:
        self.errors, self.policy = errors, POLICY
        self.comparison = self._of(errors["nothing"])

    def _of(self, errors: tuple[float, float]) -> Any:
        bands = [SimpleNamespace(window_ms=w, held_out_percent=e) for w, e in zip((5.0, 100.0), errors, strict=True)]
        return SimpleNamespace(errors=SimpleNamespace(bands=bands))

    def with_effect(self, tested: Any) -> Any:
        found = self.errors.get(tested.name)
        return None if found is None else self._of(found)

    lowers_error_within = Refits.lowers_error_within
    is_better_within = Refits.is_better_within


@pytest.mark.parametrize(
    ("simple", "other", "leads"),
    [
        ((2.0, 3.0), (9.0, 9.0), "simple"),
        ((1.0, 3.0), (9.0, 9.0), "simple"),
        ((2.04, 3.0), (9.0, 9.0), "simple"),  # two harmonics more always gain a little
        ((2.1, 1.0), (9.0, 9.0), "wave"),  # in windows that are wider than the wave nothing of it is left
        ((2.1, 1.0), (1.99, 9.0), "wave"),  # with as many parameters it has to be lower by a margin
        ((2.1, 1.0), (1.90, 9.0), "other"),
        (None, (9.0, 9.0), "wave"),
    ],
)
def test_a_wave_is_the_effect_whose_fit_leaves_less(
    simple: tuple[float, float] | None, other: tuple[float, float], leads: str
) -> None:
    """Rows that carry a wave may be explained better by an effect with more harmonics, and the recording not."""
    tested = {
        name: cast(CandidateTest, SimpleNamespace(name=name, effect=SimpleNamespace(parameters=(None,) * count)))
        for name, count in (("simple", 2), ("wave", 5), ("other", 5))
    }
    first = LookAlikes(tested["wave"], (tested["wave"],))
    waves = cast(Waves, SimpleNamespace(duration=0.02))
    ripple = FastRipple(waves, first, (tested["other"], tested["simple"]))
    errors = {"nothing": (5.0, 5.0), "wave": (2.0, 2.0), "other": other} | ({"simple": simple} if simple else {})
    found = _confirmed_ripple(cast(Refits, Fits(**errors)), ripple)
    assert found is not None
    assert found.found is not None
    assert found.found.names == [leads]
    worse = _confirmed_ripple(cast(Refits, Fits(nothing=(1.0, 1.0), wave=(2.0, 2.0))), replace(ripple, others=()))
    assert worse is None
