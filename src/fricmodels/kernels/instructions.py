"""The instruction list of a CasADi ``SX`` function: its operations in order, over a work vector."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

_BINARY = {
    "OP_ADD": "{0} + {1}",
    "OP_SUB": "{0} - {1}",
    "OP_MUL": "{0} * {1}",
    "OP_DIV": "{0} / {1}",
    "OP_POW": "{0} ** {1}",
    "OP_CONSTPOW": "{0} ** {1}",
    "OP_LT": "{0} < {1}",
    "OP_LE": "{0} <= {1}",
    "OP_EQ": "{0} == {1}",
    "OP_NE": "{0} != {1}",
    "OP_AND": "({0} != 0) & ({1} != 0)",
    "OP_OR": "({0} != 0) | ({1} != 0)",
    "OP_FMIN": "min({0}, {1})",
    "OP_FMAX": "max({0}, {1})",
    "OP_ATAN2": "atan2({0}, {1})",
    "OP_COPYSIGN": "copysign({0}, {1})",
    "OP_FMOD": "fmod({0}, {1})",
    "OP_IF_ELSE_ZERO": "({1} if {0} else 0.0)",
}
_UNARY = {
    "OP_ASSIGN": "{0}",
    "OP_NEG": "-{0}",
    "OP_EXP": "exp({0})",
    "OP_LOG": "log({0})",
    "OP_SQRT": "sqrt({0})",
    "OP_SQ": "{0} * {0}",
    "OP_TWICE": "2.0 * {0}",
    "OP_SIN": "sin({0})",
    "OP_COS": "cos({0})",
    "OP_TAN": "tan({0})",
    "OP_ASIN": "asin({0})",
    "OP_ACOS": "acos({0})",
    "OP_ATAN": "atan({0})",
    "OP_SINH": "sinh({0})",
    "OP_COSH": "cosh({0})",
    "OP_TANH": "tanh({0})",
    "OP_FABS": "abs({0})",
    "OP_SIGN": "((1.0 if {0} > 0.0 else 0.0) - (1.0 if {0} < 0.0 else 0.0))",
    "OP_NOT": "({0} == 0)",
    "OP_INV": "1.0 / {0}",
    "OP_FLOOR": "floor({0})",
    "OP_CEIL": "ceil({0})",
    "OP_ERF": "erf({0})",
    "OP_EXPM1": "expm1({0})",
    "OP_LOG1P": "log1p({0})",
}
OPERATIONS: dict[str, str] = {**_BINARY, **_UNARY}
"""Name of a CasADi operation → the same in scalar Python."""


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
