"""Array evaluation against CasADi's own machine."""

from __future__ import annotations

import casadi
import numpy as np
import pytest

from fricmodels.kernels import ArrayFunction, Scan

x, y = casadi.SX.sym("x"), casadi.SX.sym("y")

OPERATORS = {
    "arithmetic": x * y - x / y + (-x) + 1 / x,
    "powers": casadi.fabs(x) ** y + casadi.sqrt(casadi.fabs(x)) + x**2 + 2 * x,
    "exponentials": casadi.exp(x) + casadi.log(casadi.fabs(y)) + casadi.expm1(x) + casadi.log1p(casadi.fabs(x)),
    "circular": casadi.sin(x) + casadi.cos(y) + casadi.tan(x) + casadi.atan2(x, y) + casadi.atan(x),
    "inverse circular": casadi.asin(casadi.tanh(x)) + casadi.acos(casadi.tanh(y)),
    "hyperbolic": casadi.sinh(x) + casadi.cosh(y) + casadi.tanh(x),
    "comparisons": (x < y) + 2 * (x <= y) + 4 * (x == y) + 8 * (x != y),
    "logic": casadi.logic_and(x > 0, y > 0) + 2 * casadi.logic_or(x > 0, y > 0) + 4 * casadi.logic_not(x > 0),
    "choices": casadi.if_else(x > y, x, y) + casadi.fmin(x, y) * casadi.fmax(x, y),
    "signs": casadi.sign(x) + casadi.copysign(y, x) + casadi.fabs(y),
    "rounding": casadi.floor(x) + casadi.ceil(y) + casadi.fmod(x, y),
}


@pytest.mark.parametrize("name", OPERATORS)
def test_every_operation_is_casadis(name: str) -> None:
    rng = np.random.default_rng(0)
    a, b = rng.uniform(-2, 2, (2, 100))
    b[:10] = a[:10]
    function = casadi.Function("f", [x, y], [OPERATORS[name]])
    expected = np.array(function.map(100)(a, b))
    (found,) = ArrayFunction(function)(a, b)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
    nothing = casadi.SX.sym("nothing", 0)
    step = casadi.Function("f", [nothing, casadi.vertcat(x, y), nothing], [nothing, OPERATORS[name]])
    _, compiled, done = Scan(step)([], np.column_stack([a, b]), [])
    np.testing.assert_allclose(compiled.T, expected, rtol=1e-12, atol=1e-14)
    assert done == 100


def test_vectors_take_one_argument_a_scalar_and_numbers_are_spread() -> None:
    column = casadi.SX.sym("column", 2)
    function = casadi.Function("f", [column, x], [casadi.vertcat(column[1] * x, column[0]), casadi.SX(3.0)])
    product, constant = ArrayFunction(function)(1.0, np.array([2.0, 3.0, 4.0]), 10.0)
    np.testing.assert_array_equal(product, [[20, 30, 40], [1, 1, 1]])
    np.testing.assert_array_equal(constant, [[3, 3, 3]])


def test_structural_zeros_are_zeros() -> None:
    function = casadi.Function("f", [x, y], [casadi.jacobian(casadi.vertcat(x, x * y), casadi.vertcat(x, y))])
    (jacobian,) = ArrayFunction(function)(np.array([2.0, 3.0]), np.array([5.0, 7.0]))
    # Column by column: ∂x/∂x, ∂(xy)/∂x, ∂x/∂y, ∂(xy)/∂y.
    np.testing.assert_array_equal(jacobian, [[1, 1], [5, 7], [0, 0], [2, 3]])


def test_arrays_longer_than_a_block_give_what_short_ones_give() -> None:
    function = casadi.Function("f", [x, y], [casadi.sin(x) * y])
    compiled = ArrayFunction(function)
    a = np.linspace(-3, 3, 20_001)
    (whole,) = compiled(a, 2.0)
    parts = np.concatenate([compiled(a[i : i + 777], 2.0)[0] for i in range(0, len(a), 777)], axis=1)
    np.testing.assert_array_equal(whole, parts)


def test_a_wrong_number_of_arguments_is_refused() -> None:
    function = ArrayFunction(casadi.Function("f", [x, y], [x + y]))
    with pytest.raises(TypeError, match="takes 2 scalar inputs, got 1"):
        function(1.0)


@pytest.mark.parametrize("name", OPERATORS)
def test_what_is_given_first_and_what_later_does_not_matter(name: str) -> None:
    a, b = np.random.default_rng(0).uniform(-2, 2, (2, 40_000))
    compiled = ArrayFunction(casadi.Function("f", [x, y], [OPERATORS[name]]))
    (expected,) = compiled(a, b)
    np.testing.assert_array_equal(compiled.given(a, None)(b)[0], expected)
    later = compiled.given(None, b)
    for _ in range(2):
        np.testing.assert_array_equal(later(a)[0], expected)
    np.testing.assert_array_equal(compiled.given(a, None)(0.7)[0], compiled(a, 0.7)[0])
