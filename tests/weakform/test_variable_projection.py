"""The fit of linear parameters at given nonlinear ones."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.equations import projection
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.problem import WeakFormProblem

MODELS = ("coulomb-viscous+stribeck", "coulomb-viscous+cogging+presliding", "exponential-stick-slip+cogging+stribeck")


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("inertia", [2.0, None])
def test_the_cost_is_the_same_whatever_was_tried_before(name: str, inertia: float | None, made) -> None:
    recording: Recording = made(samples=4000)
    drive = Drive(Model.parse(name), inertia)
    guess = {p.key: p.declared.initial for p in drive.model.parameters} | {"J": 2.0}
    plan = Plan()
    start = np.array([1.0 for p in drive.parameters if not p.linear])
    problem = WeakFormProblem.of(drive, recording.with_channels(acceleration=np.gradient(recording.velocity)), guess)
    least_squares, search = projection(problem, plan, timing=True)
    rng = np.random.default_rng(0)
    points: list[NDArray[np.float64]] = [search.clip(start)]
    for _ in range(30):  # one parameter after the other, as a search moves them, and back again
        moved = points[-1].copy()
        moved[rng.integers(len(moved))] *= rng.uniform(0.5, 2.0)
        points += [search.clip(moved), points[0]]
    in_turn = np.array([least_squares.cost_beside(point) for point in points])
    alone = np.array([least_squares.cost(point) for point in points])
    finite = np.isfinite(alone)
    np.testing.assert_array_equal(np.isfinite(in_turn), finite)
    np.testing.assert_allclose(in_turn[finite], alone[finite], rtol=1e-9)
    first = [cost for cost, point in zip(in_turn, points, strict=True) if point is points[0]]
    assert len(set(first)) == 1  # to the last bit
