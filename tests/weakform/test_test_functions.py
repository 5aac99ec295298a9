"""The test functions of the weak form against their definition."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.test_functions import HOPS
from fricmodels.weakform.test_functions import TestFunctions as Functions

RUNS = {"one run": [203], "uneven ones": [31, 5, 64, 127, 32], "none long enough": [10, 12], "many": [1500]}


def recording(lengths: list[int]) -> Recording:
    run = np.repeat(np.arange(len(lengths)), lengths)
    time = 0.01 * np.arange(len(run))
    return Recording("test functions", Motion.ROTARY, {"time": time, "torque": np.zeros(len(run))}, run)


def by_definition(lengths: list[int], width: int, unclear: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the weight of every sample in every test function of which no sample is unclear, shape (functions, N)."""
    x = 2.0 * np.arange(width + 1) / width - 1.0
    shape = (1.0 - x**2) ** 2
    kernel = (shape[:-1] + shape[1:]) / 2 / shape.sum()
    rows, begin = [], 0
    for length in lengths:
        for start in range(begin, begin + length // (width // HOPS) * (width // HOPS) - width + 1, width // HOPS):
            row = np.zeros(sum(lengths))
            row[start : start + width] = kernel
            if not unclear[start : start + width].any():
                rows.append(row)
        begin += length
    return np.array(rows).reshape(len(rows), sum(lengths))


@pytest.mark.parametrize("width", [8, 16, 24, 32])
@pytest.mark.parametrize("name", RUNS)
def test_integrals_and_momentum(name: str, width: int) -> None:
    rng = np.random.default_rng(0)
    lengths = RUNS[name]
    count = sum(lengths)
    unclear = rng.random(count) < 0.01
    test_functions = Functions(recording(lengths), width, unclear, least_moving=1.0)
    weights = by_definition(lengths, width, unclear)
    assert test_functions.count == len(weights)
    rows = rng.normal(size=(3, count))
    np.testing.assert_allclose(test_functions.integrals(rows), rows @ weights.T, rtol=1e-12, atol=1e-14)
    assert test_functions.integrals(rows[:0]).shape == (0, test_functions.count)
    # ∫φ dω of a constant is nothing; of a straight line of slope one a sample, what φ adds up to: one.
    np.testing.assert_allclose(test_functions.momentum(np.full(count, 3.0)), 0, atol=1e-13)
    if width > HOPS:
        np.testing.assert_allclose(test_functions.momentum(np.arange(count, dtype=float)), 1, rtol=1e-12)


@pytest.mark.parametrize("width", [16, 32, 64])
@pytest.mark.parametrize("instant", [0.4013, 0.4050, 0.4096])
def test_a_reversal_within_a_cell_is_exact(width: int, instant: float) -> None:
    """J dω/dt = −τ_F with another friction torque on either side: momentum and impulse agree in every test function.

    Weighted by samples in place of cells they differ about the reversal, as a doublet.
    """
    one = recording([96])
    slow, fast = 3.0, 7.0  # slopes of the velocity before and after it passes zero
    velocity = np.where(one.time < instant, slow, fast) * (one.time - instant)
    still = np.zeros(len(one), dtype=bool)
    quadrature = Quadrature.of(one.with_channels(velocity=velocity), velocity, still)
    assert len(quadrature.cell) == 1
    functions = Functions(one, width, still)
    driving = np.where(quadrature.recording.velocity < 0, slow, fast)
    impulse = functions.of_cells(quadrature.impulses(driving[None]))[0]
    np.testing.assert_allclose(impulse, functions.momentum(velocity), rtol=0, atol=1e-12)


@pytest.mark.parametrize("over_cells", [False, True])
def test_many_rows_are_what_each_is_alone(over_cells: bool) -> None:
    rng = np.random.default_rng(2)
    one, velocity = recording([203, 90]), np.convolve(rng.normal(size=300), np.ones(8), "valid")
    test_functions = Functions(one, 16, np.zeros(len(one), dtype=bool), over_cells=over_cells)
    quadrature = Quadrature.of(one, velocity, np.zeros(len(one), dtype=bool))
    rows = rng.normal(size=(19, len(quadrature.recording)))
    alone = np.concatenate([test_functions.torques(quadrature, row[None]) for row in rows])
    np.testing.assert_array_equal(test_functions.torques(quadrature, rows), alone)
    assert test_functions.torques(quadrature, rows[:0]).shape == (0, test_functions.count)
