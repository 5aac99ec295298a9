"""Filters beside a drive for long: saved and resumed to the last bit, no wind-up, a covariance that stays one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from estimators.detchmendy_sridhar import DetchmendySridhar
from estimators.ekf import ExtendedKalman
from estimators.rls import RecursiveLeastSquares
from fricmodels.errors import InputError
from fricmodels.estimator import OnlineFilter

ESTIMATORS = [DetchmendySridhar, ExtendedKalman, RecursiveLeastSquares]
_REST, _STEADY = "rest", "steady"


def samples(paper: SimpleNamespace, count: int, then: str = "", after: int = 0) -> Iterator[dict[str, float]]:
    """Yield samples of the paper's drive over and over; after some, it rests, or turns at one speed."""
    made = paper.recording(0.02, cycles=4)
    step, cycle = made.time[1] - made.time[0], 3 * len(made) // 4
    for i in range(count):
        torque, velocity = made.torque[i % cycle], made.velocity[i % cycle]
        if then and i >= after:
            speed = 0.0 if then == _REST else 20.0
            torque = 0.0 if then == _REST else paper.true["K_v1"] * speed + paper.true["K_c1"]
            velocity = speed
        yield {"time": i * step, "torque": float(torque), "velocity": float(velocity)}


def smallest_eigenvalue(online: OnlineFilter) -> float:
    """Return the smallest eigenvalue of the covariance, its diagonal scaled to 1."""
    covariance = online.covariance
    np.testing.assert_array_equal(covariance, covariance.T)
    size = np.sqrt(np.diag(covariance))
    return float(np.linalg.eigvalsh(covariance / np.outer(size, size))[0])


@pytest.mark.parametrize("cls", ESTIMATORS)
@pytest.mark.parametrize("known", [True, False], ids=["inertia given", "inertia estimated"])
def test_a_saved_filter_goes_on_to_the_last_bit(paper: SimpleNamespace, cls: Any, known: bool) -> None:
    """Through JSON, without the recording, in the middle of a rest and of a run."""
    drive = paper.drive(inertia=paper.inertia if known else None)
    online = cls().start(drive, paper.recording(0.02, cycles=4))
    listed = list(samples(paper, 700, _REST, 300))
    for sample in listed[:350]:
        online.update(sample)
    again = cls().resume(json.loads(json.dumps(online.state)))
    assert again.parameters == online.parameters
    for sample in listed[350:]:
        assert again.update(sample) == online.update(sample)
    np.testing.assert_array_equal(again.covariance, online.covariance)
    assert again.state == online.state


def test_a_state_with_memory(paper: SimpleNamespace) -> None:
    made = paper.recording(0.02, cycles=4)
    drive = paper.drive("coulomb-viscous+rising-stiction")
    online = ExtendedKalman().start(drive, made)
    for sample in samples(paper, 40):
        online.update(sample)
    again = ExtendedKalman().resume(json.loads(json.dumps(online.state)))
    sample = list(samples(paper, 41))[-1]
    assert again.update(sample) == online.update(sample)


@pytest.mark.parametrize("cls", ESTIMATORS)
def test_rest_teaches_nothing_and_forgets_nothing(paper: SimpleNamespace, cls: Any) -> None:
    """After a cycle of rest neither parameters nor their covariance change any more: there is no wind-up."""
    online = cls().start(paper.drive(), paper.recording(0.02, cycles=4))
    after = 800
    for i, sample in enumerate(samples(paper, 3000, _REST, after)):
        online.update(sample)
        if i == after + 600:  # a cycle has 200 samples
            parameters, covariance = online.parameters, online.covariance
    np.testing.assert_allclose(online.covariance, covariance, rtol=1e-9)
    for key, value in parameters.items():
        assert online.parameters[key] == pytest.approx(value, rel=1e-9), key


