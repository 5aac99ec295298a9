"""What commands share to print: tables, progress, warnings."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.export.columns import Column
    from fricmodels.tournament.running import Report


def console(*, errors: bool = False) -> Console:
    """Return where to print; wide enough for a table when the output is no terminal."""
    from rich.console import Console

    stream = sys.stderr if errors else sys.stdout
    return Console(file=stream, width=None if stream.isatty() else 180, highlight=False, soft_wrap=False)


def print_table(columns: Sequence[Column], title: str = "") -> None:
    """Print columns as a table; text from files is not taken for markup."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=title or None, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        fixed = column.number or column.title in ("status", "estimator")
        table.add_column(column.title, justify="right" if column.number else "left", overflow="fold", no_wrap=fixed)
    for cells in zip(*(column.cells for column in columns), strict=True):
        failed = any(c.title == "status" and cell != "ok" for c, cell in zip(columns, cells, strict=True))
        table.add_row(*(Text(cell) for cell in cells), style="dim" if failed else None)
    console().print(table)


def warn(lines: Iterable[object]) -> None:
    """Print one line each on standard error."""
    for line in lines:
        print(f"warning: {' '.join(str(line).split())}", file=sys.stderr)


@contextmanager
def progress_of_fits() -> Iterator[Report]:
    """Show a bar with the number of fits, their rate and the time that is left."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    where = console(errors=True)
    with Progress(*columns, console=where, transient=True, disable=not where.is_terminal) as progress:
        task = progress.add_task("fits", total=None, rate="")

        def report(done: int, total: int, job: Any, row: Any) -> None:
            speed = progress.tasks[0].speed
            rate = f"{speed:.1f}/s" if speed else ""
            progress.update(task, completed=done, total=total, rate=rate, description=f"{job.model} · {job.title}")

        yield report
