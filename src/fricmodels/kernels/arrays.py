"""Evaluates an expression on whole arrays with NumPy: no compilation, exact for every sample."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence, Set
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


_Plain = tuple[Callable[..., Any] | None, tuple[int, ...], tuple[int, int]]
"""An operation, the places of its operands, that of its result, and of a second one, else 0; or ``None``, a place, and
an output and its row."""
_Step = tuple[Callable[..., Any] | None, tuple[int, ...], tuple[int, int], tuple[int, int] | None, tuple[int, ...]]
"""The same with the output and its row into which the result is written at once, if it is, and the places that nobody
asks for any more."""
_TRUTHS = {np.less, np.less_equal, np.equal, np.not_equal, np.logical_and, np.logical_or, np.logical_not}
"""Operations whose result is true or false."""


def _sine_and_cosine(angle: Any) -> tuple[Any, Any]:
    """Return both, in hardly more time than one of them."""
    if not isinstance(angle, np.ndarray) or angle.ndim == 0:
        return np.sin(angle), np.cos(angle)
    from fricmodels.kernels.small import sine_and_cosine

    both = np.empty((2, len(angle)))
    sine_and_cosine(angle, both)
    return both[0], both[1]


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
        self._places = self._arity + len(self._constants)  # every result gets a place of its own after these
        constants = iter(range(self._arity, self._places))
        given = {element: place for place, element in enumerate(elements)}
        where: dict[int, int] = {}  # place of what the function's own work vector holds
        steps: list[_Plain] = []
        known: dict[tuple[str, tuple[int, ...]], int] = {}  # the same of the same is the same
        for step in listed:
            if step.operation == "OP_OUTPUT":
                index, element = step.outputs
                steps.append((None, (where[step.inputs[0]],), (index, places[index][element])))
                continue
            (result,) = step.outputs
            if step.operation == "OP_CONST":
                where[result] = next(constants)
            elif step.operation == "OP_INPUT":
                where[result] = given[step.inputs[0], step.inputs[1]]
            else:
                operands = tuple(where[i] for i in step.inputs[: function_arity(step.operation)])
                if (step.operation, operands) not in known:
                    known[step.operation, operands] = self._places
                    self._places += 1
                    steps.append((_FUNCTIONS[step.operation], operands, (known[step.operation, operands], 0)))
                where[result] = known[step.operation, operands]
        self._plain = _signs_first(_paired(steps), self._arity)
        self._steps = _releasing(self._plain)
        written = [
            len({row for operation, _, (index, row) in steps if operation is None and index == i})
            for i in range(len(self._rows))
        ]
        self._halves: dict[tuple[int, ...], _Halves] = {}
        self._whole = [count == rows * columns for count, (rows, columns) in zip(written, self._rows, strict=True)]

    def __call__(self, *arguments: ArrayLike) -> list[Array]:
        """Evaluate; see the class.

        Raises:
            TypeError: when the number of arguments is not that of the scalar inputs.
        """
        return self._evaluated(self._steps, self._values(arguments))

    def given(self, *arguments: ArrayLike | None) -> Callable[..., list[Array]]:
        """Evaluate what does not depend on some arguments; return the function of these alone.

        That function takes ``first``, too: how many rows of the first output are wanted, if not all outputs are.

        Args:
            arguments: as of a call; ``None`` for each that is given later. What was computed is kept as long as the
                function that is returned.
        """
        later = tuple(place for place, argument in enumerate(arguments) if argument is None)
        values = self._values([0.0 if argument is None else argument for argument in arguments])
        if later not in self._halves:
            self._halves[later] = _Halves(self._plain, later, self._arity, self._places)
        halves = self._halves[later]
        work: list[Any] = [*values, *self._constants, *[None] * (self._places - self._arity - len(self._constants))]
        _run(halves.before, work, [])
        for place in halves.done:
            work[place] = None
        count = max((value.size for value in values if value.ndim), default=1)

        def found(*rest: ArrayLike, first: int | None = None) -> list[Array]:
            now = list(work)
            for place, argument in zip(later, rest, strict=True):
                now[place] = np.asarray(argument, dtype=float)
            size = max(count, *(now[place].size for place in later), 1)
            rows = self._evaluated(halves.after(first), now, size)
            return rows if first is None else [rows[0][:first]]

        return found

    def _values(self, arguments: Sequence[ArrayLike | None]) -> list[Array]:
        if len(arguments) != self._arity:
            raise TypeError(f"this function takes {self._arity} scalar inputs, got {len(arguments)}")
        return [np.asarray(argument, dtype=float) for argument in arguments]

    def _evaluated(self, steps: Sequence[_Step], values: Sequence[Any], count: int | None = None) -> list[Array]:
        """Return the outputs by some steps, block by block, from what is known at the first places."""
        if count is None:
            count = max((value.size for value in values if value.ndim), default=1)
            values = [*values, *self._constants]
        results = [
            (np.empty if whole else np.zeros)((rows * columns, count))
            for whole, (rows, columns) in zip(self._whole, self._rows, strict=True)
        ]
        blocks = max(1, round(count / _BLOCK))
        missing = [None] * (self._places - len(values))
        for i in range(blocks):
            part = slice(i * count // blocks, (i + 1) * count // blocks)
            block = [_of(value, part) for value in values] if blocks > 1 else list(values)
            _run(steps, block + missing, [result[:, part] for result in results])
        return results


class _Halves:
    """Steps that do not depend on some arguments, and those that do.

    Args:
        steps: all of them.
        later: places of the arguments.
        arity, places: how many arguments there are, and how many places.
    """

    def __init__(self, steps: Sequence[_Plain], later: Sequence[int], arity: int, places: int) -> None:
        moving = set(later)
        before: list[_Plain] = []
        self._after: list[_Plain] = []
        for operation, operands, (place, row) in steps:
            waits = operation is None or not moving.isdisjoint(operands)
            (self._after if waits else before).append((operation, operands, (place, row)))
            if waits and operation is not None:
                moving.update((place, row) if row else (place,))
        wanted = {place for _, operands, _ in self._after for place in operands} - moving
        self.before = _releasing(before, wanted)
        self.done = set(range(arity)) - wanted
        self._kept = frozenset(range(places)) - moving
        self._known: dict[int | None, list[_Step]] = {}

    def after(self, first: int | None) -> list[_Step]:
        """Return the steps that depend on the arguments: all, or those that the first rows of the first output need."""
        if first not in self._known:
            steps = self._after if first is None else _for_rows(self._after, first)
            self._known[first] = _releasing(steps, self._kept)
        return self._known[first]


def _of(value: Any, part: slice) -> Any:
    return value[part] if isinstance(value, np.ndarray) and value.ndim else value


def _run(steps: Sequence[_Step], work: list[Any], results: list[Array]) -> None:
    """Carry out steps on what is at each place."""
    with np.errstate(all="ignore"):
        for operation, operands, (place, row), into, done in steps:
            if operation is None:
                results[place][row] = work[operands[0]]
            elif into is not None:
                work[place] = operation(*[work[i] for i in operands], out=results[into[0]][into[1]])
            elif row:
                work[place], work[row] = operation(work[operands[0]])
            else:
                work[place] = operation(*[work[i] for i in operands])
            for i in done:
                work[i] = None


def _for_rows(steps: Sequence[_Plain], count: int) -> list[_Plain]:
    """Return the steps that the first rows of the first output need."""
    asked: set[int] = set()
    found: list[_Plain] = []
    for operation, operands, (place, row) in reversed(steps):
        wanted = (
            place == 0 and row < count if operation is None else not asked.isdisjoint((place, row) if row else (place,))
        )
        if wanted:
            asked.update(operands)
            found.append((operation, operands, (place, row)))
    return found[::-1]


def _paired(steps: Sequence[_Plain]) -> list[_Plain]:
    """Return steps in which the sine and the cosine of the same angle are one."""
    sines, cosines = (
        {operands[0]: place for operation, operands, (place, _) in steps if operation is wanted}
        for wanted in (np.sin, np.cos)
    )
    both, found = sines.keys() & cosines.keys(), []
    for operation, operands, target in steps:
        if operation not in (np.sin, np.cos) or operands[0] not in both:
            found.append((operation, operands, target))
        elif target[0] == min(sines[operands[0]], cosines[operands[0]]):  # the first of the two
            found.append((_sine_and_cosine, operands, (sines[operands[0]], cosines[operands[0]])))
    return found


def _signs_first(steps: Sequence[_Plain], arity: int) -> list[_Plain]:
    """Return steps in which −(a b) is (−a) b where a is an argument, as the rate of an exponential is: a number.

    Args:
        steps: each result has a place of its own.
        arity: places of the arguments.
    """
    asked = Counter(place for _, operands, _ in steps for place in operands)
    signs = {operands[0]: i for i, (operation, operands, _) in enumerate(steps) if operation is np.negative}
    found = list(steps)
    for i, (operation, operands, target) in enumerate(steps):
        argument = next((place for place in operands if place < arity), None)
        if operation is np.multiply and argument is not None and target[0] in signs and asked[target[0]] == 1:
            one, other = operands if operands[0] == argument else operands[::-1]
            last = signs[target[0]]
            found[i] = (np.negative, (one,), target)
            found[last] = (np.multiply, (target[0], other), steps[last][2])
    return found


def _releasing(steps: Sequence[_Plain], kept: Set[int] = frozenset()) -> list[_Step]:
    """Return steps with the places that nobody asks for after each of them, but for some that are kept.

    A result that is wanted is written where it is wanted.
    """
    found: list[_Step] = []
    asked, into = set(kept), _into(steps)
    for operation, operands, target in reversed(steps):
        if operation is None and into.get(operands[0]) == target:
            continue
        done = tuple(place for place in set(operands) if place not in asked)
        asked.update(operands)
        found.append((operation, operands, target, None if operation is None else into.get(target[0]), done))
    return found[::-1]


def _into(steps: Sequence[_Plain]) -> dict[int, tuple[int, int]]:
    """Return the output, and its row, into which a result may be written at once: place → the first one."""
    truths: set[int] = set()
    direct: set[int] = set()
    found: dict[int, tuple[int, int]] = {}
    for operation, operands, (place, row) in steps:
        if operation is None:
            if operands[0] in direct:
                found.setdefault(operands[0], (place, row))
        elif operation in _TRUTHS or truths.issuperset(operands):
            truths.add(place)
        elif isinstance(operation, np.ufunc):
            direct.add(place)
    return found


_UNARY = {name for name, function in _FUNCTIONS.items() if isinstance(function, np.ufunc) and function.nin == 1} | {
    "OP_TWICE"
}


def function_arity(operation: str) -> int:
    """Return how many operands an operation takes; CasADi lists a second, meaningless one for unary ones."""
    return 1 if operation in _UNARY else 2
