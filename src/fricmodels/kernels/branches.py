"""Orders operations such that what a condition excludes is not computed.

``where(c, x)`` is x where c holds, else 0. What serves nothing but such values of one condition goes under a branch:
while two bodies touch, it need not be known how they would move apart.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Collection, Sequence
from dataclasses import dataclass

Guard = tuple[str, ...]
"""Names of the conditions that hold, each within those before it."""


@dataclass(frozen=True)
class Operation:
    """``name = operation(operands)``; the operands are names of operations and inputs, or numbers."""

    name: str
    operation: str
    operands: tuple[str, ...]

    @property
    def chooses(self) -> bool:
        """Whether it is a ``where(c, x)``."""
        return self.operation == "OP_IF_ELSE_ZERO"


@dataclass(frozen=True)
class Branch:
    """What is computed where a condition holds, and what is chosen by it: zeros where it does not hold.

    Attributes:
        condition: its name.
        within: in order. Another branch of the same condition may use what is computed here.
        chosen: each is a ``where(condition, x)``.
    """

    condition: str
    within: tuple[Operation | Branch, ...]
    chosen: tuple[Operation, ...]


def arranged(operations: Sequence[Operation], wanted: Collection[str]) -> list[Operation | Branch]:
    """Return what computes all that is wanted, in order.

    Args:
        operations: in an order in which each comes after its operands.
        wanted: names that are to be known at the end.
    """
    guards = _guards(operations, wanted)
    operations = [operation for operation in operations if operation.name in guards]
    steps: dict[Guard, list[Operation | Branch]] = defaultdict(list)
    waiting: dict[Guard, list[Operation]] = defaultdict(list)
    while operations or waiting:
        later = []
        unknown = {operation.name for chosen in waiting.values() for operation in chosen}
        for operation in operations:
            guard = guards[operation.name]
            within = (*guard, operation.operands[0])
            if not unknown.isdisjoint(operation.operands):
                later.append(operation)
                unknown.add(operation.name)
            elif operation.chooses and steps[within]:
                waiting[within].append(operation)
                unknown.add(operation.name)
            else:
                steps[guard].append(operation)
        operations = later
        if waiting:  # the innermost first, and all that can be under one branch together
            within = max(waiting, key=len)
            branch = Branch(within[-1], tuple(steps.pop(within)), tuple(waiting.pop(within)))
            steps[within[:-1]].append(branch)
    return steps[()]


def _guards(operations: Sequence[Operation], wanted: Collection[str]) -> dict[str, Guard]:
    """Return the conditions under which alone each operation serves for anything."""
    guards: dict[str, Guard] = dict.fromkeys(wanted, ())

    def serves(name: str, guard: Guard) -> None:
        known = guards.get(name, guard)
        alike = itertools.takewhile(lambda pair: pair[0] == pair[1], zip(known, guard, strict=False))
        guards[name] = tuple(condition for condition, _ in alike)

    for operation in reversed(operations):
        if operation.name not in guards:  # it serves for nothing
            continue
        guard = guards[operation.name]
        first, *others = operation.operands
        serves(first, guard)
        within = (*guard, first) if operation.chooses and first not in guard else guard
        for operand in others:
            serves(operand, within)
    return guards