@pytest.mark.parametrize("cls", ESTIMATORS)
def test_motion_after_a_long_rest_goes_on_as_before(paper: SimpleNamespace, cls: Any) -> None:
    """The estimate before a long rest is the estimate a cycle after it, within what noise does in a cycle."""
    online = cls().start(paper.drive(), paper.recording(0.02, cycles=4))
    time = 0.0
    for sample in samples(paper, 1600):
        online.update(sample)
        time = sample["time"]
    before = online.parameters
    for i in range(1500):
        online.update({"time": time + 1e-3 * (i + 1), "torque": 0.0, "velocity": 0.0, "run": 0.0})
    for sample in samples(paper, 600):
        online.update({**sample, "time": sample["time"] + time + 4.0})
    for key in ("K_c1", "K_c2"):
        assert online.parameters[key] == pytest.approx(before[key], rel=0.25), key


@pytest.mark.parametrize(
    "cls", [*(pytest.param(cls, marks=pytest.mark.long) for cls in ESTIMATORS[:2]), RecursiveLeastSquares]
)
def test_the_covariance_stays_one(paper: SimpleNamespace, cls: Any) -> None:
    online, bare = cls().start(paper.drive(), paper.recording(0.02, cycles=4)), []
    for i, sample in enumerate(samples(paper, 10_000)):
        online.update(sample)
        if i % 500 == 499:
            bare.append(smallest_eigenvalue(online))
    assert min(bare) > 1e-9


@pytest.mark.parametrize("cls", ESTIMATORS)
@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    pieces=st.lists(
        st.tuples(st.sampled_from(["motion", "rest", "speed", "gap", "jerk", "new run"]), st.integers(5, 120)),
        min_size=2,
        max_size=6,
    ),
    seed=st.integers(0, 99),
)
@example(pieces=[("speed", 14), ("motion", 120), ("new run", 73), ("rest", 9), ("motion", 98), ("gap", 29)], seed=0)
def test_the_covariance_stays_one_whatever_comes(
    paper: SimpleNamespace, cls: Any, pieces: list[tuple[str, int]], seed: int
) -> None:
    """Motion, rest, one speed, gaps in time, wild torques and new runs in any order: positive definite and finite."""
    made = paper.recording(0.02, cycles=4)
    online, random = cls().start(paper.drive(), made), np.random.default_rng(seed)
    step = float(made.time[1] - made.time[0])
    time, run, place = 0.0, 0, 0
    for kind, count in pieces:
        run += kind == "new run"
        for _ in range(count):
            torque, velocity = float(made.torque[place]), float(made.velocity[place])
            place = (place + 1) % len(made)
            if kind == "rest":
                torque, velocity = 0.0, 0.0
            elif kind == "speed":
                velocity = 20.0
            elif kind == "jerk":
                torque *= 10 * float(random.standard_normal())
            time += step * (50 if kind == "gap" else 1)
            found = online.update({"time": time, "torque": torque, "velocity": velocity, "run": float(run)})
        assert all(np.isfinite(value) for value in found.values())
        assert np.all(np.isfinite(online.covariance))
        assert smallest_eigenvalue(online) > 0.0


@pytest.mark.long
@pytest.mark.parametrize("cls", ESTIMATORS)
@pytest.mark.parametrize("then", ["", _REST, _STEADY], ids=["motion", "rest", "one speed"])
def test_a_million_updates(paper: SimpleNamespace, cls: Any, then: str) -> None:
    """Memory stays what it was, the covariance positive definite, and one speed for ever winds nothing up."""
    online = cls().start(paper.drive(), paper.recording(0.02, cycles=4))
    size = 0
    for i, sample in enumerate(samples(paper, 1_000_000, then, 5000)):
        online.update(sample)
        if i % 20_000 == 1000:
            size = size or len(json.dumps(online.state))
            assert len(json.dumps(online.state)) < 1.5 * size
            assert np.all(np.isfinite(online.covariance))
            assert smallest_eigenvalue(online) > 0.0
    spread = np.sqrt(np.diag(online.covariance))
    assert np.all(spread < 1e6 * np.array([paper.true[key] for key in online.parameters if key != "J"]))


@pytest.mark.parametrize("cls", ESTIMATORS)
def test_a_state_of_another_estimator_is_refused(paper: SimpleNamespace, cls: Any) -> None:
    online = ExtendedKalman().start(paper.drive(), paper.recording(0.02, cycles=4))
    if cls is not ExtendedKalman:
        with pytest.raises(InputError, match="ekf"):
            cls().resume(online.state)
    with pytest.raises(InputError, match="no state"):
        cls().resume({})
