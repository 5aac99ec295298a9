"""``fricmodels simulate``: a recording from a rig whose truth is known."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    rig: Annotated[Path, typer.Argument(help="The rig, in YAML.", show_default=False)],
    out: Annotated[Path, typer.Option(help="File to write: .csv or .parquet", show_default=False)],
    seed: Annotated[int | None, typer.Option(min=0, help="Seed in place of the rig file's.")] = None,
) -> None:
    """Make a recording with hidden effects from a rig file.

    The truth goes into another file beside it, with .truth.json at its end.
    """
    from fricmodels.rig.file import load_rig
    from fricmodels.rig.write import write

    loaded = load_rig(rig)
    chosen = loaded if seed is None else loaded.model_copy(update={"seed": seed})
    for file in write(chosen.simulate(), out):
        print(f"written to {file}")
