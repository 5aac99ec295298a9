"""Evaluates an expression on whole arrays with NumPy: no compilation, exact for every sample."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array
from fricmodels.kernels.instructions import instructions

_BLOCK = 16_384
"""Samples evaluated together: the work vectors then stay in the processor's cache."""


def _if_else_zero(condition: Any, value: Any) -> Any:
    return np.where(condition, value, 0.0)


_FUNCTIONS: dict[str, Any] = {
    "OP_ADD": np.add,
    "OP_SUB": np.subtract,
    "OP_MUL": np.multiply,
    "OP_DIV": np.divide,
    "OP_POW": np.power,
    "OP_CONSTPOW": np.power,
    "OP_LT": np.less,
    "OP_LE": np.less_equal,
    "OP_EQ": np.equal,
    "OP_NE": np.not_equal,
    "OP_AND": np.logical_and,
    "OP_OR": np.logical_or,
    "OP_FMIN": np.fmin,
    "OP_FMAX": np.fmax,
    "OP_ATAN2": np.arctan2,
    "OP_COPYSIGN": np.copysign,
    "OP_FMOD": np.fmod,
    "OP_IF_ELSE_ZERO": _if_else_zero,
    "OP_ASSIGN": np.positive,
    "OP_NEG": np.negative,
    "OP_EXP": np.exp,
    "OP_LOG": np.log,
    "OP_SQRT": np.sqrt,
    "OP_SQ": np.square,
    "OP_TWICE": lambda a: 2.0 * a,
    "OP_SIN": np.sin,
    "OP_COS": np.cos,
    "OP_TAN": np.tan,
    "OP_ASIN": np.arcsin,
    "OP_ACOS": np.arccos,
    "OP_ATAN": np.arctan,
    "OP_SINH": np.sinh,
    "OP_COSH": np.cosh,
    "OP_TANH": np.tanh,
    "OP_FABS": np.abs,
    "OP_SIGN": np.sign,
    "OP_NOT": np.logical_not,
    "OP_INV": np.reciprocal,
    "OP_FLOOR": np.floor,
    "OP_CEIL": np.ceil,
    "OP_EXPM1": np.expm1,
    "OP_LOG1P": np.log1p,
}


_Step = tuple[Callable[..., Any] | None, tuple[int, ...], tuple[int, int]]
"""An operation, the places of its operands and of its result, 0; or ``None``, a place, and an output and its row."""


class ArrayFunction:
    """A CasADi ``SX`` function, evaluated for all samples at once.

    Call it with one argument per *scalar input*, in order: a vector input of length n takes n arguments. Each is a
    number or an array of N samples; numbers are combined once, not N times. Returns an array of shape
    (rows of the output, N) for each output, structural zeros included.
    """

    def __init__(self, function: Any) -> None:
        elements = [(i, element) for i in range(function.n_in()) for element in range(function.nnz_in(i))]
        self._arity = len(elements)
        self._rows = [function.size_out(i) for i in range(function.n_out())]
        places = [
            [row + column * function.size_out(i)[0] for row, column in zip(*sparsity, strict=True)]
            for i in range(function.n_out())
            for sparsity in [function.sparsity_out(i).get_triplet()]
        ]
        listed = instructions(function)
        self._constants = [step.constant for step in listed if step.operation == "OP_CONST"]
        first = self._arity + len(self._constants)
        constants = iter(range(self._arity, first))
        given = {element: place for place, element in enumerate(elements)}
        where: dict[int, int] = {}  # place of what the function's own work vector holds
        self._steps: list[_Step] = []
        for step in listed:
            if step.operation == "OP_OUTPUT":
                index, element = step.outputs
                self._steps.append((None, (where[step.inputs[0]],), (index, places[index][element])))
                continue
            (result,) = step.outputs
            if step.operation == "OP_CONST":
                where[result] = next(constants)
            elif step.operation == "OP_INPUT":
                where[result] = given[step.inputs[0], step.inputs[1]]
            else:
                operands = tuple(where[i] for i in step.inputs[: function_arity(step.operation)])
                where[result] = first + result
                self._steps.append((_FUNCTIONS[step.operation], operands, (where[result], 0)))
        self._places = max([first, *(place + 1 for operation, _, (place, _) in self._steps if operation)])

    def __call__(self, *arguments: ArrayLike) -> list[Array]:
        """Evaluate; see the class.

        Raises:
            TypeError: when the number of arguments is not that of the scalar inputs.
        """
        if len(arguments) != self._arity:
            raise TypeError(f"this function takes {self._arity} scalar inputs, got {len(arguments)}")
        values = [np.asarray(argument, dtype=float) for argument in arguments]
        count = max((value.size for value in values if value.ndim), default=1)
        results = [np.zeros((rows * columns, count)) for rows, columns in self._rows]
        for start in range(0, count, _BLOCK):
            stop = min(start + _BLOCK, count)
            block = [value[start:stop] if value.ndim else value for value in values]
            self._evaluate(block, [result[:, start:stop] for result in results])
        return results

    def _evaluate(self, values: list[Array], results: list[Array]) -> None:
        work: list[Any] = [*values, *self._constants]
        work += [None] * (self._places - len(work))
        with np.errstate(all="ignore"):
            for operation, operands, (place, row) in self._steps:
                if operation is None:
                    results[place][row] = work[operands[0]]
                else:
                    work[place] = operation(*[work[i] for i in operands])


_UNARY = {name for name, function in _FUNCTIONS.items() if isinstance(function, np.ufunc) and function.nin == 1} | {
    "OP_TWICE"
}


def function_arity(operation: str) -> int:
    """Return how many operands an operation takes; CasADi lists a second, meaningless one for unary ones."""
    return 1 if operation in _UNARY else 2
