"""What commands share to print: tables, progress, warnings."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from fricmodels.progress import Progress
from fricmodels.terminal import plain

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.terminal import Column
    from fricmodels.tournament.running import Report


_EVERY = 10.0
"""Seconds between two lines where there is no terminal."""
_SOON, _REFRESH = 2.0, 0.5
"""Seconds after which a terminal shows what is being done, and between two looks at the clock."""
_NO_TERMINAL = 80
_NO_TERMINAL_NAMES = 180


def console(*, errors: bool = False, otherwise: int = _NO_TERMINAL) -> Console:
    """Return where to print: as wide as the terminal or the variable COLUMNS says, ``otherwise`` if neither does."""
    from rich.console import Console

    known = "COLUMNS" in os.environ or any(s.isatty() for s in (sys.stdin, sys.stdout, sys.stderr) if s is not None)
    return Console(stderr=errors, highlight=False, width=None if known else otherwise)


def print_table(columns: Sequence[Column], title: str = "") -> None:
    """Print columns as a table; text from files is not taken for markup.

    Without numbers it is a list of names, wide where there is no terminal, so that other programs find them whole, and
    in blocks where a table would break a name or a formula.
    """
    from fricmodels.terminal import breaks, show_records, show_table

    names = not any(column.number for column in columns)
    shown = console(otherwise=_NO_TERMINAL_NAMES if names else _NO_TERMINAL)
    if names and not title and shown.width < _NO_TERMINAL_NAMES and breaks(columns, shown.width):
        show_records(shown, columns)
    else:
        show_table(shown, columns, title)


def print_line(text: str, indent: int | None = None) -> None:
    """Print one sentence, folded to the width; text from files is not taken for markup.

    Args:
        text: the sentence.
        indent: columns before what is folded of it; its own spaces are kept then.
    """
    from rich.text import Text

    from fricmodels.terminal.tables import fold

    shown = console()
    if indent is None:
        shown.print(Text(fold(" ".join(text.split()), shown.width)))
        return
    first, *others = fold(text, shown.width).split("\n")
    shown.print(Text(first))
    rest = " ".join(line.strip() for line in others)
    for line in fold(rest, shown.width - indent).split("\n") if rest else ():
        shown.print(Text(" " * indent + line))


def warn(lines: Iterable[object]) -> None:
    """Print one line each on standard error."""
    from fricmodels.cli.boundary import one_line

    for line in lines:
        print(f"warning: {one_line(str(line))}", file=sys.stderr)


@contextmanager
def working(what: str) -> Iterator[Callable[[object], None]]:
    """Say what is being done, and for how long, on standard error; yield what takes the present step.

    A step is a text or a :class:`~fricmodels.progress.Progress`, which says its rate and the time that is left too. A
    terminal has a line that changes. Elsewhere a line is printed every ten seconds, none before the first ten.
    """
    where = console(errors=True)
    begin = time.monotonic()
    step: list[tuple[object, float]] = [(what, begin)]

    def line() -> str:
        now, (done, told) = time.monotonic(), step[0]
        shown = done.later(now - told) if isinstance(done, Progress) else done
        return f"{plain(str(shown))} … {now - begin:.0f} s"

    def say(done: object) -> None:
        step[0] = (done, time.monotonic())

    done = threading.Event()
    status = where.status("") if where.is_terminal else None

    def tell() -> None:
        while not done.wait(_REFRESH if status is not None else _EVERY):
            if status is None:
                print(line(), file=sys.stderr, flush=True)
            elif time.monotonic() - begin > _SOON:
                from rich.text import Text

                status.update(Text(line()))
                status.start()

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield say
    finally:
        done.set()
        teller.join()
        if status is not None:
            status.stop()


@contextmanager
def progress_of_fits() -> Iterator[Report]:
    """Show the number of fits, their rate and the time that is left; every ten seconds where there is no terminal."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    where = console(errors=True)
    begin = time.monotonic()
    told = [begin]
    with Progress(*columns, console=where, transient=True, disable=not where.is_terminal) as progress:
        task = progress.add_task("fits", total=None, rate="")

        def report(done: int, total: int, job: Any, row: Any) -> None:
            now = time.monotonic()
            speed = done / max(now - begin, 1e-3)
            progress.update(
                task, completed=done, total=total, rate=f"{speed:.2g}/s", description=f"{job.model} · {job.title}"
            )
            if not where.is_terminal and now - told[0] >= _EVERY and done < total:
                told[0] = now
                print(progress_line(done, total, speed), file=sys.stderr, flush=True)

        yield report


def progress_line(done: int, total: int, speed: float) -> str:
    """Return how far a tournament is, in one line."""
    return f"{done} of {total} fits, {speed:.2g}/s, {(total - done) / speed:.0f} s left"
