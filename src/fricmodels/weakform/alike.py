r"""Which rows of a law are the same but for their sign, and for what does not depend on a nonlinear parameter.

Of :math:`C + (K_c - C)\,e^{-B|\omega|}` the column of C is :math:`1 - e^{-B|\omega|}`: one, less the column of
:math:`K_c`; and the derivatives of both by B differ in sign only. One row is evaluated and integrated for all of them.
Rows are compared as the sums that they are of, term by term.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

_Sum: TypeAlias = dict[tuple[int, ...], tuple[float, Any]]
"""Terms of a sum, each with its factor, by the nodes of the conditions that it stands under, and its own."""


@dataclass(frozen=True)
class Alike:
    """A row as ``sign`` times one of the distinct rows, and a rest.

    Attributes:
        place: which distinct row.
        sign: 1 or −1.
        rest: what does not depend on the nonlinear parameters; ``None`` where it is nothing.
    """

    place: int
    sign: float
    rest: Any = None


def alike(rows: Sequence[Any], alpha: Any, *, rests: bool) -> tuple[list[Any], list[Alike]]:
    """Return the distinct rows of some, and each row by these.

    Args:
        rows: expressions, each a scalar.
        alpha: the nonlinear parameters.
        rests: whether rows may differ by more than their sign.
    """
    import casadi

    if not rows:
        return [], []
    together = casadi.cse(casadi.vertcat(*rows))
    distinct: list[Any] = []
    sums: list[tuple[_Sum, _Sum]] = []
    found: list[Alike] = []
    for i in range(together.numel()):
        whole: _Sum = {}
        _add(together[i], 1.0, (), whole)
        moving = {key: term for key, term in whole.items() if casadi.depends_on(term[1], alpha)}
        rest = {key: term for key, term in whole.items() if key not in moving}
        for place, (known, known_rest) in enumerate(sums):
            sign = _ratio(moving, known)
            left = _difference(rest, known_rest, sign)
            if sign and (rests or not left):
                value = sum(factor * expression for factor, expression in left.values()) if left else None
                found.append(Alike(place, sign, value))
                break
        else:
            found.append(Alike(len(distinct), 1.0))
            distinct.append(together[i])
            sums.append((moving, rest))
    return distinct, found


def _add(expression: Any, factor: float, conditions: tuple[Any, ...], found: _Sum) -> None:
    """Add the terms of a sum to those that were found."""
    import casadi

    if expression.is_op(casadi.OP_ADD) or expression.is_op(casadi.OP_SUB):
        _add(expression.dep(0), factor, conditions, found)
        _add(expression.dep(1), factor if expression.is_op(casadi.OP_ADD) else -factor, conditions, found)
    elif expression.is_op(casadi.OP_NEG):
        _add(expression.dep(0), -factor, conditions, found)
    elif expression.is_op(casadi.OP_IF_ELSE_ZERO):
        _add(expression.dep(1), factor, (*conditions, expression.dep(0)), found)
    else:
        key = (*(condition.element_hash() for condition in conditions), expression.element_hash())
        for condition in reversed(conditions):
            expression = casadi.SX.binary(casadi.OP_IF_ELSE_ZERO, condition, expression)
        found[key] = (found.get(key, (0.0, None))[0] + factor, expression)


def _ratio(one: _Sum, other: _Sum) -> float:
    """Return 1 or −1, by which one sum is the other, or 0 where it is not."""
    if one.keys() != other.keys():
        return 0.0
    for sign in (1.0, -1.0):
        if all(one[key][0] == sign * other[key][0] for key in one):
            return sign
    return 0.0


def _difference(one: _Sum, other: _Sum, sign: float) -> _Sum:
    """Return one sum less ``sign`` times another."""
    found = dict(one)
    for key, (factor, expression) in other.items():
        found[key] = (found.get(key, (0.0, None))[0] - sign * factor, expression)
    return {key: term for key, term in found.items() if term[0] != 0.0}
