"""Whether the drive ran into an end stop: one that does not give way, or one that does."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.in_place import pieces

_TIMES = 3
"""Times at which a drive is stopped, at least."""
_WIDTH, _WIDTHS = 8, (8, 32, 128)
"""Samples over which a mean speed is taken: at a stop that does not give way, and at one that does."""
_AT_END, _APPROACH = 0.02, 0.1
"""Share of the travel that is its end, and from which on the way there is the approach to it."""


def end_stop(log: Log) -> Iterator[Finding]:
    """Judge whether the drive meets a stop: pushed on by its motor, see :func:`_pushed`, or else, see :func:`_hard`."""
    if "position" not in log.measured or len(log.short.recording) < 32 * _WIDTH:
        return
    short = log.short
    values = short.recording["position"]
    for width in _WIDTHS if "torque" in log.measured else ():
        places = _pushed(short, values, width)
        if len(places) >= _TIMES:
            ends = [places[places > values.mean()], places[places < values.mean()]]
            at = " and ".join(figures(float(np.median(end)), 4) for end in ends if len(end))
            yield Finding(
                "end-stop",
                Severity.WARN,
                "position",
                f"at {at} {log.length_unit} the drive is stopped in motion while its motor pushes on, "
                f"{len(places)} times: an end stop",
                "leave out what touches it",
            )
            return
    for side, extreme in ((1, float(values.max())), (-1, float(values.min()))):
        times = _hard(short, values, extreme, log.resolution["position"])
        if times:
            yield Finding(
                "end-stop",
                Severity.WARN,
                "position",
                f"the {log.called('position')} ends abruptly at {figures(extreme, 5)} {log.length_unit}, "
                f"{times} times: {'an upper' if side > 0 else 'a lower'} end stop, or a sensor at its limit",
                "leave out what touches it",
            )


def _sharpness(log: Log, values: Array, width: int) -> Array:
    """Return by how much the way changes from one stretch of samples to the next, shape (N,); 0 at ends of parts."""
    sharp = np.zeros(len(values))
    sharp[width:-width] = np.abs(values[2 * width :] - 2.0 * values[width:-width] + values[: -2 * width])
    sharp[width:-width][log.part[2 * width :] != log.part[: -2 * width]] = 0.0
    return sharp


def _hard(log: Log, values: Array, extreme: float, resolution: float) -> int:
    r"""Return how often the position ends at its extreme: always at the same place, and abruptly; 0 if it does not.

    A visit is a stretch at the extreme position, to within its resolution, of three samples or more. On entering one,
    the mean speed over eight samples changes. At a stop it changes more than anywhere else in the record, where the
    drive reverses and rests too: the median over three visits or more must be beyond the largest change elsewhere. Were
    the visits like the other m reversals, half of n visits would be the largest of all in one case of
    :math:`\binom{m + n}{n/2}`.
    """
    third = np.diff(values, 3)
    error = float(np.sqrt(np.median(third**2) / (20.0 * 0.455)))
    tolerance = max(1.01 * resolution, 1e-9 * float(np.ptp(values)), error)
    sharp = _sharpness(log, values, _WIDTH)
    at = np.abs(values - extreme) <= tolerance
    starts, stops = np.array(list(pieces(log.recording, at)), dtype=np.int64).reshape(-1, 2).T
    visits = (stops - starts >= 3) & (starts >= _WIDTH) & (stops < len(values) - _WIDTH)
    entry = starts[visits]
    if len(entry) < _TIMES or len(entry) > len(values) // (8 * _WIDTH):
        return 0
    near = np.zeros(len(values) + 1, dtype=np.int64)
    edges = np.r_[starts, stops]
    np.add.at(near, np.maximum(edges - _WIDTH, 0), 1)
    np.add.at(near, np.minimum(edges + _WIDTH, len(values)), -1)
    elsewhere = sharp[(np.cumsum(near[:-1]) == 0) & ~at]
    largest = np.maximum(sharp[entry], sharp[entry - 1])
    return len(entry) if float(np.median(largest)) > float(elsewhere.max(initial=0.0)) else 0


def _pushed(log: Log, values: Array, width: int) -> Array:
    r"""Return how far a drive came each time that it was stopped, and not by its motor, shape (stops,).

    A stop that gives way ends each motion elsewhere. It still ends it more abruptly than anything elsewhere does, and
    the motor does not: by :math:`J a = \tau - F` a motor that stops a drive pushes less than on the way there. Here it
    pushes no less while the speed falls, and then more than at any sample of the approach, though the drive stands.

    Args:
        log: short, with a torque. values: its positions, shape (N,). width: samples over which a speed is taken.
    """
    travel, torque = float(np.ptp(values)), log.recording.torque
    if travel <= 0.0 or len(values) < 32 * width:
        return np.zeros(0)
    sharp, part = _sharpness(log, values, width), log.part
    ends = np.minimum(values - values.min(), values.max() - values) < _AT_END * travel
    beside = np.convolve(ends.astype(float), np.ones(2 * width + 1), "same") > 0.5
    elsewhere = float(sharp[~beside].max(initial=0.0))
    found = []
    for side in (1.0, -1.0):
        outward, push = side * values, side * torque
        before = np.flatnonzero(outward < outward.max() - _APPROACH * travel)
        for entry, end in pieces(log.recording, outward > outward.max() - _AT_END * travel):
            last = int(np.searchsorted(before, entry)) - 1
            since = max(int(before[last]) + 1 if last >= 0 else 0, entry - 32 * width)
            near = slice(max(entry - width, since), min(entry + 4 * width, end))
            stop = near.start + int(np.argmax(sharp[near]))
            way, rest = slice(since, stop - width // 2), slice(stop + width, min(stop + 3 * width, end))
            if way.stop - way.start < 4 or rest.stop - rest.start < 3 or part[since] != part[rest.stop - 1]:
                continue
            falling = push[stop - width // 2 : stop + width]
            pushed = falling.mean() >= push[way].mean() and push[rest].mean() > push[way].max()
            if pushed and sharp[stop] > elsewhere:
                found.append(side * float(outward[entry:end].max()))
    return np.asarray(found)
