"""Processes that end with the one that started them, that give back memory, and that have a limit of time."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time

from fricmodels.errors import InputError

_LOOK = 1.0
_PR_SET_PDEATHSIG = 1
_LARGE = 200_000
"""Samples from which arrays leave holes that are worth giving back."""


def give_back(samples: int) -> None:
    """Give memory that was freed back to the system, after work on arrays of so many samples.

    The C library of Linux keeps the holes that arrays of up to 32 MB leave between others, and takes more beside them.
    Elsewhere, and for short recordings, nothing is done.
    """
    if sys.platform == "linux" and samples >= _LARGE:
        import ctypes

        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(0)


def time_limit(variable: str, default: float, what: str) -> float:
    """Return the seconds that an environment variable allows.

    Args:
        variable: its name. default: where it is not set. what: takes as long, for the error.

    Raises:
        InputError: where it is no positive number.
    """
    given = os.environ.get(variable)
    try:
        limit = float(given) if given else default
    except ValueError:
        limit = 0.0
    if not 0 < limit < float("inf"):
        raise InputError(f"{variable} is '{given}'; it is the seconds that {what}, such as 60")
    return limit


def end_with_parent(parent: int) -> None:
    """Let this process be killed as soon as its parent is gone, even by ``kill -9``.

    On Linux the kernel does it, also to a process that spins in compiled code; elsewhere a thread looks each second.

    Args:
        parent: its process id, taken before this process was started.
    """
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)
    threading.Thread(target=_watch, args=[parent], daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOK)
    os._exit(1)
