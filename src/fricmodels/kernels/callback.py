"""One step of a recursion as a compiled function that other compiled code calls, by its address."""

from __future__ import annotations

from typing import Any

from fricmodels.kernels.scan import load_module, straight_line

_HEADER = '''"""Generated; safe to delete."""
from math import (acos, asin, atan, atan2, ceil, copysign, cos, cosh, erf, exp, expm1, floor, fmod, log, log1p,
                  sin, sinh, sqrt, tan, tanh)

from numba import cfunc, types

number = types.CPointer(types.float64)


@cfunc(types.void(number, number, number, number), cache=True, error_model="numpy", nogil=True)
def step(state, inputs, constants, outputs):
'''


class Callback:
    """A compiled step ``(state, input, constant) → (next state, output)``.

    :attr:`pointer` takes the addresses of four arrays of float64, ``a.ctypes`` in compiled code: the state, which it
    replaces, input, constants, and the output, which it fills. Code that takes such a pointer is compiled once,
    whatever the step.

    Args:
        step: as of :class:`fricmodels.kernels.Scan`.
    """

    def __init__(self, step: Any) -> None:
        self.source = _source(step)
        self._compiled = None

    @property
    def pointer(self) -> Any:
        """The function's address, as compiled code takes it."""
        if self._compiled is None:
            self._compiled = load_module(self.source).step
        return self._compiled.ctypes  # type: ignore[attr-defined]


def _source(step: Any) -> str:
    body, following, outputs = straight_line(step)
    lines = [f"{letter}{i} = {name}[{i}]" for k, (letter, name) in enumerate(_GIVEN) for i in range(step.numel_in(k))]
    lines += [*body, *(f"outputs[{i}] = {value}" for i, value in enumerate(outputs))]
    lines += [f"n{i} = {value}" for i, value in enumerate(following)]
    lines += [f"state[{i}] = n{i}" for i in range(len(following))]
    return _HEADER + "\n".join(f"    {line}" for line in lines) + "\n"


_GIVEN = (("s", "state"), ("u", "inputs"), ("c", "constants"))
