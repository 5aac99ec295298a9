"""Bounds of linear parameters: a stick torque is no larger than what pushed the drive, a part than the whole."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.conftest import Made

from fricmodels.diagnosis import compare
from fricmodels.dimension import VISCOUS
from fricmodels.drive import Drive
from fricmodels.effects.frictional_lag import FrictionalLag
from fricmodels.model import Model
from fricmodels.weakform.candidate import upper_bound
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.nonlinear import linear_constraints

LAW = Drive(Model.parse("exponential-stick-slip"), 2.0)


def test_only_a_stick_torque_has_that_bound() -> None:
    linear = [p for p in LAW.parameters if p.linear]
    rows, limits = linear_constraints(linear, largest_push=12.0)
    plain, _ = linear_constraints(linear)
    (row,) = (row for row, limit in zip(rows, limits, strict=True) if limit == -12.0)
    assert [p.key for p, weight in zip(linear, row, strict=True) if weight] == ["K_c"]
    assert len(rows) == len(plain) + 1


def test_it_is_kept_where_the_rows_would_take_anything(from_benchmarks: Callable[[str], Any]) -> None:
    """A drive with frictional lag, few samples of which are slow: K_c came out as 7e5 N m, and the error as 8e4 %."""
    from fricmodels.rig import random_rig

    rng = from_benchmarks("hidden.draw").generator(0, "processors", "frictional-lag", 4, 0)
    rig = random_rig(rng, ["frictional-lag"])
    recording = rig.simulate()
    free = compare(recording, "exponential-stick-slip", rig.inertia)
    plain = compare(recording, "coulomb-viscous", rig.inertia)
    assert free.estimate.parameters["K_c"] <= float(np.max(np.abs(recording.torque))) * (1 + 1e-9)
    assert free.errors.held_out_percent < 1.5 * plain.errors.held_out_percent


def test_a_part_of_a_drive_has_no_more_inertia_than_all_of_it() -> None:
    """Whether the inertia is known or estimated: J_l ≤ J. What is wrong of the inertia itself has no such bound."""
    model = Model.parse("coulomb-viscous+joint-compliance+inertia-error")
    for inertia in (None, 2.0):
        linear = [p for p in Drive(model, inertia).parameters if p.linear]
        keys = [p.key for p in linear]
        rows, limits = linear_constraints(linear, inertia=inertia)
        found = [
            ({key: weight for key, weight in zip(keys, row, strict=True) if weight}, limit)
            for row, limit in zip(rows, limits, strict=True)
            if row[keys.index("joint-compliance.J_l")] < 0
        ]
        whole = {"J": 1.0} if inertia is None else {}
        assert found == [({**whole, "joint-compliance.J_l": -1.0}, -(inertia or 0.0))]
        assert not any(row[keys.index("inertia-error.dJ")] < 0 for row in rows)


def test_friction_that_lags_has_no_more_of_what_is_viscous_than_the_law_in_either_direction() -> None:
    """(K_v − K) |ω| is left of the law's: with less than nothing it would drive."""
    for law, coefficients in (("coulomb-viscous", ["K_v"]), ("asymmetric-coulomb-viscous", ["K_v1", "K_v2"])):
        linear = [p for p in Drive(Model.parse(f"{law}+frictional-lag"), 2.0).parameters if p.linear]
        keys = [p.key for p in linear]
        rows, limits = linear_constraints(linear, inertia=2.0)
        found = [
            {key: weight for key, weight in zip(keys, row, strict=True) if weight}
            for row, limit in zip(rows, limits, strict=True)
            if row[keys.index("frictional-lag.K")] < 0 and limit == 0.0
        ]
        assert found == [{key: 1.0, "frictional-lag.K": -1.0} for key in coefficients]


@pytest.mark.parametrize("law", ["coulomb-viscous", "asymmetric-coulomb-viscous", "two-thirds-power"])
def test_no_more_friction_lags_than_the_drive_has(made: Made, law: str) -> None:
    """Not than the K_v of a fit without the lag, which may be half of what it is with it, or none.

    The fit with it has no more that lags than what is viscous.
    """
    problem, found = estimate(Drive(Model.parse(law), 2.0), made())
    most = upper_bound(problem, FrictionalLag.K)
    assert most == problem.friction_limits[0]
    assert all(most > found.parameters[p.key] for p in problem.drive.parameters if p.dimension == VISCOUS)
