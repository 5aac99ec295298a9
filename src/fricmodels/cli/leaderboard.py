"""``fricmodels leaderboard``: a finished run in another format."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricmodels.tournament.leaderboard import Leaderboard


def command(
    run: Annotated[Path, typer.Argument(help="Directory of a run.", show_default=False)],
    form: Annotated[str, typer.Option("--format", help="table, md, csv, json, parquet, html or latex")] = "table",
    out: Annotated[Path | None, typer.Option(help="File to write instead of printing.")] = None,
) -> None:
    """Show or export the leaderboard of a run."""
    from fricmodels.errors import InputError
    from fricmodels.export import export
    from fricmodels.files import write_bytes
    from fricmodels.tournament.leaderboard import Leaderboard

    board = Leaderboard.read(run)
    if form == "table" and out is None:
        show(board)
        return
    content = export(board, form)
    if out is not None:
        write_bytes(out, content)
    elif form == "parquet" and sys.stdout.isatty():
        raise InputError("Parquet is not text; add --out FILE.parquet")
    else:
        sys.stdout.buffer.write(content)


def show(board: Leaderboard, rank_by: str | None = None) -> None:
    """Print a leaderboard, and the medians over seeds where there are several."""
    from fricmodels.cli.printing import print_table
    from fricmodels.export.columns import concise, summary

    print_table(concise(board), title="Leaderboard")
    if len({row["tags"].get("seed") for row in board.rows}) > 1:
        figure = (rank_by or board.figure).replace("_", " ")
        print_table(summary(board.summary(rank_by)), title=f"Over seeds: {figure}")
