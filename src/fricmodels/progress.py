"""How far long work is, as data, and how it is stopped.

Whoever wants to know watches: ``with watched(report, token): …``. Work deep within says what it does by :func:`stage`,
:func:`each` and :func:`steps`, and knows nobody; nothing is passed through the functions between them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import Any, TypeVar

Item = TypeVar("Item")
_WHOLE = 100
"""Parts in a second from which on their number is whole."""


@dataclass(frozen=True)
class Progress:
    """How far a stage of long work is. How many stages there will be is not known before: what is found decides.

    Attributes:
        stage: what is being done, in words.
        done, total: parts of the stage; ``total`` is 0 where it has none.
        seconds: since the stage began.
    """

    stage: str
    done: int = 0
    total: int = 0
    seconds: float = 0.0

    @property
    def rate(self) -> float | None:
        """Parts done in a second; ``None`` before the first."""
        return self.done / self.seconds if self.done and self.seconds > 0 else None

    @property
    def left(self) -> float | None:
        """Seconds that the rest of the stage takes at this rate; ``None`` where that is not known."""
        return None if self.rate is None or not self.total else (self.total - self.done) / self.rate

    def later(self, seconds: float) -> Progress:
        """Return it as it is some seconds later, with no part more done."""
        return replace(self, seconds=self.seconds + seconds)

    def __str__(self) -> str:
        """Return it in one line: ``testing effects on coulomb-viscous: 12 of 25, 3.1/s, 4 s left of this step``."""
        if not self.total:
            return self.stage
        known = ""
        if self.rate is not None and self.left is not None:
            rate = f"{self.rate:.0f}" if self.rate >= _WHOLE else f"{self.rate:.3g}"
            known = f", {rate}/s, {self.left:.0f} s left of this step"
        return f"{self.stage}: {self.done} of {self.total}{known}"


Watcher = Callable[[Progress], object]


class Cancelled(KeyboardInterrupt):
    """Long work was stopped, by a token or by Ctrl-C.

    It is no ``Exception``, so that nothing on the way takes it for a failure of its own.

    Attributes:
        partial: what was found until then: a ladder, a comparison, or ``None``.
    """

    def __init__(self, partial: Any = None) -> None:
        super().__init__("stopped before the end")
        self.partial = partial


class Token:
    """Stops the work that watches it, from any thread."""

    def __init__(self) -> None:
        self.cancelled = False

    def cancel(self) -> None:
        """Let the work end at its next part, with :class:`Cancelled`."""
        self.cancelled = True


@dataclass
class _Watch:
    report: Watcher | None
    token: Token | None
    stage: str = ""
    began: float = 0.0

    def tell(self, done: int, total: int) -> None:
        if self.token is not None and self.token.cancelled:
            raise Cancelled
        if self.report is not None:
            self.report(Progress(self.stage, done, total, time.monotonic() - self.began))


_WATCHED: ContextVar[_Watch | None] = ContextVar("watched", default=None)


@contextmanager
def watched(report: Watcher | None = None, token: Token | None = None) -> Iterator[None]:
    """Report the work within, and let a token stop it; without either, leave it to who watches already.

    Args:
        report: called at each part of each stage; what it raises stops the work.
        token: stops it.
    """
    if report is None and token is None:
        yield
        return
    before = _WATCHED.set(_Watch(report, token))
    try:
        yield
    finally:
        _WATCHED.reset(before)


def stage(name: str) -> None:
    """Begin a stage."""
    watch = _WATCHED.get()
    if watch is not None:
        watch.stage, watch.began = name, time.monotonic()
        watch.tell(0, 0)


@contextmanager
def steps(name: str, total: int) -> Iterator[Callable[..., None]]:
    """Begin a stage of so many parts; yield what is called, with a number or for one, when parts are done.

    Args:
        name: of the stage.
        total: parts, at most.
    """
    watch = _WATCHED.get()
    began, finished = time.monotonic(), 0

    def done(parts: int = 1) -> None:
        nonlocal finished
        finished = min(finished + parts, total)
        if watch is not None:
            watch.stage, watch.began = name, began
            watch.tell(finished, total)

    done(0)
    yield done


def each(name: str, items: Sequence[Item]) -> Iterable[Item]:
    """Yield items, a stage of which each is a part.

    Args:
        name: of the stage.
        items: the parts.
    """
    watch = _WATCHED.get()
    if watch is None:
        yield from items
        return
    began = time.monotonic()
    for done, item in enumerate(items):
        watch.stage, watch.began = name, began  # what an item does may have been a stage of its own
        watch.tell(done, len(items))
        yield item
