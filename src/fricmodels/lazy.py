"""Names of a package that are imported when they are first used, so that a part of it does not wait for the others."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any


def first_use(package: str, homes: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package.

    Args:
        package: its name.
        homes: its names by the module in which they are defined.
    """
    home = {name: module for module, names in homes.items() for name in names}

    def imported(name: str) -> Any:
        if name in home:
            return getattr(importlib.import_module(home[name]), name)
        raise AttributeError(f"module '{package}' has no attribute '{name}'")

    return imported
