"""An effect beside a cause that is on no list: there if it explains most of what a description of that cause leaves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, compare, diagnose, refits, support
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.passive import own_torque
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.refits import Refits
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.shifted import FREE_SHIFT

Made = Callable[..., Recording]
INERTIA = 2.0


def bent(made: Made, size: float, offset: float, seed: int = 0) -> Diagnosis:
    """Return the diagnosis of a drive with a torque of the size of its acceleration, and an offset."""
    recording = made(seed=seed, noise=0.1, samples=4000)
    acceleration = np.gradient(recording.velocity, recording.time)
    torque = recording.torque + size * np.abs(acceleration) + offset
    return diagnose(recording.with_channels(derived=False, torque=torque), "coulomb-viscous", INERTIA)


@pytest.mark.parametrize(
    ("times", "keeps"), [(1.0, True), (0.12, True), (3.0, True), (0.08, False), (-0.08, False), (-0.6, True)]
)
def test_an_effect_that_is_there_has_some_of_its_size_beside_a_description(
    monkeypatch: pytest.MonkeyPatch, times: float, keeps: bool
) -> None:
    """Its torque beside a description is that many times the one without; what the base could be does not count."""
    base = np.array([1.0, 1.0, 0.0, 0.0])
    projected: Any = SimpleNamespace(project_out=lambda torques: torques - np.outer(torques @ base / 2.0, base))
    monkeypatch.setattr(support, "regression_of", lambda *_: projected)
    torque, across = np.array([1.0, -1.0, 2.0, 0.0]), np.array([0.0, 0.0, 0.0, 5.0])
    own: Any = SimpleNamespace(torque=torque + 9.0 * base)
    described: Any = SimpleNamespace(torque=times * torque + across - 30.0 * base)
    result: Any = SimpleNamespace(problem=None, parameters={}, policy=POLICY)
    assert support._keeps_its_size(result, own, described, np.zeros((0, 4))) is keeps


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_an_offset_beside_a_torque_of_the_size_of_the_acceleration_is_there(made: Made, seed: int) -> None:
    """The acceleration's channel takes three quarters of what the offset explains: its size has a mean."""
    diagnosis = bent(made, 0.2, 0.6, seed)
    assert [set(found.names) & {"torque-offset", "asymmetry"} for found in diagnosis.findings] != []
    assert all({"torque-offset", "asymmetry"} & set(found.names) for found in diagnosis.findings)
    assert diagnosis.view is not None
    assert diagnosis.view.channels == "acceleration"


def test_an_offset_whose_sign_the_other_cause_turns_is_there(made: Made) -> None:
    """By itself it is the mean of both, which is positive; beside the acceleration's channel it is what it is."""
    diagnosis = bent(made, 0.2, -0.6)
    assert [set(found.names) & {"torque-offset", "asymmetry"} for found in diagnosis.findings] != []


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1])
def test_without_an_offset_none_is_named(made: Made, seed: int) -> None:
    diagnosis = bent(made, 0.2, 0.0, seed)
    assert (diagnosis.verdict, diagnosis.findings) == ("unknown-effect", ())


