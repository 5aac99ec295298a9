"""One torque in a stretch of the way: found where it is, and no other stretch explains more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.basis_functions import basis_functions
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.sought_functions import _hats, ends_of_stretch, stretch
from fricmodels.dimension import Motion
from fricmodels.recording import Recording


def examined(recording: Recording) -> CandidateTests:
    comparison = compare(recording, "coulomb-viscous", INERTIA)
    return candidate_tests(comparison.problem, comparison.estimate.parameters, only=())


def with_stretch(recording: Recording, ends: tuple[float, float], height: float, *, along: bool) -> Recording:
    position = recording["position"]
    side = np.sign(recording.velocity) if along else 1.0
    more = height * side * ((position > ends[0]) & (position < ends[1]))
    return recording.with_channels(derived=False, torque=recording.torque + more)


@pytest.mark.parametrize("along", [True, False])
@pytest.mark.parametrize("share", [(0.2, 0.35), (0.4, 0.75), (0.0, 0.3)])
def test_the_stretch_is_found_with_its_ends_and_its_torque(made: Made, share: tuple[float, float], along: bool) -> None:
    recording = made(noise=0.2)
    position = recording["position"]
    low, high = (float(q) for q in np.quantile(position, share))
    result = examined(with_stretch(recording, (low, high), 1.5, along=along))
    evidence = result.regression.test(stretch(result.problem, result.regression, along=along))
    assert evidence.explained > 0.85  # not all: the ends are sharper than hats
    assert evidence.coefficients[0] == pytest.approx(1.5, rel=0.07)
    found = ends_of_stretch(result.problem, result.regression, along=along)
    assert found == pytest.approx((low, high), abs=0.05 * float(np.ptp(position)))


@pytest.mark.parametrize("seed", range(3))
def test_no_other_stretch_explains_more(made: Made, seed: int) -> None:
    """Running sums of products agree with a regression for each stretch."""
    result = examined(made(noise=2.0, seed=seed))
    problem, regression = result.problem, result.regression
    hats = _hats(problem, along=True, channel="position")
    limit = np.full(1, np.inf)
    every = {
        (i, j): regression.explained(hats[i:j].sum(axis=0)[None], -limit, limit)[0]
        for i in range(len(hats))
        for j in range(i + 1, len(hats) + 1)
    }
    best = max(every, key=lambda ends: every[ends])
    columns = stretch(problem, regression, along=True)
    np.testing.assert_allclose(columns.sum(axis=0), hats[best[0] : best[1]].sum(axis=0), atol=1e-12)


@pytest.mark.parametrize("step", [0.024, 0.1])
def test_functions_of_a_channel_are_the_same_ones_with_more_noise(step: float) -> None:
    """Moves at one speed, logged in steps, have fewer quantiles than with noise: hats stand on those without."""
    time = np.arange(8000) / 200.0
    within, forward = time % 2.0, (time // 2.0) % 2 == 0
    velocity = np.where(forward, 4.0, -4.0) * np.clip(np.minimum(within, 1.9 - within) / 0.3, 0.0, 1.0)
    noise = 0.003 * np.random.default_rng(0).standard_normal(8000)
    torque = INERTIA * np.gradient(velocity, time) + 4.0 * velocity + 17.0 * np.sign(velocity) + noise
    channels = {"time": time, "torque": torque, "velocity": step * np.round(velocity / step)}
    result = examined(Recording("moves", Motion.ROTARY, channels, np.zeros(8000, dtype=np.int64)))
    problem, regression = result.problem, result.regression
    known = basis_functions(problem, regression, POLICY)
    noisier = basis_functions(problem.perturbed, regression, POLICY, like=problem)
    assert {name: noisier[name]().shape for name in noisier} == {name: known[name]().shape for name in noisier}
    by_itself = basis_functions(replace(problem.perturbed), regression, POLICY)
    assert by_itself["speed, along the motion"]().shape != known["speed, along the motion"]().shape
