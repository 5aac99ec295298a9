r"""Which rows of a law are the same but for their sign.

Of :math:`C + (K_c - C)\,e^{-B|\omega|}` the columns of C and of :math:`K_c` have derivatives by B that differ in sign
only. One row is evaluated and integrated for both. Rows are compared as the sums that they are of, term by term.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

_Sum: TypeAlias = dict[tuple[int, ...], float]
"""Factor of each term of a sum, by the nodes of the conditions that the term stands under, and its own."""


def alike(rows: Sequence[Any]) -> tuple[list[Any], list[tuple[int, float]]]:
    """Return the distinct rows of some, and for each row which of these it is, and its sign.

    A row that is the negative of an expression is not made from it: its sign says so.

    Args:
        rows: expressions, each a scalar.
    """
    import casadi

    if not rows:
        return [], []
    together = casadi.cse(casadi.vertcat(*rows))
    distinct: list[Any] = []
    sums: list[_Sum] = []
    found: list[tuple[int, float]] = []
    for i in range(together.numel()):
        own: _Sum = {}
        row, sign = together[i], 1.0
        while row.is_op(casadi.OP_NEG):
            row, sign = row.dep(0), -sign
        _add(row, 1.0, (), own)
        signs = [_ratio(own, known) for known in sums]
        place = next((k for k, sign in enumerate(signs) if sign), len(distinct))
        if place == len(distinct):
            distinct.append(row)
            sums.append(own)
            signs.append(1.0)
        found.append((place, sign * signs[place]))
    return distinct, found


def _add(expression: Any, factor: float, conditions: tuple[int, ...], found: _Sum) -> None:
    """Add the terms of a sum to those that were found."""
    import casadi

    if expression.is_op(casadi.OP_ADD) or expression.is_op(casadi.OP_SUB):
        _add(expression.dep(0), factor, conditions, found)
        _add(expression.dep(1), factor if expression.is_op(casadi.OP_ADD) else -factor, conditions, found)
    elif expression.is_op(casadi.OP_NEG):
        _add(expression.dep(0), -factor, conditions, found)
    elif expression.is_op(casadi.OP_IF_ELSE_ZERO):
        _add(expression.dep(1), factor, (*conditions, expression.dep(0).element_hash()), found)
    else:
        key = (*conditions, expression.element_hash())
        found[key] = found.get(key, 0.0) + factor


def _ratio(one: _Sum, other: _Sum) -> float:
    """Return 1 or −1, by which one sum is the other, or 0 where it is not."""
    if one.keys() != other.keys():
        return 0.0
    return next((sign for sign in (1.0, -1.0) if all(one[key] == sign * other[key] for key in one)), 0.0)
