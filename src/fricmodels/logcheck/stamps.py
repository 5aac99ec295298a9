"""Whether the time stamps are even, true and without gaps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.lost_samples import lost_samples
from fricmodels.signals.stamps import EVEN, are_false, share_explained, unevenness


def gaps(log: Log) -> Iterator[Finding]:
    """Say where samples are missing: see :func:`~fricmodels.signals.segments.gap_lengths`."""
    within = np.diff(log.recording.run) == 0
    long = log.steps[within & ~log.joined]
    if len(long):
        yield Finding(
            "gap",
            Severity.WARN,
            "time",
            f"{len(long)} gap{'s' if len(long) > 1 else ''} in time, the longest "
            f"{figures(1e3 * float(long.max()), 3)} ms, "
            f"{figures(float(long.sum()), 3)} s in all; nothing connects what is on both sides",
        )


@dataclass(frozen=True)
class Missing:
    """Samples that an even clock should have given: how many, and how many of them at most one after the other."""

    samples: int
    together: int


def missing(log: Log) -> Missing:
    """Return how many samples are missing within the stretches of a recording that is evenly sampled otherwise."""
    count = lost_samples(log.recording)
    return Missing(int(count.sum()), int(count.max(initial=0.0)))


def lost(log: Log) -> Iterator[Finding]:
    """Note samples that are missing between others, too few together for a gap."""
    found = missing(log)
    if found.samples:
        share = found.samples / (len(log.recording) + found.samples)
        count = "1 sample is" if found.samples == 1 else f"{found.samples} samples are"
        most = f", {found.together} together at most," if found.together > 1 else ""
        yield Finding(
            "missing-samples",
            Severity.NOTE,
            "time",
            f"{count} missing ({figures(100 * share)} %){most} between others that are evenly spaced; the fits "
            f"bridge them",
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
                f"the time stamps wander by {figures(100 * uneven)} % of the interval, but the "
                f"{log.called(channel)} was "
                f"sampled evenly (the stamps explain {100 * max(share, 0.0):.0f} % of what they claim); even stamps "
                "are taken in their place",
            )
            return
    yield Finding(
        "jitter",
        Severity.NOTE,
        "time",
        f"the intervals vary by {figures(100 * uneven)} % (standard deviation); they are taken as stamped",
    )
