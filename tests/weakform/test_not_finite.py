"""A state that runs away at some value of a parameter is no end of a fit."""

from __future__ import annotations

import numpy as np

from fricmodels.weakform.least_squares import NormalEquations


def test_columns_that_are_not_finite_determine_nothing() -> None:
    for wrong in (np.nan, np.inf):
        gram = np.array([[2.0, 0.5], [0.5, wrong]])
        normal = NormalEquations.of(gram, np.array([1.0, wrong]))
        assert normal.null.shape == (2, 2)
        assert np.array_equal(normal.solve(np.zeros((0, 2)), np.zeros(0)), [0.0, 0.0])


def test_products_with_a_target_that_is_not_finite_have_no_solution() -> None:
    normal = NormalEquations.of(np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([1.0, np.nan]))
    assert not np.any(np.isfinite(normal.solve(np.eye(2), np.zeros(2))))
