"""Whether the torque was at its limit, or the drive at an end stop."""

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


def end_stop(log: Log) -> Iterator[Finding]:
    r"""Judge whether the position ends at a stop: always at the same place, and abruptly.

    A visit is a stretch at the extreme position, to within its resolution, of three samples or more. On entering one,
    the mean speed over eight samples changes. At a stop it changes more than anywhere else in the record, where the
    drive reverses and rests too: the median over three visits or more must be beyond the largest change elsewhere. Were
    the visits like the other m reversals, half of n visits would be the largest of all in one case of
    :math:`\binom{m + n}{n/2}`.
    """
    if "position" not in log.measured:
        return
    short = log.short
    values = short.recording["position"]
    width = 8
    if len(values) < 32 * width:
        return
    third = np.diff(values, 3)
    error = float(np.sqrt(np.median(third**2) / (20.0 * 0.455)))
    tolerance = max(1.01 * log.resolution["position"], 1e-9 * float(np.ptp(values)), error)
    sharp = np.zeros(len(values))
    sharp[width:-width] = np.abs(values[2 * width :] - 2.0 * values[width:-width] + values[: -2 * width])
    for side, extreme in ((1, float(values.max())), (-1, float(values.min()))):
        at = np.abs(values - extreme) <= tolerance
        edges = np.flatnonzero(np.diff(np.r_[0, at.astype(np.int8), 0]))
        starts, stops = edges[::2], edges[1::2]
        visits = (stops - starts >= 3) & (starts >= width) & (stops < len(values) - width)
        entry = starts[visits]
        if len(entry) < 3 or len(entry) > len(values) // (8 * width):
            continue
        near = np.zeros(len(values) + 1, dtype=np.int64)
        np.add.at(near, np.maximum(edges - width, 0), 1)
        np.add.at(near, np.minimum(edges + width, len(values)), -1)
        elsewhere = sharp[(np.cumsum(near[:-1]) == 0) & ~at]
        largest = np.maximum(sharp[entry], sharp[entry - 1])
        if float(np.median(largest)) > float(elsewhere.max(initial=0.0)):
            yield Finding(
                "end-stop",
                Severity.WARN,
                "position",
                f"the {log.called('position')} ends abruptly at {figures(extreme, 5)} {log.length_unit}, "
                f"{len(entry)} times: {'an upper' if side > 0 else 'a lower'} end stop, or a sensor at its limit",
                "leave out what touches it",
            )
