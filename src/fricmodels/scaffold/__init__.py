"""Writes a new plugin: a complete distribution with one class, its test and its entry point."""

from __future__ import annotations

import keyword
import os
import re
import shutil
import tempfile
from datetime import date
from importlib.resources import files
from pathlib import Path
from string import Template

from fricmodels import __version__
from fricmodels.errors import InputError, suggestion
from fricmodels.hookspecs import INTERFACE

__all__ = ["KINDS", "write"]

KINDS = ("law", "effect", "estimator", "reader")
"""What can be written."""

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_STORY = {
    "law": "A friction law is the base that a model starts from: one class, one expression.",
    "effect": "An effect is added to a law: `coulomb-viscous+$name`. `improve` tries it like the built-in ones.",
    "estimator": "An estimator fits a drive to a recording and says how sure it is.",
    "reader": "A reader turns a file into a table; its suffix decides when it is used.",
}


def write(kind: str, name: str, out: str | Path = ".") -> Path:
    """Write the distribution ``fricmodels-NAME`` into the directory ``out``.

    It is written beside its place and then renamed, so that nothing half-written stands there.

    Returns:
        The directory of the distribution.

    Raises:
        InputError: for an unknown kind, a name that cannot be one or is taken, or a directory that is there already.
    """
    if kind not in KINDS:
        raise InputError(f"cannot write a '{kind}'{suggestion(kind, KINDS)}")
    _check_name(kind, name)
    parent = Path(out)
    target = parent / f"fricmodels-{name}"
    if target.exists():
        raise InputError(f"{target}: is there already; choose another name or another --out")
    try:
        parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=".fricmodels-", dir=parent))
    except OSError as error:
        raise InputError(f"{parent}: cannot be written to: {error.strerror}") from None
    try:
        for path, text in _contents(kind, name).items():
            file = draft / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        draft.chmod(0o755)
        os.rename(draft, target)
    except OSError as error:
        raise InputError(f"{target}: cannot be written: {error.strerror}") from None
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return target


def _check_name(kind: str, name: str) -> None:
    from fricmodels import plugins

    if not _NAME.fullmatch(name):
        raise InputError(f"'{name}' cannot be a name; use lower case letters, digits and hyphens, as in 'bearing-drag'")
    if keyword.iskeyword(name):
        raise InputError(f"'{name}' is a word of Python; choose another name")
    for other, registry in plugins.load().registries.items():
        if name in registry:
            raise InputError(f"'{name}' is the name of {_article(other)} {other} already; choose another one")


def _contents(kind: str, name: str) -> dict[str, str]:
    """Return the text of every file by its path."""
    package = f"fricmodels_{name.replace('-', '_')}"
    values = {
        "kind": kind,
        "name": name,
        "distribution": f"fricmodels-{name}",
        "package": package,
        "cls": "".join(part.capitalize() for part in name.split("-")),
        "article": _article(kind).capitalize(),
        "interface": str(INTERFACE),
        "below": _next(__version__),
        "since": __version__,
        "year": str(date.today().year),
        "story": Template(_STORY[kind]).substitute(name=name),
    }
    templates = {
        "pyproject.toml": "pyproject.toml",
        "README.md": "README.md",
        "LICENSE": "LICENSE",
        "CHANGELOG.md": "CHANGELOG.md",
        ".github/workflows/test.yml": "test.yml",
        f"src/{package}/__init__.py": f"{kind}.py",
        f"tests/test_{name.replace('-', '_')}.py": f"{kind}_test.py",
    }
    folder = files("fricmodels.scaffold") / "templates"
    contents = {
        path: Template((folder / f"{template}.txt").read_text(encoding="utf-8")).substitute(values)
        for path, template in templates.items()
    }
    return {**contents, f"src/{package}/py.typed": ""}


def _next(version: str) -> str:
    """Return the first version that may have another plugin interface: the next minor one before 1.0, else major."""
    major, minor, *_ = (int(part) for part in version.split("."))
    return f"{major + 1}" if major else f"0.{minor + 1}"


def _article(kind: str) -> str:
    return "an" if kind[0] in "aeiou" else "a"
