"""The built-in effects, one a file, registered through the same hook as anybody's."""

from __future__ import annotations

from fricmodels.hookspecs import hookimpl
from fricmodels.term import Effect


@hookimpl
def fricmodels_effects() -> list[type[Effect]]:
    """Return the built-in effects."""
    return []
