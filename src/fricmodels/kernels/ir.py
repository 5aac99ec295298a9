"""Writes a step of a recursion as LLVM's intermediate representation: one straight line, with branches.

A step is a CasADi ``SX`` function ``(state, input, constant) → (next state, output)``. Numbers are doubles, what is
true or false is an ``i1``, and becomes 1.0 or 0.0 where it is reckoned with.
"""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Collection, Sequence
from typing import Any

from fricmodels.errors import FricmodelsError
from fricmodels.kernels.branches import Branch, Operation, arranged
from fricmodels.kernels.instructions import instructions

_NUMBERS: dict[str, str] = {
    "OP_ADD": "{to} = fadd {flags} double {0}, {1}",
    "OP_SUB": "{to} = fsub {flags} double {0}, {1}",
    "OP_MUL": "{to} = fmul {flags} double {0}, {1}",
    "OP_DIV": "{to} = fdiv {flags} double {0}, {1}",
    "OP_NEG": "{to} = fneg {flags} double {0}",
    "OP_SQ": "{to} = fmul {flags} double {0}, {0}",
    "OP_TWICE": "{to} = fmul {flags} double 2.0, {0}",
    "OP_INV": "{to} = fdiv {flags} double 1.0, {0}",
    "OP_FMOD": "{to} = frem {flags} double {0}, {1}",
    # min(a, b) is b where b < a, else a, as in Python
    "OP_FMIN": "{to}.c = fcmp olt double {1}, {0}\n{to} = select i1 {to}.c, double {1}, double {0}",
    "OP_FMAX": "{to}.c = fcmp ogt double {1}, {0}\n{to} = select i1 {to}.c, double {1}, double {0}",
    "OP_SIGN": "{to}.p = fcmp ogt double {0}, 0.0\n{to}.n = fcmp olt double {0}, 0.0\n"
    "{to}.up = select i1 {to}.p, double 1.0, double 0.0\n{to}.down = select i1 {to}.n, double 1.0, double 0.0\n"
    "{to} = fsub {flags} double {to}.up, {to}.down",
}
"""Name of a CasADi operation → how a number is made of numbers."""
_CALLS: dict[str, str] = {
    "OP_POW": "llvm.pow.f64",
    "OP_CONSTPOW": "llvm.pow.f64",
    "OP_COPYSIGN": "llvm.copysign.f64",
    "OP_ATAN2": "atan2",
    "OP_SQRT": "llvm.sqrt.f64",
    "OP_EXP": "llvm.exp.f64",
    "OP_LOG": "llvm.log.f64",
    "OP_SIN": "llvm.sin.f64",
    "OP_COS": "llvm.cos.f64",
    "OP_FABS": "llvm.fabs.f64",
    "OP_FLOOR": "llvm.floor.f64",
    "OP_CEIL": "llvm.ceil.f64",
    **{f"OP_{name.upper()}": name for name in ("tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "erf")},
    **{f"OP_{name.upper()}": name for name in ("expm1", "log1p")},
}
"""Name of a CasADi operation → the function of one or two numbers that is called."""
_OF_TWO = {"llvm.pow.f64", "llvm.copysign.f64", "atan2"}
_COMPARED = {"OP_LT": "olt", "OP_LE": "ole", "OP_EQ": "oeq", "OP_NE": "une"}
_LOGIC: dict[str, str] = {
    "OP_AND": "{to} = and i1 {0}, {1}",
    "OP_OR": "{to} = or i1 {0}, {1}",
    "OP_NOT": "{to} = xor i1 {0}, true",
}
"""Name of a CasADi operation → how a truth is made of truths."""

DECLARED = "\n".join(
    f"declare double @{name}({'double, double' if name in _OF_TWO else 'double'}) nounwind willreturn memory(none)"
    for name in dict.fromkeys(_CALLS.values())
)
"""Declarations of all functions that a step may call."""


class Step:
    """A step's operations, in order.

    Args:
        function: CasADi ``SX`` function ``(state, input, constant) → (next state, output)``.

    Attributes:
        states, outputs: what each next state and each output is called, or its number.
    """

    def __init__(self, function: Any) -> None:
        places = [function.sparsity_out(i).get_triplet()[0] for i in range(2)]
        self.states = ["0.0"] * function.numel_out(0)
        self.outputs = ["0.0"] * function.numel_out(1)
        names: dict[int, str] = {}
        operations: list[Operation] = []
        for instruction in instructions(function):
            if instruction.operation == "OP_OUTPUT":
                index, element = instruction.outputs
                (self.states, self.outputs)[index][places[index][element]] = names[instruction.inputs[0]]
                continue
            if instruction.operation == "OP_INPUT":
                kind, element = instruction.inputs
                name = f"%{'suc'[kind]}{element}"
            elif instruction.operation == "OP_CONST":
                name = literal(instruction.constant)
            elif instruction.operation == "OP_ASSIGN":
                name = names[instruction.inputs[0]]
            else:
                name = f"%w{len(operations)}"
                operands = tuple(names[i] for i in instruction.inputs if i in names)
                operations.append(Operation(name, instruction.operation, operands))
            names[instruction.outputs[0]] = name
        self._wanted = {*self.states, *self.outputs}
        self._operations = arranged(operations, self._wanted)

    def written(self, block: str, *, flags: str = "") -> tuple[list[str], str, list[str], list[str]]:
        """Write the step.

        The states are called ``%s0``, ``%s1``, …, inputs ``%u…``, constants ``%c…``; all are doubles.

        Args:
            block: label of the basic block in which it begins.
            flags: fast-math flags of each operation.

        Returns:
            The lines, the label of the block in which they end, the next states, and the outputs.

        Raises:
            FricmodelsError: for an operation that cannot be written.
        """
        writer = _Writer(block, flags)
        writer.write(self._operations, self._wanted)
        states, outputs = ([writer.number(name) for name in names] for names in (self.states, self.outputs))
        return writer.lines, writer.block, states, outputs


class _Writer:
    """Writes operations one after the other; see :meth:`Step.written`."""

    def __init__(self, block: str, flags: str) -> None:
        self.lines: list[str] = []
        self.block = block
        self._flags = flags
        self._known: dict[str, tuple[str, str]] = {}
        """What holds the result of an operation, and its type."""
        self._left: Counter[str] = Counter()
        """How often each result is still asked for."""
        self._count = 0

    def write(self, steps: Sequence[Operation | Branch], wanted: Collection[str]) -> None:
        self._left = _uses(steps) + Counter(wanted)
        self._steps(steps)

    def _held(self, name: str) -> tuple[str, str]:
        """Return what holds a result, and its type; inputs and numbers are doubles."""
        return self._known.get(name, (name, "double"))

    def number(self, name: str) -> str:
        """Return a result as a double."""
        value, kind = self._held(name)
        return value if kind == "double" else self._made(f"select i1 {value}, double 1.0, double 0.0")

    def _truth(self, name: str) -> str:
        """Return a result as an i1: everything is true but 0."""
        value, kind = self._held(name)
        return value if kind == "i1" else self._made(f"fcmp une double {value}, 0.0")

    def _steps(self, steps: Sequence[Operation | Branch]) -> None:
        for step in steps:
            if isinstance(step, Branch):
                self._branch(step)
            elif step.chooses:
                self._branch(Branch(step.operands[0], (), (step,)))
            else:
                self._operation(step)
                self._left.subtract(step.operands)

    def _operation(self, step: Operation) -> None:
        name, kind = step.operation, "double"
        if name in _NUMBERS:
            numbers = [self.number(operand) for operand in step.operands]
            self.lines += _NUMBERS[name].format(*numbers, to=step.name, flags=self._flags).split("\n")
        elif name in _CALLS:
            given = ", ".join(f"double {self.number(operand)}" for operand in step.operands)
            self.lines.append(f"{step.name} = call {self._flags} double @{_CALLS[name]}({given})")
        elif name in _COMPARED:
            kind, (first, second) = "i1", [self.number(operand) for operand in step.operands]
            self.lines.append(f"{step.name} = fcmp {_COMPARED[name]} double {first}, {second}")
        elif name in _LOGIC:
            kind, truths = "i1", [self._truth(operand) for operand in step.operands]
            self.lines.append(_LOGIC[name].format(*truths, to=step.name))
        else:
            raise FricmodelsError(f"the operation {name} of this model cannot be compiled")
        self._known[step.name] = step.name, kind

    def _branch(self, branch: Branch) -> None:
        self._count += 1
        holds, after, before = f"holds{self._count}", f"after{self._count}", self.block
        self.lines.append(f"br i1 {self._truth(branch.condition)}, label %{holds}, label %{after}")
        self._begin(holds)
        outside = len(self._known)
        self._steps(branch.within)
        chosen = [(step.name, self._held(step.operands[1])) for step in branch.chosen]
        for step in branch.chosen:
            self._left.subtract(step.operands)
        last = self.block
        self.lines.append(f"br label %{after}")
        self._begin(after)
        for name, (value, kind) in chosen:
            zero = "false" if kind == "i1" else "0.0"
            self.lines.append(f"{name} = phi {kind} [{value}, %{last}], [{zero}, %{before}]")
        for name in list(self._known)[outside:]:  # another branch of this condition may ask for it
            value, kind = self._known.pop(name)
            if self._left[name] > 0:
                self._known[name] = f"{value}.{self._count}", kind
                self.lines.append(f"{self._known[name][0]} = phi {kind} [{value}, %{last}], [poison, %{before}]")
        self._known.update((name, (name, kind)) for name, (_, kind) in chosen)

    def _begin(self, block: str) -> None:
        self.block = block
        self.lines.append(f"{block}:")

    def _made(self, expression: str) -> str:
        self._count += 1
        self.lines.append(f"%t{self._count} = {expression}")
        return f"%t{self._count}"


def _uses(steps: Sequence[Operation | Branch]) -> Counter[str]:
    """Count how often each result is an operand."""
    found: Counter[str] = Counter()
    for step in steps:
        if isinstance(step, Branch):
            found += _uses((*step.within, *step.chosen))
        else:
            found.update(step.operands)
    return found


def literal(value: float) -> str:
    """Return a number as LLVM reads it, to the last bit."""
    return "0x" + struct.pack(">d", value).hex().upper()


def read(array: str, count: int, names: str) -> list[str]:
    """Return lines that read the elements of an array: ``read("inputs", 2, "u")`` makes ``%u0`` and ``%u1``."""
    lines = []
    for i in range(count):
        lines.append(f"%{names}{i}.at = getelementptr double, ptr %{array}, i64 {i}")
        lines.append(f"%{names}{i} = load double, ptr %{names}{i}.at")
    return lines


def write(array: str, values: Sequence[str], block: str) -> list[str]:
    """Return lines that write values to the elements of an array; each ``block`` that writes has a name of its own."""
    lines = []
    for i, value in enumerate(values):
        lines.append(f"%{block}.{array}{i} = getelementptr double, ptr %{array}, i64 {i}")
        lines.append(f"store double {value}, ptr %{block}.{array}{i}")
    return lines
