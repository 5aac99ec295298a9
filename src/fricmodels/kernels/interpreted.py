"""Runs a recursion over a recording without compiling it: for a few thousand rows, sooner than a compiler is done."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array

_ROWS = 512
"""Rows that one call goes through; the symbolic engine unrolls as many."""


class Interpreted:
    """A recursion that CasADi's own machine runs; it gives what :class:`~fricmodels.kernels.scan.Scan` gives.

    A step takes some microseconds, thirty times as long as a compiled one; nothing is compiled, which takes some
    hundredths of a second for a recursion of some hundred operations that this machine has not met.

    Args:
        step: as of :class:`~fricmodels.kernels.scan.Scan`.
    """

    def __init__(self, step: Any) -> None:
        self.function = step
        self._rows: dict[int, Any] = {}

    def __call__(
        self, state: ArrayLike, inputs: ArrayLike, constants: ArrayLike, *, stride: int = 1
    ) -> tuple[Array, Array, int]:
        """Run over the rows of ``inputs``, shape (N, m); with ``stride`` k only every k-th output is kept.

        Returns:
            The last state (n,), the outputs (N // stride, o), and the number of steps done: fewer than N when the
            state stopped being finite, at that step.
        """
        step = self.function
        now = np.array(state, dtype=float).reshape(step.numel_in(0))
        rows = np.asarray(inputs, dtype=float).reshape(-1, step.numel_in(1))
        fixed = np.array(constants, dtype=float).reshape(step.numel_in(2), 1)
        outputs, done = np.full((len(rows), step.numel_out(1)), np.nan), len(rows)
        for begin in range(0, len(rows), _ROWS):
            part = rows[begin : begin + _ROWS]
            states, found = self._over(len(part))(now, part.T, np.repeat(fixed, len(part), axis=1))
            states = np.asarray(states, dtype=float).reshape(len(now), len(part), order="F")
            outputs[begin : begin + len(part)] = np.asarray(found, dtype=float).reshape(-1, len(part), order="F").T
            now = states[:, -1]
            bad = np.flatnonzero(~(np.abs(states.sum(axis=0)) < 1e300))
            if len(bad):
                done = begin + int(bad[0])
                break
        kept = outputs[stride - 1 :: stride][: len(rows) // stride]
        kept[done // stride :] = np.nan
        return now, kept, done

    def _over(self, rows: int) -> Any:
        if rows not in self._rows:
            self._rows[rows] = self.function.mapaccum(f"over_{rows}", rows)
        return self._rows[rows]
