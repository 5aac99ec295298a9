"""Published numbers of the unscented transform and filter."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter, MerweScaledSigmaPoints, unscented_transform
from fricmodels_ukf.sigma_points import BatchedUnscentedFilter, upper_root
from numpy.typing import NDArray

Array = NDArray[np.float64]


def test_polar_to_cartesian() -> None:
    """Julier and Uhlmann: a target at 1 m and 90°, deviations 2 cm and 15°: the mean is at 96.6 cm, not at 1 m."""
    deviation = np.array([0.02, np.radians(15.0)])
    points = MerweScaledSigmaPoints(2, 1.0, 0.0, 1.0, sqrt_method=upper_root)
    polar = points.sigma_points(np.array([1.0, np.pi / 2]), np.diag(deviation**2))
    cartesian = np.column_stack([polar[:, 0] * np.cos(polar[:, 1]), polar[:, 0] * np.sin(polar[:, 1])])
    mean, covariance = unscented_transform(cartesian, points.Wm, points.Wc)
    bearing = deviation[1] ** 2
    exact = np.exp(-bearing / 2)
    assert mean == pytest.approx([0.0, exact], abs=3e-5)
    assert exact == pytest.approx(0.9663, abs=5e-5)
    second = 1.0 + deviation[0] ** 2
    true = [second / 2 * (1 - np.exp(-2 * bearing)), second / 2 * (1 + np.exp(-2 * bearing)) - exact**2]
    assert np.sqrt(np.diag(covariance)) == pytest.approx(np.sqrt(true), rel=0.05)


def following(x: Array, moment: int) -> Array:
    """Return the state after a step, but for its noise, which is Gamma(3, 2) distributed."""
    return 1 + np.sin(0.04 * np.pi * moment) + 0.5 * x


def measured(x: Array, moment: int) -> Array:
    """Return what is measured of a state, but for its noise."""
    return 0.2 * x**2 if moment <= 30 else 0.5 * x - 2


def errors(seed: int) -> tuple[float, float]:
    """Return the RMS errors of the extended and of the unscented filter in one run of sixty steps.

    The source appends both noises to the state: three components, κ = 2, a spread of √5, which is κ = 4 here.
    """
    noise = np.random.default_rng(seed)
    state, extended, variance = 1.0, 1.0, 0.75
    unscented = BatchedUnscentedFilter(following, lambda x, moment: measured(x, moment), order=1, beta=0.0, kappa=4.0)
    unscented.x, unscented.R = np.ones(1), 1e-5 * np.eye(1)
    unscented.P, unscented.Q = 0.75 * np.eye(1), 0.75 * np.eye(1)
    gone = np.zeros((60, 2))
    for moment in range(2, 61):
        state = float(following(np.array(state), moment)) + noise.gamma(3.0, 0.5)
        y = float(measured(np.array(state), moment)) + np.sqrt(1e-5) * noise.standard_normal()
        prior = float(following(np.array(extended), moment))
        prior_variance = 0.75 + 0.25 * variance
        slope = 0.4 * prior if moment <= 30 else 0.5
        spread = slope**2 * prior_variance + 1e-5
        extended = prior + prior_variance * slope / spread * (y - float(measured(np.array(prior), moment)))
        variance = prior_variance - (prior_variance * slope) ** 2 / spread
        unscented.predict(moment=moment)
        unscented.update(np.array([y]), moment=moment)
        gone[moment - 1] = state - extended, state - unscented.x[0]
    rms = np.sqrt(np.mean(gone**2, axis=0))
    return float(rms[0]), float(rms[1])


def test_the_gamma_driven_series_of_the_unscented_particle_filter() -> None:
    """Van der Merwe, Doucet, de Freitas and Wan (2000), Table 1: mean (variance) 0.374 (0.015) and 0.280 (0.012)."""
    found = np.array([errors(seed) for seed in range(200)])
    for column, mean, variance in ((0, 0.374, 0.015), (1, 0.280, 0.012)):
        chance = np.sqrt(variance / 100 + found[:, column].var() / 200)
        assert abs(found[:, column].mean() - mean) < 3 * chance
        assert found[:, column].var() == pytest.approx(variance, rel=0.6)
    assert np.mean(found[:, 1]) < 0.85 * np.mean(found[:, 0])


@pytest.mark.parametrize(("alpha", "beta", "kappa"), [(1.0, 2.0, 0.0), (0.1, 2.0, 0.0), (1.0, 0.0, 3.0)])
def test_a_linear_system_has_its_kalman_filter(alpha: float, beta: float, kappa: float) -> None:
    """To rounding, whatever the spread: the transform of a linear function is exact."""
    noise = np.random.default_rng(3)
    matrix = np.array([[1.0, 0.1, 0.0], [-0.2, 0.9, 0.05], [0.0, 0.0, 1.0]])
    linear = KalmanFilter(dim_x=3, dim_z=1)
    linear.F, linear.H = matrix, np.array([[1.0, 0.0, 0.0]])
    sigma = BatchedUnscentedFilter(
        lambda points: points @ matrix.T, lambda x: x[:1], order=3, alpha=alpha, beta=beta, kappa=kappa
    )
    start, root = noise.standard_normal(3), noise.standard_normal((3, 3))
    for kalman in (linear, sigma):
        kalman.P, kalman.Q, kalman.R = root @ root.T, 1e-3 * np.eye(3), np.array([[0.04]])
    linear.x, sigma.x = start[:, None].copy(), start.copy()
    for y in noise.standard_normal(200):
        for kalman in (linear, sigma):
            kalman.predict()
            kalman.update(np.array([y]))
        assert sigma.x == pytest.approx(linear.x[:, 0], rel=1e-9, abs=1e-9)
        np.testing.assert_allclose(sigma.P, linear.P, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("rank", [0, 1, 2, 3, 4])
def test_the_root_of_a_covariance_of_any_rank(rank: int) -> None:
    """UᵀU is the covariance again, and U is upper triangular."""
    factor = np.random.default_rng(rank).standard_normal((4, rank)) * np.array([[1e-4], [1.0], [30.0], [1e-2]])
    covariance = factor @ factor.T
    root = upper_root(covariance)
    sizes = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    np.testing.assert_allclose(root.T @ root / np.outer(sizes, sizes), covariance / np.outer(sizes, sizes), atol=1e-9)
    assert np.array_equal(root, np.triu(root))


@pytest.mark.parametrize(
    "covariance", [[[1.0, 0.0], [0.0, -1.0]], [[1.0, 2.0], [2.0, 1.0]], [[1.0, 0.0], [0.0, np.nan]]]
)
def test_what_is_no_covariance_has_no_root(covariance: list[list[float]]) -> None:
    """A negative variance, a correlation above 1, a value that is no number."""
    with pytest.raises(np.linalg.LinAlgError, match="covariance"):
        upper_root(np.array(covariance))
