"""Errors of a tournament as its author can act on them: with file and line, and with keys in place of options."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fricmodels.errors import InputError
from fricmodels.recording import OTHER

if TYPE_CHECKING:
    from fricmodels.yaml_file import Document, Place

_COLUMN = r"--column (?:'[^']*'|[^\s;,)]+(?<![.]))"
_COLUMNS = re.compile(rf"{_COLUMN}(?: {_COLUMN})*")
_PLAIN = re.compile(r"[A-Za-z_°][\w.°-]*(\[:UNIT\])?")
_KEYS = (
    (re.compile(r"--linear \(motion: linear\)"), "'motion: linear'"),
    (re.compile(r"--gaps (drop|split)"), r"'gaps: \1'"),
    (re.compile(r"--torque-constant=(\S+?)(?=[;,)]|$|\s)"), r"'torque_constant: \1'"),
    (re.compile(r"--(torque-constant|reader|inertia)\b"), lambda found: f"'{found[1].replace('-', '_')}'"),
)


def as_keys(message: str) -> str:
    """Return a message in which keys of a dataset stand in place of the options of other commands."""
    text = _COLUMNS.sub(lambda found: _columns(found[0]), message)
    for pattern, key in _KEYS:
        text = pattern.sub(key, text)
    return text


def _columns(options: str) -> str:
    try:
        pairs = [part.partition("=")[::2] for part in shlex.split(options) if part != "--column"]
    except ValueError:  # an odd quotation mark in a column's name
        return options
    own = [f"{channel}: {_value(column)}" for channel, column in pairs if not channel.startswith(OTHER)]
    further = [
        f"{channel.removeprefix(OTHER)}: {_value(column)}" for channel, column in pairs if channel.startswith(OTHER)
    ]
    if further:
        own.append(f"{OTHER.rstrip('.')}: {{{', '.join(further)}}}")
    return f"columns: {{{', '.join(own)}}}"


def _value(column: str) -> str:
    return column if _PLAIN.fullmatch(column) else "'" + column.replace("'", "''") + "'"


@contextmanager
def told_at(document: Document | None, *place: str | int) -> Iterator[None]:
    """Name file and line of a place of the configuration in an error of bad input that comes from there."""
    try:
        yield
    except InputError as error:
        raise error_at(document, place, str(error)) from error


def error_at(document: Document | None, place: Place, message: str) -> InputError:
    """Return an error that names file and line, where the configuration was read from a file."""
    text = as_keys(message)
    return InputError(text) if document is None else document.error(place, text)
