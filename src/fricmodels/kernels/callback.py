"""One step of a recursion as a compiled function that other compiled code calls, by its address."""

from __future__ import annotations

import ctypes
from typing import Any

from fricmodels.kernels.ir import DECLARED, Step, read, write
from fricmodels.kernels.machine_code import ENTRY, loaded
from fricmodels.kernels.scan import cache_directory

_NUMBERS = ctypes.POINTER(ctypes.c_double)
_SIGNATURE = ctypes.CFUNCTYPE(None, _NUMBERS, _NUMBERS, _NUMBERS, _NUMBERS)


class Callback:
    """A compiled step ``(state, input, constant) → (next state, output)``.

    :attr:`pointer` takes the addresses of four arrays of float64, ``a.ctypes`` in compiled code: the state, which it
    replaces, input, constants, and the output, which it fills. Code that takes such a pointer is compiled once,
    whatever the step.

    Args:
        step: as of :class:`fricmodels.kernels.Scan`.
    """

    def __init__(self, step: Any) -> None:
        self.function = step
        self._pointer: Any = None

    @property
    def pointer(self) -> Any:
        """The function's address, as compiled code takes it; the function is there as long as this is held."""
        if self._pointer is None:
            code = loaded(_source(self.function), cache_directory())
            pointer = _SIGNATURE(code.address)
            pointer.code = code  # type: ignore[attr-defined]
            self._pointer = pointer
        return self._pointer


def _source(step: Any) -> str:
    body, _, states, outputs = Step(step).written("start")
    lines = [line for i, (array, names) in enumerate(_GIVEN) for line in read(array, step.numel_in(i), names)]
    lines += [*body, *write("outputs", outputs, "last"), *write("state", states, "last"), "ret void"]
    head = f"define void @{ENTRY}(ptr %state, ptr %inputs, ptr %constants, ptr %outputs) nounwind {{\nstart:"
    return "\n".join([DECLARED, head, *lines, "}\n"])


_GIVEN = (("state", "s"), ("inputs", "u"), ("constants", "c"))
