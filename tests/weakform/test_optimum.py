"""A fit of a model with memory ends at the least squares, not where the steps of its search are small."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.rig import random_rig
from fricmodels.weakform.nonlinear import Plan, nonlinear_search
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.solve import solve

FROM_THE_END = 0.1
"""Standard errors by which another step of Gauss–Newton may move an estimate; by steps alone it was 0.4 to 36."""


@pytest.mark.parametrize(
    ("effect", "seed"),
    [
        ("frictional-lag", 2),
        *(pytest.param(*o, marks=pytest.mark.long) for o in (("frictional-lag", 3), ("presliding", 2))),
    ],
)
def test_another_step_moves_nothing(effect: str, seed: int) -> None:
    rig = random_rig(np.random.default_rng(seed), [effect]).noiseless()
    recording = rig.simulate()
    drive = Drive(Model.parse(rig.true_model), rig.inertia, rig.motion)
    guess = {p.key: p.declared.initial for p in drive.parameters} | rig.truth["true_parameters"]
    problem = WeakFormProblem.of(drive, recording, guess)
    search = nonlinear_search(drive, recording)
    nonlinear = [p.key for p in drive.parameters if not p.linear]
    middle = {key: values[len(values) // 2] for key, values in zip(nonlinear, search.starts, strict=True)}
    found = solve(problem, Plan(start=middle), timing=False)
    step = found.moved_by(found.solution.residual[None])[:, 0]
    errors = np.array([found.standard_errors[key] for key in drive.keys])
    free = errors > 0.0
    for i, (p, value) in enumerate(zip(drive.parameters, found.values.tolist(), strict=True)):
        free[i] &= p.declared.lower < value + step[i] < p.declared.upper and p.at_least is None
    assert free.sum() > 2
    assert np.max(np.abs(step[free]) / errors[free]) < FROM_THE_END
