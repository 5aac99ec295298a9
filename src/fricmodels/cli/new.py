"""``fricmodels new``: a plugin, ready to install."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Kind(StrEnum):
    """What can be written."""

    LAW = "law"
    EFFECT = "effect"
    ESTIMATOR = "estimator"
    READER = "reader"


def command(
    kind: Annotated[Kind, typer.Argument(help="What to write.", show_default=False)],
    name: Annotated[str, typer.Argument(help="Its name: lower case with hyphens.", show_default=False)],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where the distribution is written.")] = Path(),
) -> None:
    """Write the distribution fricmodels-NAME: pyproject with entry point, one class, its test, README."""
    from fricmodels.scaffold import write

    target = write(kind.value, name, out)
    package = f"fricmodels_{name.replace('-', '_')}"
    print(f"wrote {target}; the {kind.value} is in {target / 'src' / package / '__init__.py'}")
    print(f"next: pip install -e {target} && fricmodels check {name}")
