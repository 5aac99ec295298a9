"""Runs a recursion over a recording: one expression ``(state, input, constant) → (next state, output)``, compiled.

The expression's instruction list is written out as a straight line of Python and compiled by Numba, the state
held in local variables; what the symbolic engine knows to be zero costs nothing. A product and a sum may be
contracted to one rounding (fused multiply-add) where the processor has it, and a division may become a product with a
reciprocal. The source and the machine code are kept in the user's cache directory under a name made from the source, so
a recursion is compiled once per machine.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array
from fricmodels.errors import InputError
from fricmodels.files import write_text
from fricmodels.kernels.branches import Operation, written
from fricmodels.kernels.instructions import instructions

_HEADER = '''"""Generated; safe to delete."""
from math import (acos, asin, atan, atan2, ceil, copysign, cos, cosh, erf, exp, expm1, floor, fmod, log, log1p,
                  sin, sinh, sqrt, tan, tanh)

from numba import njit


@njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract", "arcp"})
def scan(state, inputs, constants, stride, outputs):
'''


class Scan:
    """A compiled recursion.

    Args:
        step: CasADi ``SX`` function with three inputs, the columns *state* (n), *input* (m) and *constant* (c), and
            two outputs, the *next state* (n) and the *output* (o).
    """

    def __init__(self, step: Any) -> None:
        if step.n_in() != 3 or step.n_out() != 2:
            raise TypeError("a step takes (state, input, constant) and returns (next state, output)")
        self.function = step
        self.n_states, self.n_inputs, self.n_constants = (step.numel_in(i) for i in range(3))
        self.n_outputs = step.numel_out(1)
        self.source = _source(step)
        self._compiled = None

    def __call__(
        self,
        state: ArrayLike,
        inputs: ArrayLike,
        constants: ArrayLike,
        *,
        stride: int = 1,
        outputs: Array | None = None,
    ) -> tuple[Array, Array, int]:
        """Run over the rows of ``inputs``, shape (N, m).

        With ``stride`` k only every k-th output is kept: row i is the output of step ``i k + k − 1``. They are
        written to ``outputs``, contiguous and of shape (N // stride, o), where it is given.

        Returns:
            The last state (n,), the outputs (N // stride, o), and the number of steps done: fewer than N when the
            state stopped being finite, at that step.
        """
        first = np.array(state, dtype=float).reshape(self.n_states)
        rows = np.ascontiguousarray(inputs, dtype=float).reshape(-1, self.n_inputs)
        fixed = np.array(constants, dtype=float).reshape(self.n_constants)
        if outputs is None:
            outputs = np.empty((len(rows) // stride, self.n_outputs))
        if self._compiled is None:
            self._compiled = load_module(self.source).scan
        done = self._compiled(first, rows, fixed, stride, outputs)  # type: ignore[misc]
        outputs[done // stride :] = np.nan
        return first, outputs, int(done)


def straight_line(step: Any) -> tuple[list[str], list[str], list[str]]:
    """Return lines of Python that compute a step, and what its next states and its outputs are called.

    States are called ``s0``, ``s1``, …, inputs ``u…``, constants ``c…``; see :class:`Scan` for what a step is.
    """
    n = step.numel_in(0)
    next_state = ["0.0"] * n
    outputs = ["0.0"] * step.numel_out(1)
    places = []
    for i in range(2):
        rows, _ = step.sparsity_out(i).get_triplet()
        places.append(rows)
    names: dict[int, str] = {}
    operations: list[Operation] = []
    for instruction in instructions(step):
        if instruction.operation == "OP_OUTPUT":
            index, element = instruction.outputs
            target = next_state if index == 0 else outputs
            target[places[index][element]] = names[instruction.inputs[0]]
            continue
        if instruction.operation == "OP_INPUT":
            kind, element = instruction.inputs
            names[instruction.outputs[0]] = (f"s{element}", f"u{element}", f"c{element}")[kind]
            continue
        if instruction.operation == "OP_CONST":
            names[instruction.outputs[0]] = _literal(instruction.constant)
            continue
        operands = tuple(names[i] for i in instruction.inputs if i in names)
        name = f"w{len(operations)}"
        operations.append(Operation(name, instruction.operation, operands))
        names[instruction.outputs[0]] = name
    return written(operations, {*next_state, *outputs}), next_state, outputs


def _source(step: Any) -> str:
    n = step.numel_in(0)
    body, next_state, outputs = straight_line(step)
    lines = [f"    c{i} = constants[{i}]" for i in range(step.numel_in(2))]
    lines += [f"    s{i} = state[{i}]" for i in range(n)]
    lines += ["    kept = 0", "    left = stride", "    for k in range(inputs.shape[0]):"]
    lines += [f"        u{i} = inputs[k, {i}]" for i in range(step.numel_in(1))]
    lines += [f"        {line}" for line in body]
    lines += ["        left -= 1", "        if left == 0:", "            left = stride"]
    lines += [f"            outputs[kept, {i}] = {value}" for i, value in enumerate(outputs)]
    lines += ["            kept += 1"]
    if n:
        lines += [f"        n{i} = {value}" for i, value in enumerate(next_state)]
        lines += [f"        s{i} = n{i}" for i in range(n)]
        total = " + ".join(f"s{i}" for i in range(n))
        lines += [
            f"        if not abs({total}) < 1e300:",
            *(f"            state[{i}] = s{i}" for i in range(n)),
        ]
        lines += ["            return k"]
        lines += [f"    state[{i}] = s{i}" for i in range(n)]
    lines += ["    return inputs.shape[0]"]
    return _HEADER + "\n".join(lines) + "\n"


def _literal(value: float) -> str:
    if np.isfinite(value):
        return repr(float(value)) if value >= 0 else f"({float(value)!r})"
    return "(0.0 / 0.0)" if np.isnan(value) else f"({'-' if value < 0 else ''}1e308 * 10.0)"


def cache_directory() -> Path:
    """Return where compiled recursions are kept: ``FRICMODELS_CACHE``, or the user's cache directory."""
    import platformdirs

    given = os.environ.get("FRICMODELS_CACHE")
    return Path(given) if given else Path(platformdirs.user_cache_dir("fricmodels")) / "kernels"


@lru_cache(maxsize=256)
def load_module(source: str) -> ModuleType:
    """Return the module of a generated source, kept in :func:`cache_directory`."""
    name = "fricmodels_scan_" + hashlib.sha256(source.encode()).hexdigest()[:24]
    path = cache_directory() / f"{name}.py"
    try:
        if not path.exists() or path.read_text(encoding="utf-8") != source:
            write_text(path, source)
    except (OSError, InputError):
        path = write_text(Path(tempfile.mkdtemp(prefix="fricmodels-")) / f"{name}.py", source)
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot load the generated module {path}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
