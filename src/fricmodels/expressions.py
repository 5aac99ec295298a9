"""The mathematics in which terms are written.

Functions here build CasADi expressions, from which evaluation, Jacobians, compiled loops and exported code all
derive. They import CasADi only when called, so that declaring a law costs nothing.

Two questions have no answer in plain calculus and are settled here for every term alike:

* **The sign at rest.** :func:`positive` and :func:`negative` are the paper's sgn1 and sgn2: ``positive(0) = 1``,
  ``negative(0) = 0``. Where :func:`rest_treatment` smooths they become ``(1 ± tanh(x/w))/2`` of stated width ``w``.
* **Powers at rest.** ``|ω|^p`` with ``p < 1`` has an infinite slope at 0; :func:`power` replaces it below the
  width by the chord through the origin, so that its derivative is finite everywhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from fricmodels.arrays import Array

Expression: TypeAlias = Any
"""A CasADi ``SX`` scalar, or a number."""


@dataclass(frozen=True)
class _Rest:
    width: Expression
    smooth: bool


_rest: ContextVar[_Rest | None] = ContextVar("rest", default=None)


@contextmanager
def rest_treatment(width: Expression, *, smooth: bool) -> Iterator[None]:
    """Build expressions whose behaviour near zero speed has the stated ``width`` (in units of velocity).

    With ``smooth`` the sign functions are replaced by hyperbolic tangents of that width; without it they stay the
    paper's, and only the slope of :func:`power` is limited.
    """
    token = _rest.set(_Rest(width, smooth))
    try:
        yield
    finally:
        _rest.reset(token)


def _casadi() -> Any:
    import casadi

    return casadi


def positive(x: Expression) -> Expression:
    """Return 1 where x ≥ 0, else 0 (sgn1 of eq. 4)."""
    rest = _rest.get()
    if rest is not None and rest.smooth:
        return 0.5 * (1 + _casadi().tanh(x / rest.width))
    return _casadi().if_else(x >= 0, 1, 0)


def negative(x: Expression) -> Expression:
    """Return 1 where x < 0, else 0 (minus sgn2 of eq. 4)."""
    return 1 - positive(x)


def sign(x: Expression) -> Expression:
    """Return 1 where x ≥ 0, else −1."""
    return 2 * positive(x) - 1


def absolute(x: Expression) -> Expression:
    """Return |x|."""
    return _casadi().fabs(x)


def power(x: Expression, exponent: Expression, scale: Expression = 1) -> Expression:
    """Return |x/scale|^exponent, below the width of rest the chord through the origin: the slope stays finite.

    With a scale in the units of x no power of a unit is taken, which may be beyond all numbers.
    """
    casadi = _casadi()
    rest = _rest.get()
    width = 1e-12 if rest is None else rest.width
    magnitude = casadi.fabs(x)
    above = casadi.fmax(magnitude, width) / scale
    chord = magnitude / scale * (width / scale) ** (exponent - 1)
    return casadi.if_else(magnitude >= width, above**exponent, chord)


def exp(x: Expression) -> Expression:
    """Return e^x."""
    return _casadi().exp(x)


def expm1(x: Expression) -> Expression:
    """Return e^x − 1, which is exact near 0 too."""
    return _casadi().expm1(x)


def log(x: Expression) -> Expression:
    """Return the natural logarithm of x."""
    return _casadi().log(x)


def sqrt(x: Expression) -> Expression:
    """Return the square root of x."""
    return _casadi().sqrt(x)


def sin(x: Expression) -> Expression:
    """Return the sine of x."""
    return _casadi().sin(x)


def cos(x: Expression) -> Expression:
    """Return the cosine of x."""
    return _casadi().cos(x)


def tanh(x: Expression) -> Expression:
    """Return the hyperbolic tangent of x."""
    return _casadi().tanh(x)


def maximum(x: Expression, y: Expression) -> Expression:
    """Return the larger of x and y."""
    return _casadi().fmax(x, y)


def minimum(x: Expression, y: Expression) -> Expression:
    """Return the smaller of x and y."""
    return _casadi().fmin(x, y)


def where(condition: Expression, yes: Expression, no: Expression) -> Expression:
    """Return ``yes`` where the condition holds, else ``no``."""
    return _casadi().if_else(condition, yes, no)


def constant_slopes(rows: Sequence[Any], by: Sequence[Any]) -> Array:
    """Return the derivative of CasADi expressions by symbols where it is a number, else 0, shape (symbols, rows)."""
    import casadi

    slopes = casadi.jacobian(casadi.vertcat(*rows), casadi.vertcat(*by))
    each = [[slopes[i, j] for i in range(slopes.size1())] for j in range(len(by))]
    found = [[float(slope) if slope.is_constant() else 0.0 for slope in of_one] for of_one in each]
    return np.array(found, dtype=float).reshape(len(by), -1)
