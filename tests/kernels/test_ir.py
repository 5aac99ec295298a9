"""Every operation, compiled, at every kind of number, against Python, NumPy and CasADi."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fricmodels.errors import FricmodelsError
from fricmodels.kernels import Scan

NUMBERS = [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 1e-310, -1e-9, 0.7, 1e17, -1e308, math.inf, -math.inf, math.nan]
GRID = np.array([(a, b) for a in NUMBERS for b in NUMBERS])

Of = Callable[[Any, Any], Any]


def compiled(operation: Of, rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an operation of the two columns."""
    nothing, x, y = casadi.SX.sym("nothing", 0), casadi.SX.sym("x"), casadi.SX.sym("y")
    _, found, done = Scan(casadi.Function("f", [nothing, casadi.vertcat(x, y), nothing], [nothing, operation(x, y)]))(
        [], rows, []
    )
    assert done == len(rows)
    return found[:, 0]


def chosen_or_zero(condition: Any, value: Any) -> Any:
    return casadi.if_else(condition, value, 0)


def one(name: str) -> tuple[Of, Of]:
    """Return a function of one number in CasADi and in NumPy."""
    numpy = {"asin": "arcsin", "acos": "arccos", "atan": "arctan"}.get(name, name)
    return (lambda x, _: getattr(casadi, name)(x)), (lambda x, _: getattr(np, numpy)(x))


PAIRS: dict[str, tuple[Of, Of]] = {
    "add": (lambda x, y: x + y, np.add),
    "subtract": (lambda x, y: x - y, np.subtract),
    "multiply": (lambda x, y: x * y, np.multiply),
    "divide": (lambda x, y: x / y, np.divide),
    "negate": (lambda x, _: -x, lambda x, _: -x),
    "square": (lambda x, _: x * x, lambda x, _: x * x),
    "twice": (lambda x, _: x + x, lambda x, _: 2 * x),
    "inverse": (lambda x, _: 1 / x, lambda x, _: 1 / x),
    "power": (lambda x, y: x**y, np.power),
    "constant power": (lambda x, _: x**0.36, lambda x, _: np.power(x, 0.36)),
    "atan2": (casadi.atan2, np.arctan2),
    "copysign": (casadi.copysign, np.copysign),
    "fmod": (casadi.fmod, np.fmod),
    "erf": (lambda x, _: casadi.erf(x), lambda x, _: np.array([math.erf(value) for value in x])),
    "less": (lambda x, y: x < y, np.less),
    "less or equal": (lambda x, y: x <= y, np.less_equal),
    "equal": (lambda x, y: x == y, np.equal),
    "not equal": (lambda x, y: x != y, np.not_equal),
    "and": (casadi.logic_and, np.logical_and),
    "or": (casadi.logic_or, np.logical_or),
    "not": (lambda x, _: casadi.logic_not(x), lambda x, _: np.logical_not(x)),
    "absolute": (lambda x, _: casadi.fabs(x), lambda x, _: np.abs(x)),
    "sign": (lambda x, _: casadi.sign(x), lambda x, _: np.nan_to_num(np.sign(x))),
    "choice": (chosen_or_zero, lambda x, y: np.where(x != 0, y, 0)),
    "min": (casadi.fmin, lambda x, y: np.array([min(pair) for pair in zip(x, y, strict=True)])),
    "max": (casadi.fmax, lambda x, y: np.array([max(pair) for pair in zip(x, y, strict=True)])),
    **{name: one(name) for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")},
    **{name: one(name) for name in ("exp", "log", "sqrt", "expm1", "log1p", "floor", "ceil")},
}


@pytest.mark.parametrize("name", PAIRS)
def test_an_operation_of_any_numbers(name: str) -> None:
    """Infinities, numbers that are none, both zeros, the smallest: nothing raises, all is as elsewhere."""
    ours, theirs = PAIRS[name]
    with np.errstate(all="ignore"):
        expected = np.asarray(theirs(*GRID.T), dtype=float)
    found = compiled(ours, GRID)
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=0)
    zero = (expected == 0) & (name != "sign")  # NumPy's sign of −0 is 0 in one version and −0 in another
    np.testing.assert_array_equal(np.signbit(found[zero]), np.signbit(expected[zero]))


def test_truths_are_numbers_where_they_are_reckoned_with() -> None:
    def reckoned(x: Any, y: Any) -> Any:
        less, both = x < y, casadi.logic_and(x, y)
        chosen = chosen_or_zero(both, less)
        return 1 * less + 2 * both + 4 * chosen + 8 * casadi.logic_not(chosen) + 16 * casadi.fmax(less, both) + (-less)

    with np.errstate(invalid="ignore"):
        x, y = GRID.T
        less, both = x < y, (x != 0) & (y != 0)
    chosen = less & both
    expected = 1 * less + 2 * both + 4 * chosen + 8 * ~chosen + 16 * (less | both) - 1 * less
    np.testing.assert_array_equal(compiled(reckoned, GRID), expected)


def test_an_operation_that_is_not_known_is_named() -> None:
    with pytest.raises(FricmodelsError, match="OP_HYPOT of this model cannot be compiled"):
        compiled(casadi.hypot, GRID)


EXACT: list[Of] = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a < b,
    lambda a, b: a <= b,
    lambda a, b: a == b,
    chosen_or_zero,
    chosen_or_zero,
    casadi.logic_and,
    casadi.logic_or,
    lambda a, _: casadi.logic_not(a),
    lambda a, b: chosen_or_zero(casadi.logic_not(a), b),
    lambda a, b: casadi.if_else(a < b, a, b),
]


@given(st.lists(st.tuples(st.sampled_from(EXACT), st.integers(0, 40), st.integers(0, 40)), min_size=1, max_size=30))
@settings(deadline=None, max_examples=100)
def test_any_expression_without_rounding_is_casadis(drawn: list[tuple[Of, int, int]]) -> None:
    """Choices within choices, and what two of them share: of small whole numbers all is exact."""
    x, y = casadi.SX.sym("x"), casadi.SX.sym("y")
    known = [x, y, casadi.SX(2)]
    for operation, i, j in drawn:
        known.append(operation(known[i % len(known)], known[j % len(known)]))
    rows = np.array([(a, b) for a in (-1.0, 0.0, 2.0) for b in (-2.0, 0.0, 1.0, 2.0)])
    nothing, outputs = casadi.SX.sym("nothing", 0), casadi.vertcat(*known[-4:])
    function = casadi.Function("f", [nothing, casadi.vertcat(x, y), nothing], [nothing, outputs])
    _, found, _ = Scan(function)([], rows, [])
    expected = [np.array(function([], row, [])[1]).ravel() for row in rows]
    fits = np.all(np.abs(expected) < 2**52, axis=0)
    np.testing.assert_array_equal(found[:, fits], np.array(expected)[:, fits])
