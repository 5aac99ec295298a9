"""Tests that hold for autocorrelated rows: their size, their power, and the algebra beneath."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.stats import f as fisher

from fricmodels.weakform.long_run import cosine_terms, long_run_sum
from fricmodels.weakform.regression import FOLDS, Regression, by_chance, compare

Array = NDArray[np.float64]


def noise(rng: np.random.Generator, rho: float, *shape: int) -> Array:
    """AR(1) noise of unit variance along the last axis, stationary from the first sample on."""
    white = rng.standard_normal((*shape[:-1], shape[-1] + 400)) * np.sqrt(1 - rho**2)
    return np.asarray(lfilter([1.0], [1.0, -rho], white, axis=-1)[..., 400:])


@pytest.mark.parametrize(("rho", "independent", "most"), [(0.0, 2000, 0.07), (0.5, 2000, 0.08), (0.9, 200, 0.10)])
def test_a_true_null_is_rejected_about_as_often_as_said(rho: float, independent: float, most: float) -> None:
    """Ordinary F tests reject a true null of ρ = 0.9 in most cases; these must stay near the nominal 5 %."""
    rng = np.random.default_rng(1)
    trials, rows = 400, 2000
    base = np.vstack([np.ones(rows), noise(rng, rho, rows)])
    rejected = ordinary = 0
    for _ in range(trials):
        target, column = noise(rng, rho, 2, rows)
        regression = Regression(base, target, independent)
        rejected += regression.test(column[None]).p_value < 0.05
        free = regression.project_out(column[None])[0]
        explained = float(free @ regression.residual) ** 2 / float(free @ free)
        rest = float(regression.residual @ regression.residual) - explained
        ordinary += fisher.sf(explained / rest * (rows - 3), 1, rows - 3) < 0.05
    assert 0.02 <= rejected / trials <= most
    if rho == 0.9:
        assert ordinary / trials > 0.4


def test_the_size_holds_for_several_columns_at_once() -> None:
    rng = np.random.default_rng(2)
    rejected = 0
    for _ in range(300):
        target = noise(rng, 0.5, 1000)
        rejected += Regression(np.ones((1, 1000)), target, 500).test(noise(rng, 0.5, 4, 1000)).p_value < 0.05
    assert 0.02 <= rejected / 300 <= 0.10


def test_power_rises_with_the_effect_to_certainty() -> None:
    rng = np.random.default_rng(3)
    shares = []
    for size in (0.0, 0.1, 0.3, 1.0):
        found = 0
        for _ in range(60):
            column, error = noise(rng, 0.5, 2, 1000)
            found += Regression(np.ones((1, 1000)), size * column + error, 500).test(column[None]).p_value < 0.01
        shares.append(found / 60)
    assert shares == sorted(shares)
    assert shares[0] < 0.1
    assert shares[-1] == 1.0


def test_coefficients_and_covariance_cover_the_truth() -> None:
    rng = np.random.default_rng(4)
    inside, trials = 0, 300
    for _ in range(trials):
        columns, error = noise(rng, 0.7, 2, 1000), noise(rng, 0.7, 1000)
        base = np.ones((1, 1000))
        evidence = Regression(base, 5 + 2 * columns[0] - 3 * columns[1] + error, 300).test(columns)
        spread = np.sqrt(np.diag(evidence.covariance))
        inside += abs(evidence.coefficients[0] - 2) < 1.96 * spread[0]
    assert 0.87 <= inside / trials <= 0.99


def test_the_base_model_is_projected_out() -> None:
    rng = np.random.default_rng(5)
    base, columns, target = rng.normal(size=(3, 200)), rng.normal(size=(2, 200)), rng.normal(size=200)
    regression = Regression(base, target, 100)
    free = regression.project_out(columns)
    np.testing.assert_allclose(free @ base.T, 0, atol=1e-10)
    np.testing.assert_allclose(regression.project_out(free), free, atol=1e-12)
    np.testing.assert_allclose(regression.project_out(base), 0, atol=1e-12)
    whole = np.linalg.lstsq(np.vstack([base, columns]).T, target, rcond=None)[0]
    np.testing.assert_allclose(regression.test(columns).coefficients, whole[3:], rtol=1e-9)


def test_what_the_base_can_do_itself_is_invisible() -> None:
    rng = np.random.default_rng(6)
    base = rng.normal(size=(2, 200))
    regression = Regression(base, rng.normal(size=200), 100)
    new = rng.normal(size=200)
    columns = np.vstack([base[0] + base[1], new, 3 * new + base[0], np.zeros(200), np.full(200, np.nan)])
    np.testing.assert_array_equal(regression.visible(columns), [False, True, False, False, False])


def test_scaling_base_columns_or_target_changes_no_verdict() -> None:
    rng = np.random.default_rng(7)
    base, columns, target = rng.normal(size=(2, 300)), rng.normal(size=(2, 300)), rng.normal(size=300)
    one = Regression(base, target, 100).test(columns)
    other = Regression(base * [[1e6], [1e-6]], 1e3 * target, 100).test(columns * [[1e-4], [1e4]])
    assert other.p_value == pytest.approx(one.p_value, rel=1e-6)
    assert other.explained == pytest.approx(one.explained, rel=1e-8)
    assert other.gain == pytest.approx(one.gain, rel=1e-6)
    np.testing.assert_allclose(other.coefficients, one.coefficients * 1e3 / [1e-4, 1e4], rtol=1e-8)


def test_held_out_residuals_are_those_of_a_refit_without_the_block() -> None:
    rng = np.random.default_rng(8)
    columns, target = rng.normal(size=(3, 164)), rng.normal(size=164)
    found = Regression(columns[:1], target, 50).held_out(columns)
    edges = np.linspace(0, 164, FOLDS + 1).astype(int)
    for begin, end in pairwise(edges):
        inside = np.zeros(164, dtype=bool)
        inside[begin:end] = True
        theta = np.linalg.lstsq(columns[:, ~inside].T, target[~inside], rcond=None)[0]
        np.testing.assert_allclose(found[inside], target[inside] - theta @ columns[:, inside], atol=1e-10)


def test_a_true_effect_gains_on_blocks_that_were_kept_back_and_noise_loses() -> None:
    rng = np.random.default_rng(9)
    column, error, wrong = rng.normal(size=(3, 2000))
    regression = Regression(np.ones((1, 2000)), column + error, 1000)
    evidence = regression.test(column[None])
    assert evidence.gain == pytest.approx(1 - 1 / np.sqrt(2), abs=0.03)
    assert evidence.explained == pytest.approx(0.5, abs=0.05)
    assert evidence.gain_p_value < 1e-3
    false = regression.test(wrong[None])
    assert false.gain < 0.005
    assert false.explained < 0.01


def test_bounds_leave_out_what_would_have_to_be_negative() -> None:
    rng = np.random.default_rng(10)
    columns = rng.normal(size=(2, 500))
    regression = Regression(np.ones((1, 500)), 2 * columns[0] - 3 * columns[1], 100)
    everything, theta = regression.explained(columns, np.full(2, -np.inf), np.full(2, np.inf))
    np.testing.assert_allclose(theta, [2, -3], rtol=1e-9)
    some, theta = regression.explained(columns, np.zeros(2), np.full(2, np.inf))
    assert theta[1] == 0
    assert theta[0] > 0
    assert 0 < some < everything
    assert regression.explained(columns[1:], np.zeros(1), np.ones(1)) == (0.0, np.zeros(1))


@pytest.mark.parametrize("rho", [0.0, 0.8])
def test_the_long_run_variance_of_a_sum(rho: float) -> None:
    """The sum of T samples of unit AR(1) noise has the variance T (1 + ρ)/(1 − ρ)."""
    rng = np.random.default_rng(11)
    found = [long_run_sum(noise(rng, rho, 1, 4000), 60)[0, 0] for _ in range(200)]
    assert np.mean(found) == pytest.approx(4000 * (1 + rho) / (1 - rho), rel=0.06)


def test_the_number_of_cosines() -> None:
    """0.4 T^(2/3), at least 8, fewer than rows (Lazarus, Lewis, Stock and Watson 2018)."""
    assert cosine_terms(1000, 5000) == 40
    assert cosine_terms(10, 5000) == 8
    assert cosine_terms(1000, 6) == 5


def test_equal_losses_prove_nothing() -> None:
    loss = np.random.default_rng(12).random(100)
    assert compare(loss, loss, 8) == (0.0, 1.0)
    gain, p_value = compare(loss, 0.25 * loss, 8)
    assert gain == pytest.approx(0.5)
    assert p_value < 0.01
    assert compare(0.25 * loss, loss, 8)[1] > 0.99


def test_the_p_value_of_columns_that_are_nearly_alike_is_that_of_their_span() -> None:
    """Each differs from the first by ever less; together they span the same as unlike ones."""
    rng = np.random.default_rng(12)
    unlike = rng.normal(size=(4, 1000))
    target = 0.2 * unlike.sum(axis=0) + rng.normal(size=1000)
    alike = np.vstack([unlike[0], *(unlike[0] + 10.0**-k * unlike[k] for k in (1, 2, 3))])
    regression = Regression(np.ones((1, 1000)), target, 500)
    assert regression.test(alike).p_value == pytest.approx(regression.test(unlike).p_value, rel=1e-5)


def test_a_few_independent_rows_prove_nothing() -> None:
    """Ten rows that overlap so much that three of them are independent: what fits them all is no evidence."""
    rng = np.random.default_rng(4)
    base, target = rng.standard_normal((2, 10)), rng.standard_normal(10)
    columns = np.vstack([target + 1e-3 * rng.standard_normal(10), rng.standard_normal((3, 10))])
    assert Regression(base, target, 3.0).test(columns).p_value == 1.0
    assert Regression(base, target, 3.0).test(columns[:1]).p_value > 1e-4


def test_the_size_holds_with_few_rows() -> None:
    """Twenty white rows, the base takes four: 8.5 % are rejected at 5 %, and 13.6 % were that not allowed for."""
    rng = np.random.default_rng(6)
    found = []
    for _ in range(1500):
        regression = Regression(rng.standard_normal((4, 20)), rng.standard_normal(20), 20.0)
        found.append(regression.test(rng.standard_normal((2, 20))).p_value)
    assert np.mean(np.array(found) < 0.05) < 0.1


def test_a_column_next_to_nothing_has_an_infinite_variance() -> None:
    rng = np.random.default_rng(3)
    regression = Regression(np.ones((1, 200)), rng.standard_normal(200), 50.0)
    column = rng.standard_normal((1, 200))
    small, usual = (regression.test(size * column) for size in (1e-160, 1.0))
    assert small.covariance[0, 0] == np.inf
    assert small.p_value == pytest.approx(usual.p_value)
    assert small.explained == pytest.approx(usual.explained)


def test_one_event_that_the_rest_predicts_is_a_gain() -> None:
    """A single event holds nearly all that is left: the mean difference has hardly a variance to be told by."""
    rng = np.random.default_rng(8)
    column = 0.3 * rng.standard_normal(400)
    column[150:158] += 40.0  # within one block
    for size, sure in ((1.0, True), (0.0, False)):
        target = size * column + 0.05 * rng.standard_normal(400) + (1.0 - size) * np.roll(column, 90)
        evidence = Regression(np.ones((1, 400)), target, 200).test(column[None])
        assert (evidence.gain_p_value < 0.1) is sure
        assert evidence.gain_p_value <= max(1.0 - evidence.gain, 0.0) or not sure


@pytest.mark.parametrize("sizes", [[1.0], [1.0, 1.0], [0.9, 0.1], [0.5, 0.2, 0.1, 0.1, 0.05, 0.05], [1.0] * 8])
def test_how_probable_it_is_that_few_events_are_predicted_by_chance(sizes: list[float]) -> None:
    """Against random predictions, each from nothing to twice its event."""
    weights = np.array(sizes) / np.sum(sizes)
    off = np.random.default_rng(3).uniform(-1.0, 1.0, (400_000, len(weights)))
    left = np.sqrt(off**2 @ weights)
    for share in (0.1, 0.2, 0.4):
        drawn = float(np.mean(left <= share))
        bound = by_chance(np.array(sizes), share)
        assert bound >= drawn - 3 * np.sqrt(drawn / len(left))
        if share**2 <= weights.min():  # no event can be missed by more than all together leave: it is the probability
            assert bound == pytest.approx(drawn, rel=0.05, abs=1e-5)
    assert by_chance(np.array(sizes), 1.0) == pytest.approx(1.0)
    assert by_chance(np.array([4.0, 0.0]), 0.3) == pytest.approx(0.3)


@pytest.mark.parametrize(("elsewhere", "sure"), [(1.0, True), (0.0, False)])
def test_a_gain_all_over_is_seen_beside_one_event_that_holds_most_of_the_error(elsewhere: float, sure: bool) -> None:
    """A blow that is predicted to a half has the mean difference and its variance; what is gained besides decides."""
    rng, count = np.random.default_rng(2), 800
    place = np.arange(count)
    shape = np.sin(0.7 * place) * (elsewhere + 40.0 * np.exp(-(((place - 60) / 8.0) ** 2)))
    blow = 40.0 * np.sin(0.7 * place + 1.0) * np.exp(-(((place - 60) / 8.0) ** 2))
    target = shape + blow + 0.7 * rng.standard_normal(count)
    regression = Regression(np.ones((1, count)), target, float(count))
    if not elsewhere:  # next to nothing outside of the event: the coefficient is told by it alone
        shape = shape + 1e-3 * rng.standard_normal(count)
    evidence = regression.test(shape[None])
    edges = regression._edges
    event = np.argmax(np.add.reduceat(regression.loss, edges[:-1]))
    assert np.sum(regression.loss[edges[event] : edges[event + 1]]) > 0.7 * np.sum(regression.loss)
    assert compare(regression.loss, evidence.loss, regression.terms)[1] > 0.1
    assert (evidence.gain_p_value < 0.01) is sure
