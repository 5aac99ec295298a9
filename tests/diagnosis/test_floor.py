"""What noise and sampling leave, and which share of the rest an effect explains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.floor import (
    creditable,
    floor,
    gain_above_noise,
    is_far_above_noise,
    is_noticed,
    share_explained,
)
from fricmodels.diagnosis.policy import POLICY
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.shifted import regression_of

Made = Callable[..., Recording]
LAW = Model.parse("coulomb-viscous")


def test_the_floor_is_what_the_true_model_leaves(made: Made) -> None:
    problem, found = estimate(Drive(LAW, 2.0), made(noise=2.0))
    left = regression_of(problem, found.parameters).residual
    sampling = POLICY.least_torque**2 * float(problem.driving @ problem.driving)
    assert floor(problem) - sampling == pytest.approx(float(left @ left), rel=0.3)


def test_without_noise_sampling_alone_is_left(made: Made) -> None:
    problem, _ = estimate(Drive(LAW, 2.0), made(noise=0.0))
    assert floor(problem) == pytest.approx(POLICY.least_torque**2 * float(problem.driving @ problem.driving), rel=1e-3)


def test_the_floor_goes_with_the_unit_of_torque(made: Made) -> None:
    recording = made(noise=1.0)
    larger = recording.with_channels(derived=False, torque=10 * recording.torque)
    first, second = (estimate(Drive(LAW, j), r)[0] for j, r in ((2.0, recording), (20.0, larger)))
    assert floor(second) == pytest.approx(100 * floor(first), rel=1e-6)


def test_shares(made: Made) -> None:
    problem, found = estimate(Drive(LAW, 2.0), made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5}))
    before = regression_of(problem, found.parameters)
    total, least = float(np.sum(before.residual**2)), floor(problem)
    assert total > 10 * least
    assert share_explained(problem, total, total) == pytest.approx(0.0, abs=1e-12)
    assert share_explained(problem, total, 0.5 * (total + least)) == pytest.approx(0.5)
    assert share_explained(problem, total, least) == share_explained(problem, total, 0.0) == 1.0
    assert share_explained(problem, 0.5 * least, 0.4 * least) == 1.0, "all of it lies under the floor"
    assert share_explained(problem, 0.5 * least, 0.6 * least) == 0.0, "and what makes it worse explains nothing"


def test_what_lies_under_the_floor_is_nobodys_to_explain(made: Made) -> None:
    problem, _ = estimate(Drive(LAW, 2.0), made(noise=1.0))
    least = floor(problem)
    assert creditable(problem, 5 * least, 2 * least) == 2 * least
    assert creditable(problem, 5 * least, 4.5 * least) == creditable(problem, 5 * least, 5 * least) == 4 * least
    assert creditable(problem, 0.5 * least, 0.4 * least) == 0.0
    assert creditable(problem, 0.5 * least, -1e-12 * least) == creditable(problem, 5 * least, -least) == 0.0


def test_a_gain_is_that_of_what_noise_leaves(made: Made) -> None:
    """An offset that is certain, and a small part of what is mostly noise; without noise it is nearly all there is."""
    gains = {}
    for noise in (0.0, 10.0):
        recording = made("coulomb-viscous+torque-offset", {"torque-offset.tau_0": 0.3}, noise=noise)
        problem, found = estimate(Drive(LAW, 2.0), recording)
        result = candidate_tests(problem, found.parameters, only=["torque-offset"])
        evidence = result.tested[0].evidence
        gains[noise] = evidence.gain, gain_above_noise(problem, result.regression, evidence, POLICY)
    assert gains[0.0] == pytest.approx((gains[0.0][1],) * 2, rel=0.02)
    assert gains[10.0][0] < POLICY.least_gain < 0.2 < gains[10.0][1]


def test_what_is_predicted_is_noticed_as_a_part_of_the_error(made: Made) -> None:
    comparison = compare(made(noise=1.0), LAW, 2.0)
    line = replace(comparison.errors.headline, noise_floor_percent=0.0, fit_noise_percent=0.0)
    comparison = replace(comparison, errors=replace(comparison.errors, headline=line, bands=(line,)))
    whole = float(np.hypot(line.percent, line.held_out_percent)) / np.sqrt(2.0)
    policy = POLICY
    only = replace(policy, noticed_torque=np.inf)
    assert is_noticed(comparison, 1.01 * np.sqrt(policy.noticed) * whole, only)
    assert not is_noticed(comparison, 0.99 * np.sqrt(policy.noticed) * whole, only)
    assert is_noticed(comparison, 1e-9, replace(only, noticed=0.0))


@pytest.mark.parametrize(("percent", "noticed"), [(0.99, False), (1.01, True)])
def test_of_an_error_that_sampling_makes_a_part_of_the_torque_is_noticed(
    made: Made, percent: float, noticed: bool
) -> None:
    """A drift of 1.9 % was adequate beside an error of single samples of 6 % about reversals."""
    comparison = compare(made(noise=1.0), LAW, 2.0)
    line = replace(comparison.errors.headline, percent=30.0, held_out_percent=30.0, noise_floor_percent=0.0)
    comparison = replace(comparison, errors=replace(comparison.errors, headline=line, bands=(line,)))
    assert is_noticed(comparison, percent) == noticed


@pytest.mark.parametrize(
    ("share", "clear", "noticed"), [(0.98, True, True), (0.98, False, False), (0.94, False, True), (1.02, True, False)]
)
@pytest.mark.parametrize("tested", [False, True])
def test_of_an_error_that_noise_alone_would_leave_nothing_is_noticed(
    made: Made, share: float, clear: bool, noticed: bool, tested: bool
) -> None:
    """In the mean of both parts, and on test data; in some window a tenth of the squared error lies beyond noise.

    Counts of an encoder had left 5.47 % where their noise leaves 5.45, and a clean drive was called unknown.
    """
    comparison = compare(made(noise=1.0), LAW, 2.0)
    whole = comparison.errors.headline.percent
    line = replace(comparison.errors.headline, held_out_percent=whole * (0.99 if tested else 1.01))
    bar = share * (line.held_out_percent if tested else np.hypot(whole, line.held_out_percent) / np.sqrt(2.0))
    line = replace(line, noise_floor_percent=bar, fit_noise_percent=bar)
    wide = replace(line, noise_floor_percent=0.5 * bar, fit_noise_percent=0.5 * bar) if clear else line
    errors = replace(comparison.errors, headline=line, bands=(line, wide))
    assert is_noticed(replace(comparison, errors=errors), 1.1 * whole) == noticed


@pytest.mark.parametrize(("noise", "far"), [(0.9, True), (1.1, False)])
def test_what_is_no_more_than_the_printed_noise_is_not_far_above_noise(made: Made, noise: float, far: bool) -> None:
    """Where counts of an encoder make the velocity, the long window of the decisions has an error of its own."""
    comparison = compare(made("coulomb-viscous+gravity", {"gravity.a": 9.0, "gravity.b": 3.0}), LAW, 2.0)
    line = comparison.errors.headline
    line = replace(line, noise_floor_percent=noise * min(line.percent, line.held_out_percent))
    assert is_far_above_noise(replace(comparison, errors=replace(comparison.errors, headline=line))) == far
