"""What torques that are periodic in position have in common: a drive may have several of a kind."""

from __future__ import annotations

from typing import Self

from fricmodels.errors import InputError
from fricmodels.term import Effect

_MOST = 9


class Wave(Effect):
    """A torque that is periodic in position, with a wave number of its own.

    Motor and gear have one each, so that a model may hold several of a kind: ``cogging``, ``cogging(2)``. Their order
    means nothing: each is fitted with its own wave number.

    Args:
        number: which of its kind it is, from 1 on.
    """

    def __init__(self, number: int = 1) -> None:
        self.number = number
        if number > 1:
            self.name = f"{type(self).name}({number})"

    @classmethod
    def named(cls, argument: str = "") -> Self:
        """Return the wave of a number; the first of its kind without one.

        Raises:
            InputError: for what is no number of a further wave.
        """
        if not argument:
            return cls()
        if argument not in map(str, range(2, _MOST + 1)):
            raise InputError(
                f"'{cls.name}({argument})': a further wave has a number from 2 to {_MOST}, such as {cls.name}(2)"
            )
        return cls(int(argument))

    @property
    def physics(self) -> str:
        """The physics in a few words."""
        return super().physics if self.number == 1 else f"the same as {type(self).name}, with another wave number"

    def another(self) -> Self | None:
        """Return the next of its kind."""
        return type(self)(self.number + 1) if self.number < _MOST else None

    def first_of_kind(self) -> Self:
        """Return the first of its kind."""
        return type(self)()
