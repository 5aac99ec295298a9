"""``fricmodels leaderboard``: a finished run in another format."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricmodels.export.columns import Titled
    from fricmodels.terminal import Column
    from fricmodels.tournament.leaderboard import Leaderboard


_OPTIONAL = ("fit", "per sample", "seconds")
"""Columns that are left out where there is no room for them beside the others."""
_MOST_REASONS = 10
"""Reasons that are printed below a leaderboard."""


def command(
    run: Annotated[Path, typer.Argument(help="Directory of a run.", show_default=False)],
    form: Annotated[str, typer.Option("--format", help="table, md, csv, json, parquet, html or latex")] = "table",
    out: Annotated[Path | None, typer.Option(help="File to write instead of printing.")] = None,
    top: Annotated[int | None, typer.Option(min=1, help="Rows of each table; all by default.")] = None,
) -> None:
    """Show or export the leaderboard of a run."""
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.errors import InputError
    from fricmodels.export import export
    from fricmodels.files import write_bytes
    from fricmodels.stored import as_written
    from fricmodels.tournament.leaderboard import AGAIN, FILE, Leaderboard
    from fricmodels.tournament.store import FILE as STORE

    check_outputs([out], [run / FILE, run / STORE] if run.is_dir() else [run])
    if top is not None and (form != "table" or out is not None):
        raise InputError("--top shortens what is printed; leave it out to export a leaderboard, which is whole")
    board = Leaderboard.read(run) if not unfinished(run) else _so_far(run)
    with as_written(run, AGAIN):
        if form == "table" and out is None:
            show(board, top=top)
            return
        content = export(board, form)
    if out is not None:
        write_bytes(out, content)
    else:
        _print(content, form)


def unfinished(run: Path) -> bool:
    """Whether a run was stopped before its leaderboard was written."""
    from fricmodels.tournament.leaderboard import FILE
    from fricmodels.tournament.store import FILE as STORE

    return run.is_dir() and not (run / FILE).exists() and (run / STORE).is_file()


def _so_far(run: Path) -> Leaderboard:
    """Return what was done of a run that was stopped, and say so."""
    from fricmodels.cli.printing import warn
    from fricmodels.tournament.jobs import as_shown
    from fricmodels.tournament.leaderboard import Leaderboard
    from fricmodels.tournament.store import Store

    with Store(run) as store:
        board = Leaderboard.ranked(as_shown(row) for row in store.rows())
    count = len(board.rows)
    kept = f"{count} fit{'s' * (count != 1)} that {'are' if count != 1 else 'is'}"
    warn([f"{run}: the run was stopped; this is the part of {kept} kept. The same "
          f"'fricmodels run' goes on from there"])  # fmt: skip
    return board


def _print(content: bytes, form: str) -> None:
    """Write an export to standard output; what a name has in it does not steer a terminal."""
    from fricmodels.errors import InputError
    from fricmodels.terminal import plain

    if form == "parquet":
        if sys.stdout.isatty():
            raise InputError("Parquet is not text; add --out FILE.parquet")
        sys.stdout.buffer.write(content)
    else:
        sys.stdout.buffer.write(plain(content.decode("utf-8", errors="replace")).encode("utf-8", errors="replace"))


def show(board: Leaderboard, rank_by: str | None = None, top: int | None = None) -> None:
    """Print who came first, medians over seeds where there are several, the fits of each dataset, and reasons.

    Args:
        board: the leaderboard.
        rank_by: the column by which it is ranked.
        top: rows of each table; all if not given.
    """
    from fricmodels.cli.printing import console, print_line, print_table
    from fricmodels.export.columns import NOT_SURE, tables
    from fricmodels.report.tournament import verdict
    from fricmodels.terminal.tables import fits

    found, left_out = tables(board, top, rank_by), list[str]()
    if rank_by in (None, board.figure):
        print_line(verdict(board).sentence)
        print_line("")
    datasets = {str(row["dataset"]) for row in board.rows}
    only = f" on {datasets.pop()}" if len(datasets) == 1 else ""
    for each in found:
        title = f"{each.title}{only}: torque errors{each.window}, in % of the RMS motor torque"
        columns = _compact(each)
        while not fits(columns, console().width) and columns[-1].title in _OPTIONAL:
            left_out.append(columns.pop().title)
        print_table(columns, title=title)
        print_line("")
    if left_out:
        print_line(f"Left out for want of room: {', '.join(dict.fromkeys(reversed(left_out)))}; --format md has all.")
    marks = "".join(
        cell for each in found for column in each.columns if column.title == "not sure of" for cell in column.cells
    )
    meant = [text for mark, text in NOT_SURE.items() if mark in marks]
    if meant:
        print_line(f"{'; '.join(meant)}; --format md names them")
    for row in board.failures[:_MOST_REASONS]:
        print_line(f"{row['status']}: {row['model']} with {row['estimator']} on {row['dataset']}: {row['message']}")
    if len(board.failures) > _MOST_REASONS:
        print_line(f"… and {len(board.failures) - _MOST_REASONS} more without a result; --format csv has every reason")


def _compact(each: Titled) -> list[Column]:
    """Return the columns of a leaderboard as 80 characters hold them; how many parameters are not sure follows ok."""
    from fricmodels.terminal import Column

    kept, over = {column.title: column for column in each.columns}, each.window
    if len({*kept.get("dataset", Column("", ())).cells}) == 1:
        del kept["dataset"]
    marks = kept.pop("not sure of", None)
    kept.pop("reason", None)
    test, sample = kept.get(f"test error %{over}"), kept.get("per sample %")
    if test is not None and sample is not None and test.cells == sample.cells:
        del kept["per sample %"]
    if marks is not None:
        pairs = zip(kept["status"].cells, marks.cells, strict=True)
        kept["status"] = Column("status", tuple(f"{status}{_counts(mark)}" for status, mark in pairs))
    shorter = {f"test error %{over}": "test", f"fit error %{over}": "fit", "per sample %": "per sample"}
    return [Column(shorter.get(title, title), column.cells, column.number) for title, column in kept.items()]


def _counts(mark: str) -> str:
    """Return how many parameters are not determined, and how many are at their bounds: `` 2? 1|``."""
    return "".join(f" {mark.count(sign)}{sign}" for sign in "?|" if sign in mark)
