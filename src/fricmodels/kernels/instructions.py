"""The instruction list of a CasADi ``SX`` function: its operations in order, over a work vector."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Instruction:
    """One operation: ``work[output] = operation(work[a], work[b])``, or an input, output or constant."""

    operation: str
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    constant: float


def instructions(function: Any) -> list[Instruction]:
    """List the instructions of a CasADi ``SX`` function."""
    names = _operation_names()
    listed = []
    for k in range(function.n_instructions()):
        name = names[function.instruction_id(k)]
        listed.append(
            Instruction(
                name,
                tuple(function.instruction_input(k)),
                tuple(function.instruction_output(k)),
                function.instruction_constant(k) if name == "OP_CONST" else 0.0,
            )
        )
    return listed


def _operation_names() -> dict[int, str]:
    import casadi

    return {getattr(casadi, name): name for name in dir(casadi) if name.startswith("OP_")}
