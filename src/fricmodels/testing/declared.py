"""What a class says of its own exam counts wherever the exam is sat: in a test runner, and by ``fricmodels check``."""

from __future__ import annotations

from typing import Any, ClassVar

from fricmodels.errors import suggestion


class Declared:
    """An exam whose attributes may stand in the mapping ``exam`` of the class that sits it.

    What the test class sets itself comes first.
    """

    of: ClassVar[str]
    """Attribute that holds the class that sits the exam."""
    _may_say: ClassVar[tuple[str, ...]]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        said = getattr(getattr(cls, cls.of, None), "exam", {})
        for key, value in said.items():
            if key not in cls._may_say:
                raise TypeError(f"exam says '{key}', which no exam of this kind knows{suggestion(key, cls._may_say)}")
            if not any(key in vars(base) for base in cls.__mro__ if cls.of in vars(base)):
                chosen: Any = staticmethod(value) if callable(value) else value
                setattr(cls, key, chosen)