def loaded(droop: float, gain: float, seed: int = 0, rate: float = 500.0) -> Recording:
    """Return a drive that a known load turns as well; its torque falls short of τ by g·τ + droop·|τ|τ."""
    rng, time = np.random.default_rng(seed), np.arange(4000) / rate
    phases = rng.uniform(0.0, 2 * np.pi, 4)
    turns = 2 * np.pi * np.array([0.31, 0.77, 1.43, 2.71])
    velocity = np.array([4.0, 3.0, 2.0, 1.0]) @ np.sin(turns[:, None] * time + phases[:, None])
    slope = (np.array([4.0, 3.0, 2.0, 1.0]) * turns) @ np.cos(turns[:, None] * time + phases[:, None])
    load = 12.0 * np.sin(2 * np.pi * 0.13 * time) + 5.0
    true = INERTIA * slope + 0.5 * velocity + 3.0 * np.sign(velocity) + load
    # τ (1 − g) − droop |τ| τ is what acts.
    current = true.copy()
    for _ in range(60):
        current = true / (1.0 - gain - droop * np.abs(current))
    channels = {
        "time": time,
        "velocity": velocity + 2e-3 * rng.standard_normal(len(time)),
        "torque": current + 0.02 * rng.standard_normal(len(time)),
        "load_torque": load,
    }
    return Recording("loaded", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.long
def test_a_torque_that_falls_short_the_more_the_larger_is_no_wrong_constant() -> None:
    """Its shape over the motor torque says so, though a wrong constant explains most of it."""
    diagnosis = diagnose(loaded(0.002, 0.0), "coulomb-viscous", INERTIA)
    assert (diagnosis.verdict, diagnosis.findings) == ("unknown-effect", ())
    assert diagnosis.view is not None
    assert diagnosis.view.channels == "motor torque"


@pytest.mark.long
def test_a_wrong_constant_is_one() -> None:
    (found,) = diagnose(loaded(0.0, 0.08), "coulomb-viscous", INERTIA).findings
    assert found.names[0] == "torque-gain"
    assert found.tested.parameters["g"] == pytest.approx(-0.08 / 0.92, rel=0.01)


def test_two_waves_of_one_wave_number_are_larger_than_the_drive(made: Made) -> None:
    """They cancel each other; the recording tells their sum, and nothing of either."""
    recording = made("coulomb-viscous+cogging", {"cogging.a": 0.5, "cogging.k": 7.3})
    fitted = compare(recording, "coulomb-viscous+cogging", INERTIA)
    (effect,) = fitted.drive.model.effects
    share = own_torque(fitted, effect)
    rms = float(np.sqrt(np.mean(fitted.train.torque**2)))
    assert share == pytest.approx(0.5 / np.sqrt(2) / rms, rel=0.1)
    large = {**fitted.estimate.parameters, "cogging.a": 5000.0}
    given = replace(fitted, estimate=replace(fitted.estimate, parameters=large))
    assert own_torque(given, effect) == pytest.approx(share * 1e4, rel=0.05)
    assert share < POLICY.own_torque < own_torque(given, effect)
    bare = compare(recording, "coulomb-viscous", INERTIA)
    (tested,) = candidate_tests(replace(bare.problem), bare.estimate.parameters, only=["cogging"]).tested
    assert Refits(bare, POLICY).with_effect(tested) is not None
    assert Refits(bare, replace(POLICY, own_torque=0.5 * share)).with_effect(tested) is None


def test_what_a_law_could_be_as_well_is_no_torque_of_an_effects_own(made: Made) -> None:
    """From 20 °C on a lubricant thins; from 0 °C on, where its formula begins, the law has many times the torque."""
    plain = made(samples=6000)
    warm = 20.0 + 25.0 * (1.0 - np.exp(-plain.time / 4.0))
    torque = plain.torque + 1200.0 * np.exp(-warm / 10.0) * plain.velocity
    recording = plain.with_channels(derived=False, torque=torque, temperature=warm)
    fitted = compare(recording, "coulomb-viscous+thermal", INERTIA)
    assert fitted.estimate.parameters["K_v"] * float(np.std(plain.velocity)) > POLICY.own_torque * recording.rms_torque
    assert own_torque(fitted, fitted.drive.model.effects[0]) < 1.0
    (found,) = diagnose(recording, "coulomb-viscous", INERTIA).findings
    assert found.names[0] == "thermal"


def late(samples: float) -> Recording:
    """Return a drive at 100 Hz whose motion was recorded so many samples late."""
    time, rate = np.arange(8000) / 100.0, 100.0
    turns, sizes = 2 * np.pi * np.array([0.31, 1.43, 4.7, 8.3]), np.array([4.0, 2.0, 1.0, 0.5])

    def motion(at: np.ndarray) -> np.ndarray:
        return np.asarray(sizes @ np.sin(turns[:, None] * at))

    slope = (sizes * turns) @ np.cos(turns[:, None] * time)
    velocity = motion(time)
    torque = INERTIA * slope + 0.5 * velocity + 3.0 * np.sign(velocity)
    rng = np.random.default_rng(3)
    channels = {
        "time": time,
        "velocity": motion(time - samples / rate) + 2e-3 * rng.standard_normal(len(time)),
        "torque": torque + 0.02 * rng.standard_normal(len(time)),
    }
    return Recording("late", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def test_a_delay_that_the_free_shift_of_the_rows_is_as_well_has_to_lower_the_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It was found beside a shift of that size: what is fitted is more, or the error falls far with it."""
    bare = compare(late(0.85), "coulomb-viscous", INERTIA)
    (tested,) = candidate_tests(bare.problem, bare.estimate.parameters, only=["sensor-delay"]).tested
    fitted = Refits(bare, POLICY).with_effect(tested)
    assert fitted is not None
    falls_to = fitted.errors.held_out_percent / bare.errors.held_out_percent
    monkeypatch.setattr(refits, "FREE_SHIFT", 0.9)
    assert Refits(bare, replace(POLICY, refit_share=1.01 * falls_to)).with_effect(tested) is not None
    assert Refits(bare, replace(POLICY, refit_share=0.99 * falls_to)).with_effect(tested) is None


@pytest.mark.long
@pytest.mark.parametrize(("samples", "named"), [(0.0, False), (0.5, False), (0.85, True), (-0.9, True)])
def test_a_delay_of_more_than_the_hold_of_a_torque_has_its_name(samples: float, named: bool) -> None:
    """Half a sample is how recordings are made, where a torque was held; what is clearly more is a delay."""
    diagnosis = diagnose(late(samples), "coulomb-viscous", INERTIA)
    assert [found.names[0] for found in diagnosis.findings] == (["sensor-delay"] if named else [])
    if named:
        assert abs(samples) > FREE_SHIFT
        assert diagnosis.findings[0].tested.parameters["T"] == pytest.approx(samples / 100.0, rel=0.1)
