"""What commands share to print: tables, progress, warnings."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.terminal import Column
    from fricmodels.tournament.running import Report


_NO_TERMINAL = 80
_NO_TERMINAL_NAMES = 180


def console(*, errors: bool = False, otherwise: int = _NO_TERMINAL) -> Console:
    """Return where to print: as wide as the terminal or the variable COLUMNS says, ``otherwise`` if neither does."""
    from rich.console import Console

    known = "COLUMNS" in os.environ or any(s.isatty() for s in (sys.stdin, sys.stdout, sys.stderr) if s is not None)
    return Console(stderr=errors, highlight=False, width=None if known else otherwise)


def print_table(columns: Sequence[Column], title: str = "") -> None:
    """Print columns as a table; text from files is not taken for markup.

    Without numbers it is a list of names, wide where there is no terminal, so that other programs find them whole.
    """
    from fricmodels.terminal import show_table

    names = not any(column.number for column in columns)
    show_table(console(otherwise=_NO_TERMINAL_NAMES if names else _NO_TERMINAL), columns, title)


def warn(lines: Iterable[object]) -> None:
    """Print one line each on standard error."""
    from fricmodels.cli.boundary import one_line

    for line in lines:
        print(f"warning: {one_line(str(line))}", file=sys.stderr)


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
