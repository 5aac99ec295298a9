"""``fricmodels simulate``: data with known truth and hidden effects."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    rig: Annotated[Path, typer.Argument(metavar="RIG.yaml", help="Description of the simulated drive.")],
    out: Annotated[Path, typer.Option("--out", help="Recording to write: .csv or .parquet.")],
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Use another seed than the file's.")] = None,
) -> None:
    """Simulate a drive with hidden effects.

    Writes the recording, and the truth beside it as DATA.truth.json.
    """
    from fricmodels.rig import load_rig, write

    chosen = load_rig(rig)
    if seed is not None:
        chosen = chosen.model_copy(update={"seed": seed})
    recording = chosen.simulate()
    data, truth = write(recording, out)
    print(f"{data}: {len(recording)} samples of {', '.join(recording.channels)}")
    print(f"{truth}: the truth, {chosen.true_model}")
