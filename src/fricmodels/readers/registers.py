r"""Numbers that a register holds with their sign, and a log shows without it.

A servo's bus hands over bits. A register of n bits in two's complement that is read as if it had no sign shows
:math:`x + 2^n` for a negative x; one with a sign bit and a magnitude shows :math:`2^{n-1} + |x|`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array

_FEWEST = 8
"""Samples of each sign that must be there."""
_SIDES = 8.0
"""Factor within which the largest values of both signs are alike."""
_NEAR = 0.1
"""Share of the largest value within which both signs come to zero."""
_JUMPS = 0.25
"""Share of the jump of the bits that a change of the sign jumps at most: a number without a sign that passes the middle
of its range does not jump there, and would with one. A torque may jump farther where dry friction turns, but less than
the bits; so much is allowed where this share of the numbers of one sign, the largest, is never reached."""


@dataclass(frozen=True)
class Register:
    """How a number is held.

    Attributes:
        bits: of the register, that of its sign among them.
        complement: whether negative numbers are in two's complement; else the highest bit is the sign.
    """

    bits: int
    complement: bool

    @property
    def least(self) -> int:
        """The least number that stands for a negative one."""
        return 1 << (self.bits - 1)

    def signed(self, values: Array) -> Array:
        """Return numbers with their sign, shape (N,)."""
        negative = values >= self.least
        meant = values - 2.0 * self.least if self.complement else self.least - values
        return np.where(negative, meant, values)

    def __str__(self) -> str:
        return f"{self.bits} bits" + ("" if self.complement else ", the highest of which is the sign")


_USUAL = (Register(16, True), Register(32, True), Register(16, False), Register(11, False))


def find_register(values: Array) -> Register | None:
    """Return the register whose numbers were written without their sign, or ``None``.

    They are whole and not negative, and with the sign both sides come near to zero, are about as large, leave half of
    the register free if it has 16 bits or more, and the change from one to the other is less than that of the
    bits: a number that passes half of a register's range by itself would jump there.
    """
    numbers = values[np.isfinite(values)]
    if (numbers < 0.0).any() or (numbers != np.floor(numbers)).any():
        return None
    return next((register for register in _USUAL if _is_held(numbers, register)), None)


def _is_held(values: Array, register: Register) -> bool:
    if values.max(initial=0.0) >= 2 * register.least:
        return False
    meant = register.signed(values)
    negative = values >= register.least
    if min(np.count_nonzero(negative), np.count_nonzero(~negative)) < _FEWEST:
        return False
    sizes = [np.abs(meant[side]) for side in (negative, ~negative)]
    largest = [float(size.max()) for size in sizes]
    if min(largest) * _SIDES < max(largest) or max(largest) >= register.least / (2 if register.bits >= 16 else 1):
        return False
    if max(float(size.min()) for size in sizes) > _NEAR * max(largest):
        return False
    turns = np.flatnonzero(np.diff(negative))
    if len(turns) < 2:
        return False
    change, of_bits = (float(np.median(np.abs(np.diff(read)[turns]))) for read in (meant, values))
    free = max(largest) < (1.0 - _JUMPS) * register.least
    return change < (1.0 if free else _JUMPS) * of_bits
