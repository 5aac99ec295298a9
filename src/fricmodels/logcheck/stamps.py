"""Whether the time stamps are even, true and without gaps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.signals.stamps import EVEN, are_false, share_explained, unevenness


def gaps(log: Log) -> Iterator[Finding]:
    """Say where samples are missing: steps beyond the outer fence of all steps, five median steps at the least."""
    within = np.diff(log.recording.run) == 0
    long = log.steps[within & ~log.joined]
    if len(long):
        yield Finding(
            "gap",
            Severity.WARN,
            "time",
            f"{len(long)} gap{'s' if len(long) > 1 else ''} in time, the longest {1e3 * float(long.max()):.3g} ms, "
            f"{float(long.sum()):.3g} s in all; nothing connects what is on both sides",
        )


def truth(log: Log) -> Iterator[Finding]:
    """Judge whether uneven stamps are when the samples were taken; see :mod:`fricmodels.signals.stamps`.

    Where that cannot be told, the stamps' unevenness is lost in the channel's noise, and does no harm.
    """
    uneven = unevenness(log.recording)
    if uneven < EVEN:
        return
    short = log.short
    regular = short.joined & (short.steps < 1.5 * short.recording.interval)
    for channel in ("position", "velocity"):
        if channel not in log.measured:
            continue
        share, error, count = share_explained(short.recording.time, short.recording[channel], regular)
        if are_false(share, error, count):
            yield Finding(
                "false-stamps",
                Severity.WARN,
                "time",
                f"the time stamps wander by {100 * uneven:.2g} % of the interval, but the {log.called(channel)} was "
                f"sampled evenly (the stamps explain {100 * max(share, 0.0):.0f} % of what they claim); even stamps "
                "are taken in their place",
            )
            return
    yield Finding(
        "jitter",
        Severity.NOTE,
        "time",
        f"the intervals vary by {100 * uneven:.2g} % (standard deviation); they are taken as stamped",
    )
