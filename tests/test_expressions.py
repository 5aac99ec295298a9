"""The mathematics of terms: the sign at rest, powers at rest, smooth against sharp."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels import expressions as ex

speeds = st.floats(-1e3, 1e3, allow_subnormal=False)


def value(expression: Callable[[Any], Any], at: float, *, derivative: bool = False) -> float:
    x = casadi.SX.sym("x")
    built = expression(x)
    return float(casadi.Function("f", [x], [casadi.jacobian(built, x) if derivative else built])(at))


def test_the_sign_at_rest_is_the_papers() -> None:
    """Eq. 4: sgn1(0) = 1 and sgn2(0) = 0."""
    for zero in (0.0, -0.0):
        assert value(ex.positive, zero) == 1.0
        assert value(ex.negative, zero) == 0.0
        assert value(ex.sign, zero) == 1.0


@given(speeds)
def test_signs_are_the_textbooks_elsewhere(x: float) -> None:
    assert value(ex.positive, x) == (1.0 if x >= 0 else 0.0)
    assert value(ex.positive, x) + value(ex.negative, x) == 1.0
    if x != 0:
        assert value(ex.sign, x) == np.sign(x)


@given(speeds, st.floats(1e-3, 10.0))
def test_the_smooth_sign_is_the_hyperbolic_tangent_of_its_width(x: float, width: float) -> None:
    with ex.rest_treatment(width, smooth=True):
        assert value(ex.sign, x) == pytest.approx(np.tanh(x / width), abs=1e-14)
        assert value(ex.positive, x) + value(ex.negative, x) == pytest.approx(1.0, abs=1e-14)
    assert value(ex.sign, x) == (1.0 if x >= 0 else -1.0), "the treatment ends with its block"


@given(st.one_of(st.floats(1e-2, 1e3), st.floats(-1e3, -1e-2)))
def test_the_smooth_sign_becomes_the_sharp_one_as_its_width_vanishes(x: float) -> None:
    sharp = value(ex.sign, x)
    with ex.rest_treatment(1e-4, smooth=True):
        assert value(ex.sign, x) == pytest.approx(sharp, abs=1e-12)


def test_treatments_nest() -> None:
    with ex.rest_treatment(1.0, smooth=True):
        with ex.rest_treatment(2.0, smooth=True):
            assert value(ex.sign, 1.0) == pytest.approx(np.tanh(0.5))
        assert value(ex.sign, 1.0) == pytest.approx(np.tanh(1.0))


@pytest.mark.parametrize("exponent", [0.5, 2 / 3, 1.0, 2.0, 3.0])
def test_powers_have_a_finite_slope_everywhere(exponent: float) -> None:
    width = 1e-3
    with ex.rest_treatment(width, smooth=False):
        for x in (0.0, -0.0, 1e-300, -1e-12, 1e-6, width, -width, 1.0):
            slope = value(lambda v: ex.power(v, exponent), x, derivative=True)
            assert np.isfinite(slope)
            assert abs(slope) <= max(1.0, exponent) * max(abs(x), width) ** (exponent - 1) * (1 + 1e-12)


@given(speeds, st.floats(0.3, 3.0))
def test_powers_are_exact_above_the_width_and_continuous_at_it(x: float, exponent: float) -> None:
    width = 1e-2
    with ex.rest_treatment(width, smooth=False):
        found = value(lambda v: ex.power(v, exponent), x)
        exact = abs(x) ** exponent if abs(x) >= width else abs(x) * width ** (exponent - 1)
        assert found == pytest.approx(exact, rel=1e-12)
        just_below = value(lambda v: ex.power(v, exponent), width * (1 - 1e-9))
        assert just_below == pytest.approx(width**exponent, rel=1e-8)


@given(st.floats(-1e3, 1e3, allow_subnormal=False), st.floats(1.0, 10.0), st.floats(0.1, 10.0))
def test_a_scale_divides_the_base_of_a_power(x: float, exponent: float, scale: float) -> None:
    with ex.rest_treatment(1e-2, smooth=False):
        unscaled = value(lambda v: ex.power(v, exponent), x)
        scaled = value(lambda v: ex.power(v, exponent, scale), x)
    assert scaled == pytest.approx(unscaled / scale**exponent, rel=1e-12)


def test_a_power_with_a_scale_takes_no_power_of_a_unit() -> None:
    """Half of a scale, in a unit of which the tenth power is beyond all numbers."""
    unit = 2.0**120
    with ex.rest_treatment(1e-12 * unit, smooth=False):
        assert value(lambda v: ex.power(v, 10.0, unit), 0.5 * unit) == 2.0**-10
    with ex.rest_treatment(1e-12 / unit, smooth=False):
        assert value(lambda v: ex.power(v, 10.0, 1 / unit), 0.5 / unit) == 2.0**-10


def test_the_other_functions_are_the_textbooks() -> None:
    pairs: list[tuple[Callable[[Any], Any], Callable[[float], float]]] = [
        (ex.absolute, abs),
        (ex.exp, np.exp),
        (ex.sin, np.sin),
        (ex.cos, np.cos),
        (ex.tanh, np.tanh),
        (lambda x: ex.log(ex.absolute(x)), lambda x: np.log(abs(x))),
        (lambda x: ex.sqrt(ex.absolute(x)), lambda x: np.sqrt(abs(x))),
        (lambda x: ex.maximum(x, 0.5), lambda x: max(x, 0.5)),
        (lambda x: ex.minimum(x, 0.5), lambda x: min(x, 0.5)),
        (lambda x: ex.where(x > 0.5, 2.0, x), lambda x: 2.0 if x > 0.5 else x),
    ]
    for ours, textbook in pairs:
        for x in (-1.3, 0.2, 0.7):
            assert value(ours, x) == pytest.approx(float(textbook(x)), rel=1e-14)
