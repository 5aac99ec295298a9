"""Whether the torque was at its limit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.switched import is_switched

_TIMES = 2
"""Times at which a signal stands at a limit, at least."""
_COMMAND = 0.9
"""Share of repeated samples from which a signal is a command in steps."""


def saturation(values: Array) -> dict[float, float]:
    """Return the limits of a signal that it stood at, each with the share of the samples there.

    A limit shows as samples piled up on the extreme value itself: more than three times what a smooth signal, whose
    turning point lies there, puts on its outermost step (1 : √2 − 1 against the next step), and three in succession,
    at two times or more. What a signal stands at once may be a commanded step, or its rest. A signal nearly all of
    whose samples repeat the one before is a command in steps, not limited; nor is one that is switched. Zero is no
    limit: a drive that is off, or rests, has it.
    """
    if is_switched(values):
        return {}
    tolerance = 1e-9 * float(np.ptp(values))
    least, most = float(values.min()), float(values.max())
    elsewhere = (values > least + tolerance) & (values < most - tolerance)
    held = np.r_[False, np.abs(np.diff(values)) <= tolerance]
    if float(np.mean(held[elsewhere])) > _COMMAND if elsewhere.any() else True:
        return {}
    found = {}
    for extreme in (most, least):
        at = np.abs(values - extreme) <= tolerance
        count = int(np.count_nonzero(at))
        if count < 4 or abs(extreme) <= tolerance:
            continue
        inner = values[~at]
        nearest = float(inner.max() if extreme == most else inner.min())
        step = quantum(inner[np.abs(inner - nearest) <= 0.05 * (most - least)][: 1 << 14])
        beside = np.count_nonzero(np.abs(inner - nearest) <= max(tolerance, 0.5 * step))
        in_succession = at[2:] & at[1:-1] & at[:-2]
        times = np.count_nonzero(np.diff(np.r_[0, in_succession.astype(np.int8)]) > 0)
        if count > 3.0 * beside / (np.sqrt(2.0) - 1.0) and times >= _TIMES:
            found[extreme] = count / len(values)
    return found


def torque_limit(log: Log) -> Iterator[Finding]:
    """Say how often the torque stands at its largest or least value; see :func:`saturation`."""
    limits = saturation(log.recording.torque)
    if limits:
        where = " or ".join(figures(limit, 4) for limit in sorted(limits))
        yield Finding(
            "saturation",
            Severity.WARN,
            "torque",
            f"the {log.called('torque')} stands at its limit ({where} {log.force_unit}) in "
            f"{figures(100 * sum(limits.values()))} % of the samples; what drove the joint there may be less than "
            "what is recorded",
        )
