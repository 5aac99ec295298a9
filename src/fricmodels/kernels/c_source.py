"""Writes an expression as C99: one straight line of ``const double``, no loop, no allocation, no library but libm.

Division by what a condition excludes may give an infinity on the way; it is never chosen. What is written computes in
the order of the expression, as :class:`fricmodels.kernels.ArrayFunction` does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from fricmodels.errors import FricmodelsError
from fricmodels.kernels.instructions import instructions

_C: dict[str, str] = {
    "OP_ADD": "{0} + {1}",
    "OP_SUB": "{0} - {1}",
    "OP_MUL": "{0} * {1}",
    "OP_DIV": "{0} / {1}",
    "OP_POW": "pow({0}, {1})",
    "OP_CONSTPOW": "pow({0}, {1})",
    "OP_LT": "(double)({0} < {1})",
    "OP_LE": "(double)({0} <= {1})",
    "OP_EQ": "(double)({0} == {1})",
    "OP_NE": "(double)({0} != {1})",
    "OP_AND": "(double)(({0} != 0.0) && ({1} != 0.0))",
    "OP_OR": "(double)(({0} != 0.0) || ({1} != 0.0))",
    "OP_FMIN": "fmin({0}, {1})",
    "OP_FMAX": "fmax({0}, {1})",
    "OP_ATAN2": "atan2({0}, {1})",
    "OP_COPYSIGN": "copysign({0}, {1})",
    "OP_FMOD": "fmod({0}, {1})",
    "OP_IF_ELSE_ZERO": "({0} != 0.0) ? {1} : 0.0",
    "OP_ASSIGN": "{0}",
    "OP_NEG": "-{0}",
    "OP_SQ": "{0} * {0}",
    "OP_TWICE": "2.0 * {0}",
    "OP_INV": "1.0 / {0}",
    "OP_FABS": "fabs({0})",
    "OP_SIGN": "(double)(({0} > 0.0) - ({0} < 0.0))",
    "OP_NOT": "(double)({0} == 0.0)",
    **{
        f"OP_{name.upper()}": name + "({0})"
        for name in (
            *("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
            *("floor", "ceil", "erf", "expm1", "log1p"),
        )
    },
}
"""Name of a CasADi operation → the same in C99."""


def c_lines(
    function: Any, inputs: Sequence[Callable[[int], str]], outputs: Sequence[Callable[[int], str]]
) -> list[str]:
    """Return statements of C that evaluate a CasADi ``SX`` function.

    Args:
        function: the function.
        inputs, outputs: for each input and output, how its element i is written in C. Every element of an output is
            assigned, structural zeros included.

    Raises:
        FricmodelsError: for an operation that C does not have.
    """
    names: dict[int, str] = {}
    lines: list[str] = []
    found: dict[tuple[int, int], str] = {}
    rows = [function.sparsity_out(i).get_triplet()[0] for i in range(function.n_out())]
    count = 0
    for step in instructions(function):
        if step.operation == "OP_OUTPUT":
            index, element = step.outputs
            found[index, rows[index][element]] = names[step.inputs[0]]
        elif step.operation == "OP_INPUT":
            kind, element = step.inputs
            names[step.outputs[0]] = inputs[kind](element)
        elif step.operation == "OP_CONST":
            names[step.outputs[0]] = literal(step.constant)
        else:
            if step.operation not in _C:
                raise FricmodelsError(f"the operation {step.operation} of this model cannot be written in C")
            operands = [names[i] for i in step.inputs if i in names]
            lines.append(f"const double w{count} = {_C[step.operation].format(*operands)};")
            names[step.outputs[0]] = f"w{count}"
            count += 1
    for index, write in enumerate(outputs):
        lines += [f"{write(row)} = {found.get((index, row), '0.0')};" for row in range(function.numel_out(index))]
    return lines


def literal(value: float) -> str:
    """Return a number as C reads it, to the last bit."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    return repr(float(value)) if math.copysign(1.0, value) > 0 else f"({float(value)!r})"
