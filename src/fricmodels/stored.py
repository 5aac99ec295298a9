"""Reads results that were written earlier, and may have been changed since by others."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fricmodels.errors import InputError


def read_results(path: Path, schema: str, again: str) -> dict[str, Any]:
    """Return the content of a file of results.

    Args:
        path: the file.
        schema: what it must say that it is.
        again: the command that makes it anew.

    Raises:
        FileNotFoundError: when it is not there.
        InputError: when it is no JSON, of another schema, or holds what is no number.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse, parse_int=_whole)
    except FileNotFoundError:
        raise
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(
            f"{path}: cannot be read: {' '.join(str(error).split())}; make it anew with: {again}"
        ) from None
    if not isinstance(content, dict) or content.get("schema") != schema:
        raise InputError(f"{path}: is not of schema '{schema}'; make it anew with: {again}")
    return content


def _whole(digits: str) -> int:
    if len(digits) > 19:
        raise ValueError(f"{digits[:10]}… is too large a number")
    return int(digits)


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no number")


@contextmanager
def as_written(path: Path, again: str) -> Iterator[None]:
    """Blame the file of results for what fails while a page or a table is made of it.

    Such work uses nothing but the file: a key that is missing there, or a text in place of a number, ends it.

    Raises:
        InputError: naming the file, what was looked for, and how to make it anew.
    """
    try:
        yield
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError) as error:
        what = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        raise InputError(f"{path}: does not hold what it should ({what}); make it anew with: {again}") from error
