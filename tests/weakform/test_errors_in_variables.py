"""Noise in the acceleration: taken off where it is known, and no more of it than what is left can hold."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.weakform.errors_in_variables import noise_of_first, without_noise

INERTIA, ROWS = 0.05, 4000


def least_squares(
    noise: float, unexplained: float, seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """Return XᵀX, Xᵀy, plain least squares, what it leaves, and the true noise of the first column."""
    rng = np.random.default_rng(seed)
    true = rng.standard_normal((3, ROWS)) * np.array([[5.0], [1.0], [1.0]])
    target = np.array([INERTIA, 0.2, 1.0]) @ true + unexplained * rng.standard_normal(ROWS)
    seen, errors = true.copy(), noise * rng.standard_normal(ROWS)
    seen[0] += errors
    gram, right = seen @ seen.T, seen @ target
    plain = np.linalg.solve(gram, right)
    return gram, right, plain, float(np.sum((target - plain @ seen) ** 2)), float(errors @ errors)


@settings(max_examples=60, deadline=None)
@given(noise=st.floats(0.05, 3.0), unexplained=st.floats(0.0, 1.0), seed=st.integers(0, 10_000))
def test_noise_that_is_known_is_never_cut(noise: float, unexplained: float, seed: int) -> None:
    gram, right, plain, left, true = least_squares(noise, unexplained, seed)
    taken = noise_of_first(true, plain, left)
    assert taken == pytest.approx(true, rel=0.15 if unexplained < 0.01 else 1e-9)
    inertia = np.linalg.solve(without_noise(gram, taken), right)[0]
    error = np.sqrt(left / ROWS) / (5.0 * np.sqrt(ROWS))
    assert abs(inertia - INERTIA) < 6.0 * error + 0.02 * INERTIA * (noise / 5.0) ** 2


@pytest.mark.parametrize("times", [3.0, 30.0, 1e4])
def test_noise_that_is_taken_too_large_makes_no_larger_inertia_than_what_is_left_allows(times: float) -> None:
    """A ripple of the speed that is taken for noise made an inertia three hundredths too large."""
    gram, right, plain, left, true = least_squares(0.1, 0.003, 1)
    taken = noise_of_first(times * true, plain, left)
    assert taken <= left / plain[0] ** 2
    assert np.linalg.solve(without_noise(gram, taken), right)[0] == pytest.approx(INERTIA, rel=2e-3)


def test_at_most_half_of_what_the_others_leave_is_noise() -> None:
    gram, _, plain, left, true = least_squares(4.0, 5.0, 3)
    alone = 1.0 / np.linalg.inv(gram)[0, 0]
    taken = noise_of_first(100.0 * true, plain, left)
    assert gram[0, 0] - without_noise(gram, taken)[0, 0] == pytest.approx(0.5 * alone)


def test_products_stay_those_of_columns_beside_one_that_is_nearly_the_first() -> None:
    """As the slope of a nonlinear parameter may be: the noise that was found without it is more than it leaves."""
    gram, _, plain, left, true = least_squares(3.0, 0.5, 3)
    rng = np.random.default_rng(0)
    columns = rng.standard_normal((2, 4))
    beside = np.array([[1.0, 0.99], [0.99, 1.0]]) * gram[0, 0] + columns @ columns.T
    assert true > 1.0 / np.linalg.inv(beside)[0, 0]
    assert np.linalg.eigvalsh(without_noise(beside, noise_of_first(true, plain, left))).min() > 0.0
