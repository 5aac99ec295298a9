"""Errors that a user can act on: one line with the cause, the place and the way out."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

_LISTED = 30
"""Names that are listed where none is near."""


class FricmodelsError(Exception):
    """Anything that this package refuses or fails to do; the command line prints it as one line."""

    exit_code = 1


class InputError(FricmodelsError):
    """What was given cannot be used: a file, a column, a name, a value. Exit code 2."""

    exit_code = 2


class EstimationError(FricmodelsError):
    """An estimator could not give an answer for this recording and this model."""


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for the nearest known name, or the list of known names, the first of many."""
    names = sorted(known)
    near = get_close_matches(word, names, n=1, cutoff=0.5)
    if near:
        return f"; did you mean '{near[0]}'?"
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return f"; known: {', '.join(names[:_LISTED])}{more}" if names else ""
