"""The covariance by leaving out blocks of equations is the one of fits without each block."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import stdtrit

from fricmodels.weakform.inference import NORMAL_95, covariance, jackknife_covariance


@pytest.mark.parametrize("decisive", [False, True])
def test_it_is_that_of_fits_without_each_block(decisive: bool) -> None:
    """With a block that alone tells most of one parameter, its share is bounded; it is not beyond that here."""
    rng = np.random.default_rng(1)
    blocks, each = 8, 50
    jacobian = rng.standard_normal((blocks * each, 3))
    if decisive:  # of the trace 0.9 in one block, of the second parameter less than the bound of 7/8
        jacobian[:each, 1] *= 5.5
    target = jacobian @ np.array([1.0, 2.0, 3.0]) + rng.standard_normal(blocks * each)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    whole = inverse @ jacobian.T @ target
    found = jackknife_covariance(jacobian, target - jacobian @ whole, inverse, 400.0, blocks)
    without = []
    for block in range(blocks):
        kept = np.ones(len(target), dtype=bool)
        kept[block * each : (block + 1) * each] = False
        without.append(np.linalg.lstsq(jacobian[kept], target[kept], rcond=None)[0])
    apart = np.array(without) - np.mean(without, axis=0)
    widen = float(stdtrit(blocks - 1, 0.975)) / 1.959963984540054
    expected = widen**2 * (blocks - 1) / blocks * apart.T @ apart
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    share = np.trace(inverse @ jacobian[:each].T @ jacobian[:each])
    assert bool(share > 1.0 - 1.0 / blocks) == decisive


@pytest.mark.parametrize("few", [2, 6, 15])
def test_what_few_equations_of_one_block_show_is_as_uncertain_as_their_error_is_elsewhere(few: int) -> None:
    """A friction that a drive shows for a moment after a jump: such equations fit themselves, whatever their error."""
    rng, count, held = np.random.default_rng(4), 480, 0
    late = np.zeros(count)
    late[322 : 322 + few] = 1.0
    jacobian = np.column_stack([np.ones(count), np.sin(np.arange(count)), late])
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    for _ in range(400):
        noise = rng.standard_normal(count)
        found = inverse @ jacobian.T @ noise
        spread = covariance(jacobian, noise - jacobian @ found, inverse, float(count))
        held += abs(found[2]) < NORMAL_95 * np.sqrt(spread[2, 2])
    assert 0.90 <= held / 400 <= 0.99
