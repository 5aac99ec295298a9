"""Runs a recursion over a recording: one expression ``(state, input, constant) → (next state, output)``, compiled.

The expression's instruction list is written out as a straight line in LLVM's intermediate representation, the state
held in registers; what the symbolic engine knows to be zero costs nothing. A product and a sum may be contracted to one
rounding (fused multiply-add) where the processor has it, and a division may become a product with a reciprocal. The
machine code is kept in the user's cache directory, so a recursion is compiled once per machine.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array
from fricmodels.kernels.ir import DECLARED, Step, literal, read, write
from fricmodels.kernels.machine_code import ENTRY, MachineCode, loaded

_FLAGS = "contract arcp"


class _Numbers(ctypes.Structure):
    """What an array's address points to; it has no size, so that an array may be empty."""


_at: Callable[[Any], _Numbers] = _Numbers.from_buffer
_POINTER = ctypes.POINTER(_Numbers)
_SIGNATURE = ctypes.CFUNCTYPE(ctypes.c_int64, _POINTER, _POINTER, ctypes.c_int64, _POINTER, ctypes.c_int64, _POINTER)
"""It returns the steps done, and takes state, inputs, rows of these, constants, stride and outputs."""


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
        self._code: MachineCode | None = None
        self._run: Any = None

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_code": None, "_run": None}

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
        first = np.array(state, dtype=float)
        if first.shape != (self.n_states,):
            first = first.reshape(self.n_states)
        rows = np.ascontiguousarray(inputs, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != self.n_inputs:
            rows = rows.reshape(-1, self.n_inputs)
        fixed = np.array(constants, dtype=float)
        if fixed.shape != (self.n_constants,):
            fixed = fixed.reshape(self.n_constants)
        count = len(rows)
        shape = (count // stride, self.n_outputs)
        if outputs is None:
            outputs = np.empty(shape)
        elif not (outputs.flags.carray and outputs.dtype.char == "d" and outputs.shape == shape):
            raise ValueError(f"outputs are contiguous numbers of shape {shape}")
        if self._run is None:
            self._code = loaded(_source(self.function), cache_directory())
            self._run = _SIGNATURE(self._code.address)
        at = _at if rows.flags.writeable else _read_only
        done: int = self._run(_at(first), at(rows), count, _at(fixed), stride, _at(outputs))
        if done < count:
            outputs[done // stride :] = np.nan
        return first, outputs, done


def _read_only(array: Array) -> _Numbers:
    return _Numbers.from_address(array.ctypes.data)


def _source(step: Any) -> str:
    body, last, states, outputs = Step(step).written("body", flags=_FLAGS)
    n = range(len(states))
    lines = [
        f"define i64 @{ENTRY}(ptr %state, ptr %inputs, i64 %rows, ptr %constants, i64 %stride, ptr %outputs)",
        "nounwind {",
        "start:",
        *read("constants", step.numel_in(2), "c"),
        *read("state", len(states), "first"),
        "br label %head",
        "head:",
        "%k = phi i64 [0, %start], [%k.next, %next]",
        "%left = phi i64 [%stride, %start], [%left.next, %next]",
        "%row = phi ptr [%inputs, %start], [%row.next, %next]",
        "%kept = phi ptr [%outputs, %start], [%kept.next, %next]",
        *(f"%s{i} = phi double [%first{i}, %start], [{states[i]}, %next]" for i in n),
        "%more = icmp slt i64 %k, %rows",
        "br i1 %more, label %body, label %end",
        "body:",
        *read("row", step.numel_in(1), "u"),
        *body,
        "%left.less = sub i64 %left, 1",
        "%due = icmp eq i64 %left.less, 0",
        "br i1 %due, label %keep, label %check",
        "keep:",
        *write("kept", outputs, "keep"),
        f"%kept.more = getelementptr double, ptr %kept, i64 {len(outputs)}",
        "br label %check",
        "check:",
        f"%left.next = phi i64 [%stride, %keep], [%left.less, %{last}]",
        f"%kept.next = phi ptr [%kept.more, %keep], [%kept, %{last}]",
        *_total(states),
        "%size = call double @llvm.fabs.f64(double %total)",
        f"%finite = fcmp olt double %size, {literal(1e300)}",
        "br i1 %finite, label %next, label %stopped",
        "next:",
        "%k.next = add i64 %k, 1",
        f"%row.next = getelementptr double, ptr %row, i64 {step.numel_in(1)}",
        "br label %head",
        "stopped:",
        *write("state", states, "stopped"),
        "ret i64 %k",
        "end:",
        *write("state", [f"%s{i}" for i in n], "end"),
        "ret i64 %rows",
        "}",
    ]
    return "\n".join([DECLARED, *lines, ""])


def _total(states: Sequence[str]) -> list[str]:
    """Return lines that add up the states, by which it is seen whether all are finite."""
    sums = ["-0.0", *(f"%total{i}" for i in range(1, len(states))), "%total"]
    return [f"{sums[i + 1]} = fadd {_FLAGS} double {sums[i]}, {state}" for i, state in enumerate(states or ["0.0"])]


def cache_directory() -> Path:
    """Return where compiled recursions are kept: ``FRICMODELS_CACHE``, or the user's cache directory."""
    import platformdirs

    given = os.environ.get("FRICMODELS_CACHE")
    return Path(given) if given else Path(platformdirs.user_cache_dir("fricmodels")) / "kernels"
