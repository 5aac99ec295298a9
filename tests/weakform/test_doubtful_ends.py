"""Bounds of the search at which an estimate suggests that an effect with memory imitates another one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.weakform.candidate import within_recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.search import is_at_an_end

Made = Callable[..., Recording]

LENGTH = Parameter("x", unit="rad", initial=1.0, lower=0.5, upper=2.0)


@pytest.mark.parametrize(
    ("parameter", "value", "spacing", "ended"),
    [
        (LENGTH, 0.5, 2.0, True),
        (LENGTH, 2.0, 2.0, True),
        (LENGTH, 1.99, 2.0, False),
        (LENGTH, 2.0, 1.0, False),
        (replace(LENGTH, doubtful_ends=()), 2.0, 2.0, False),
        (replace(LENGTH, unit="1"), 2.0, 2.0, False),
        (replace(LENGTH, unit="1", doubtful_ends=("upper",)), 2.0, 2.0, True),
        (replace(LENGTH, unit="1", doubtful_ends=("upper",)), 0.5, 2.0, False),
        (replace(LENGTH, lower=-0.5, initial=0.0), -0.5, -0.1, True),
        (replace(LENGTH, lower=-0.5, initial=0.0), -0.4, -0.1, False),
        (replace(LENGTH, lower=-np.inf, upper=np.inf), 1e300, 2.0, False),
    ],
)
def test_the_end_of_a_parameter(parameter: Parameter, value: float, spacing: float, ended: bool) -> None:
    assert is_at_an_end([parameter], (value,), [spacing]) is ended


@pytest.mark.parametrize(("zeta", "ended"), [(0.0, False), (0.3, False), (1.0, True)])
def test_a_link_that_does_not_resonate_is_doubtful(zeta: float, ended: bool) -> None:
    own = {p.symbol: p for p in load().effects["joint-compliance"]().parameters}
    assert is_at_an_end([own["omega_n"], own["zeta"]], (30.0, zeta), [2.0, 2.0]) is ended
    assert own["zeta"].upper == 1.0


@pytest.mark.parametrize("symbol", ["omega_s", "T", "r"])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_friction_that_lags_is_doubtful_at_the_end_of_its_delay_only(made: Made, symbol: str, end: str) -> None:
    """At either end of its speed the falling part is nothing, and the viscous part may lag all the same; either end of
    its share is a lag of one kind."""
    problem, _ = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), made())
    effect = load().effects["frictional-lag"]()
    bounded = {p.symbol: within_recording(problem, p) for p in effect.parameters}
    nonlinear = [bounded["omega_s"], bounded["T"], bounded["r"]]
    point = tuple(getattr(p, end) if p.symbol == symbol else math.sqrt(p.lower * p.upper) for p in nonlinear)
    assert is_at_an_end(nonlinear, point, [3.0, 2.0, 2.0]) is (symbol == "T")
