"""How many cosines estimate the variance of a test: as many as what is left, and the strokes of the motion, allow."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.weakform.regression import Regression, cosine_terms, score_terms
from fricmodels.weakform.stretches import strokes

ROWS, INDEPENDENT = 800, 200.0
WIDTH = 8
"""Rows of a bump width, two of which are independent."""


def lasting(rho: float, rows: int, rng: np.random.Generator) -> np.ndarray:
    """Return a first-order process with correlation ρ from one bump width to the next."""
    from scipy.signal import lfilter

    step = rho ** (1 / WIDTH)
    return np.asarray(lfilter([1.0], [1.0, -step], rng.standard_normal(rows + 1000))[1000:])


@pytest.mark.parametrize("rho", [0.2, 0.5, 0.8])
def test_the_number_is_where_the_squared_error_of_the_variance_is_least(rho: float) -> None:
    """By the bias and the variance of a mean of ν values of the process's own spectrum, summed up, not by a formula."""
    rng, found, widths = np.random.default_rng(1), [], 5000
    for _ in range(3):
        series = lasting(rho, WIDTH * widths, rng)[None]
        found.append(score_terms(series, 2.0 * widths))
    step = rho ** (1 / WIDTH)
    frequency = np.pi * np.arange(1, 4000) / (WIDTH * widths)
    spectrum = (1 - step) ** 2 / (1 - 2 * step * np.cos(frequency) + step**2)
    count = np.arange(1, 4000)
    bias = np.cumsum(spectrum) / count - 1
    best = int(count[np.argmin(bias**2 + 2 / count)])
    assert np.mean(found) == pytest.approx(best, rel=0.35)


def test_what_lasts_longest_counts() -> None:
    rng = np.random.default_rng(2)
    white, slow = rng.standard_normal(ROWS), lasting(0.9, ROWS, rng)
    many, few = (score_terms(x[None], INDEPENDENT) for x in (white, slow))
    assert few < 0.3 * many
    assert score_terms(np.array([white, slow]), INDEPENDENT) == few
    assert score_terms(1e-6 * slow[None, ::-1], INDEPENDENT) == pytest.approx(few, abs=1)
    assert score_terms(np.zeros((2, ROWS)), INDEPENDENT) >= 1


def p_of_a_clear_effect(strokes: float) -> float:
    """Return the p-value of four columns that explain half of 400 rows, of which 100 are independent."""
    rng = np.random.default_rng(3)
    kernel = np.hanning(9)[1:-1]
    columns = np.array([np.convolve(rng.standard_normal(400), kernel, "same") for _ in range(4)])
    error = np.convolve(rng.standard_normal(400), kernel, "same")
    signal = columns.sum(axis=0)
    target = signal * np.std(error) / np.std(signal) + error
    return Regression(np.ones((1, 400)), target, 100.0, strokes).test(columns).p_value


def test_what_explains_half_of_few_rows_is_evident_after_many_strokes() -> None:
    assert cosine_terms(100.0, 400) == 9
    assert p_of_a_clear_effect(50) < 1e-2 * p_of_a_clear_effect(1)
    assert p_of_a_clear_effect(2) == p_of_a_clear_effect(1)


@pytest.mark.parametrize("rho", [0.0, 0.5])
def test_a_true_null_is_rejected_as_seldom_as_with_the_fewest_cosines(rho: float) -> None:
    rng, rejected = np.random.default_rng(4), np.zeros(2)
    for _ in range(400):
        target = lasting(rho, ROWS, rng) if rho else rng.standard_normal(ROWS)
        columns = np.array([lasting(0.5, ROWS, rng) for _ in range(2)])
        for i, count in enumerate((1.0, np.inf)):
            rejected[i] += Regression(np.ones((1, ROWS)), target, INDEPENDENT, count).test(columns).p_value < 0.05
    assert rejected[1] <= rejected[0] + 8
    assert rejected[1] / 400 < 0.12


def test_strokes_are_counted_where_there_is_a_direction() -> None:
    time = np.linspace(0, 10, 5000, endpoint=False)
    velocity, run = np.sin(2 * np.pi * time), np.zeros(5000, dtype=np.int64)
    assert strokes(velocity, run) == 20
    chatter = np.where(np.abs(velocity) < 0.02, 0.02 * (-1.0) ** np.arange(5000), velocity)
    assert strokes(chatter, run) == 20
    assert strokes(3.0 + velocity, run) == 1
    assert strokes(3.0 + velocity, np.repeat(np.arange(4), 1250)) == 4
    assert strokes(np.zeros(5000), run) == 0
    assert strokes(-7.0 * velocity, run) == 20
