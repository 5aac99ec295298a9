"""The boundary of the command line: whatever goes wrong within leaves as one line and an exit code."""

from __future__ import annotations

import errno
import io
import re
import sqlite3
import sys
import warnings
from typing import TYPE_CHECKING, TextIO

from fricmodels.errors import FricmodelsError

if TYPE_CHECKING:
    from typing_extensions import Buffer

_MOST = 1000
_LONGEST_WORD = 320
_WORD = re.compile(rf"\S{{{_LONGEST_WORD + 1},}}")


def one_line(message: str) -> str:
    """Return a message as one line that a terminal can show: nothing that steers it, and not too long.

    Words that are too long keep their beginning and their end, where the line of a file stands; so does the whole.
    """
    from fricmodels.terminal import plain

    text = plain(" ".join(_WORD.sub(lambda word: _cut(word[0], _LONGEST_WORD), " ".join(message.split())).split()))
    return _cut(text, _MOST)


def _cut(text: str, most: int) -> str:
    half = most // 2
    return text if len(text) <= most else f"{text[:half]}…{text[-half:]}"


def say(message: str) -> None:
    """Print an error on standard error."""
    print(f"error: {one_line(message)}", file=sys.stderr)


class UntilReaderLeaves(io.RawIOBase):
    """Standard output that takes what is written, and drops it once its reader has gone, as ``head`` does.

    The work goes on then: what it writes into files is not lost for a line that nobody reads.
    """

    def __init__(self, raw: io.RawIOBase) -> None:
        self._raw, self._gone = raw, False

    def writable(self) -> bool:
        """Whether it takes anything: always."""
        return True

    def write(self, data: Buffer, /) -> int | None:
        """Write some bytes; return how many were taken."""
        if not self._gone:
            try:
                return self._raw.write(data)
            except OSError as error:
                self._gone = True  # a full disk is told once
                if not isinstance(error, BrokenPipeError):
                    raise
        return memoryview(data).nbytes

    def fileno(self) -> int:
        """Return the descriptor."""
        return self._raw.fileno()

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        return self._raw.isatty()


def forgiving(stream: TextIO) -> TextIO:
    """Return a stream that outlives its reader; one that is no file of the system as it is."""
    buffer = getattr(stream, "buffer", None)  # that of a process without buffers is the file itself
    raw = buffer.raw if isinstance(buffer, io.BufferedWriter) else buffer
    if not isinstance(raw, io.FileIO):
        return stream
    stream.flush()
    kept = io.BufferedWriter(UntilReaderLeaves(raw))
    return io.TextIOWrapper(kept, stream.encoding, stream.errors, line_buffering=stream.isatty(), write_through=True)


def explain(error: BaseException) -> int:
    """Print an error in one line and return the exit code."""
    import typer

    if isinstance(error, FricmodelsError):
        say(str(error))
        return error.exit_code
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        say("interrupted")
        return 130
    usage = getattr(error, "format_message", None)
    if callable(usage):
        say(f"{usage()} (see --help)")
        return int(getattr(error, "exit_code", 2))
    if isinstance(error, BrokenPipeError) or isinstance(error.__context__, BrokenPipeError):
        return 1
    known = _from_outside(error)
    if known is not None:
        text, code = known
        say(text)
        return code
    say(f"{type(error).__name__}: {error} (unexpected; 'fricmodels --debug …' shows the traceback)")
    return 1


def _from_outside(error: BaseException) -> tuple[str, int] | None:
    """Return a line and an exit code for what the system, not the program, is the cause of."""
    if isinstance(error, OSError):
        reason = (error.strerror or str(error) or type(error).__name__).lower()
        where = f"{error.filename}: " if error.filename is not None else ""
        room = "; make room, and run it again" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
        return f"{where}{reason}{room}", 2
    if isinstance(error, MemoryError):
        return "there is not enough memory for this; give it less at a time, or run it where there is more", 1
    if isinstance(error, sqlite3.Error):
        return f"the store of results cannot be used: {error}", 1
    if isinstance(error, UnicodeError):
        return f"a name or a text cannot be written as UTF-8: {error}; rename it", 2
    if isinstance(error, SystemExit):
        return "a plugin asked the whole program to end; 'fricmodels --debug …' shows where", 1
    return None


def keep_warnings_from_users(debug: bool) -> None:
    """Print no Python warning but with ``--debug``: it names a line of a program, and not what the user can do.

    Filters stay as they are, so that a warning that is an error remains one.
    """

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        if debug:
            sys.stderr.write(warnings.formatwarning(message, category, filename, lineno, line))

    warnings.showwarning = show
