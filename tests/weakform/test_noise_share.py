"""Noise in a candidate's columns counts as much as the column that has it."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis.candidate_tests import noise_share
from fricmodels.diagnosis.comparison import compare
from fricmodels.diagnosis.policy import POLICY
from fricmodels.effects.thermal import Thermal
from fricmodels.weakform.candidate import Candidate
from fricmodels.weakform.shifted import noise_within, regression_of


@pytest.mark.parametrize("seed", [0, 1])
def test_a_column_that_is_mostly_noise_and_adds_nothing_hides_no_other(made: Made, seed: int) -> None:
    """Dry friction falls with the temperature: the viscous column is the law's own but for noise, and not needed."""
    plain = made(noise=15.0, samples=6000, seed=seed)
    warmer = 20.0 * (1.0 - np.exp(-plain.time / 4.0))
    torque = plain.torque - 0.02 * warmer * np.sign(plain.velocity)
    recording = plain.with_channels(derived=False, torque=torque, temperature=20.0 + warmer)
    comparison = compare(recording, "coulomb-viscous", INERTIA)
    problem, effect = comparison.problem, Thermal()
    regression = regression_of(problem, comparison.estimate.parameters)
    found = Candidate(problem, regression, effect, problem.alone(effect)).found((6.0,), 1.0)
    assert found.kept.all()
    columns, _ = problem.perturbed.columns(problem.alone(effect), found.nonlinear, 0.0)
    noise, signal = noise_within(problem, regression, found.columns, columns), regression.project_out(found.columns)
    viscous, dry = np.sum(noise**2, axis=1) / np.sum(signal**2, axis=1)
    share = noise_share(problem, problem.perturbed, regression, effect, found)
    assert viscous > POLICY.noise_share
    assert dry < 0.02
    assert share < 0.4 * POLICY.noise_share
