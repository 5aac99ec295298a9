"""Whether a velocity is the change of the position, and an acceleration that of the velocity."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.logcheck import clock
from fricmodels.logcheck.balance import CLUSTERS, Balance, Cells, balances, best
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.results.words import figures
from fricmodels.signals.clusters import certain, clusters, slope

_WIDTHS = (1, 4, 16, 64, 256)
_LEAST = 16
_CHAINS = (("position", "velocity"), ("velocity", "acceleration"))
_SAME = 0.1
"""A rate off by a tenth is one of another unit, or of the other side of a gear; calibrations differ by less."""
_FOLLOWS = 0.5
"""Correlation below which less than a quarter of the one is explained by the other."""
_IS = 0.9
"""Correlation above which the one is the change of the other: four fifths of it are explained."""
_OF_ONE_SIGN = 0.99
"""Share of the mean size that the mean of a rate without its sign has; noise may turn what is nearly nothing."""
_CELLS, _APART = (1, 4, 16), 4
"""Samples of a cell, and cells between a slope and its instruments."""

_ANGLES = {"rad": 1.0, "deg": 180.0 / math.pi, "turn": 0.5 / math.pi}
_SPEEDS = {"rad/s": 1.0, "deg/s": 180.0 / math.pi, "rpm": 30.0 / math.pi, "turn/s": 0.5 / math.pi}


@dataclass(frozen=True)
class Link:
    """How a rate goes with the change of a quantity.

    Attributes:
        scale: rate over change; their standard deviations' ratio, with the sign of the correlation.
        correlation: of the two, over cells of the width at which it is largest in size.
    """

    scale: float
    correlation: float

    @property
    def holds(self) -> bool:
        """Whether the rate is the change of the quantity, in the same unit."""
        return self.correlation > _IS and abs(self.scale - 1.0) <= _SAME

    @property
    def may_hold(self) -> bool:
        """Whether it may be, the noise of either changing the ratio by as much as the correlation allows."""
        c = self.correlation
        return c > _FOLLOWS and c * (1.0 - _SAME) <= self.scale <= (1.0 + _SAME) / c


def link(log: Log, quantity: Array, rate: Array) -> Link | None:
    """Return how a rate goes with the change of a quantity, or ``None`` where too little changes to tell."""
    closest: Link | None = None
    for change, mean in _over_cells(log, quantity, rate):
        spread, other = rms(change), rms(mean)
        if len(change) < _LEAST or spread == 0.0 or other == 0.0:
            continue
        correlation = float(np.mean(change * mean)) / (spread * other)
        if closest is None or abs(correlation) > abs(closest.correlation):
            closest = Link(math.copysign(other / spread, correlation), correlation)
    return closest


def _over_cells(log: Log, quantity: Array, rate: Array) -> Iterator[tuple[Array, Array]]:
    """Yield the change of a quantity and the mean of a rate over whole cells, for each width that leaves enough."""
    area = log.area(rate)
    for width in _WIDTHS:
        if len(area) <= width * (_LEAST + 1):
            break
        cells = Cells.of(log, width)
        whole = np.r_[True, cells.whole] & np.r_[cells.whole, True]
        yield cells.slope(quantity)[whole], cells.slope(area)[whole]


def consistency(log: Log, balance: Balance | None) -> Iterator[Finding]:
    """Judge each measured rate beside its quantity: swapped columns, other units, another sign, another motion.

    Over cells of the record the change of the quantity is correlated with the mean of the rate. Swapped columns are
    those whose exchange makes every pair agree where one does not.
    """
    short = log.short
    channels = {name: short.recording.channels[name] for name in log.measured}
    pairs = [pair for pair in _CHAINS if set(pair) <= set(channels)]
    links = {pair: link(short, channels[pair[0]], channels[pair[1]]) for pair in pairs}
    wrong = [pair for pair, found in links.items() if found is not None and not found.may_hold]
    if wrong and (swapped := _swapped(short, channels, pairs, links)):
        yield _swap(log, *swapped, "each rate is the change of its quantity")
        return
    for pair in wrong:
        found = links[pair]
        assert found is not None
        quantity, rate = (channels[name] for name in pair)
        if abs(found.correlation) < _FOLLOWS and _lost_in_noise(quantity, rate):
            continue
        if is_size_of_change(short, quantity, rate):
            yield _without_its_sign(log, pair)
            continue
        yield _of_pair(log, pair, found, balance)


def is_size_of_change(log: Log, quantity: Array, rate: Array) -> bool:
    """Whether a rate that never changes its sign is the size of the change of a quantity that goes both ways."""
    size = np.abs(rate)
    if abs(float(np.sum(rate))) < _OF_ONE_SIGN * float(np.sum(size)):
        return False
    for change, other in _over_cells(log, quantity, size):
        one = np.abs(change)
        spread = float(np.std(one)) * float(np.std(other))
        goes_back = float(np.sum(change)) ** 2 < _FOLLOWS**2 * float(np.sum(one)) ** 2
        if goes_back and spread > 0.0 and float(np.cov(one, other, bias=True)[0, 1]) > _IS * spread:
            return abs(float(np.std(other) / np.std(one)) - 1.0) <= _SAME
    return False


def _without_its_sign(log: Log, pair: tuple[str, str]) -> Finding:
    quantity, rate = pair
    return Finding(
        f"{rate}-magnitude",
        Severity.STOP,
        rate,
        f"the {log.called(rate)} never changes its sign: it is the size of the change of the {log.called(quantity)}",
        f"take it out of the file: the {rate} is then derived from the {quantity}, with its sign",
    )


def _lost_in_noise(quantity: Array, rate: Array) -> bool:
    """Whether a rate, or its quantity's change over the widest cells, is in RMS below three times its white noise."""
    width = max((width for width in _WIDTHS if len(quantity) > width * (_LEAST + 1)), default=1)
    of_rate, of_change = (9.0 * float(np.mean(np.diff(one, 3) ** 2)) / 20.0 for one in (rate, quantity))
    return float(np.mean(rate**2)) < of_rate or float(np.mean(np.diff(quantity[::width]) ** 2)) < 2.0 * of_change


def _swapped(
    log: Log,
    channels: dict[str, Array],
    pairs: list[tuple[str, str]],
    links: dict[tuple[str, str], Link | None],
) -> tuple[str, str] | None:
    names = [name for name in ("position", "velocity", "acceleration", "torque") if name in channels]
    for one, other in combinations(names, 2):
        renamed = {**channels, one: channels[other], other: channels[one]}
        again = {
            pair: link(log, renamed[pair[0]], renamed[pair[1]]) if {one, other} & set(pair) else links[pair]
            for pair in pairs
        }
        if all(found is not None and found.holds for found in again.values()):
            return one, other
    return None


def exchanged(log: Log, found: Balance) -> Iterator[Finding]:
    """Judge whether torque and motion are swapped where only one channel tells the motion.

    The balance is set up once more with the two channels exchanged. They are swapped if that leaves less than a quarter
    of the share of the variance, with a friction and an inertia that are certainly positive. A Coulomb friction that
    drives is none: a torque with one in it, taken for a velocity, gives it back with its sign turned.
    """
    motion = [name for name in ("velocity", "position") if name in log.measured]
    if len(motion) != 1:
        return
    channel = motion[0]
    recording = log.short.recording
    channels = {**recording.channels, "torque": recording[channel], channel: recording.torque}
    other = best(balances(Log(replace(recording, channels=channels))))
    if other is None or other.unexplained > 0.25 * found.unexplained:
        return
    drives = certain(-other.ratio({"K_c": 1.0}), other.clusters)
    if not drives and all(certain(one, other.clusters) for one in (other.power, other.ratio({"J": 1.0}))):
        yield _swap(log, "torque", channel, "the drive obeys its equation of motion")


def _swap(log: Log, one: str, other: str, then: str) -> Finding:
    return Finding(
        "swapped-columns",
        Severity.STOP,
        one,
        f"the {log.called(one)} and the {log.called(other)} are swapped: with the one in place of the other {then}",
        f"map them the other way round, as in {log.exchanged(one, other)}",
    )


def _of_pair(log: Log, pair: tuple[str, str], found: Link, balance: Balance | None) -> Finding:
    quantity, rate = pair
    names = log.called(rate), log.called(quantity)
    if abs(found.correlation) < _FOLLOWS:
        return Finding(
            "velocity-scale",
            Severity.WARN,
            rate,
            f"the {names[0]} does not follow the change of the {names[1]}",
            "check which columns they are",
        )
    says = f"the {names[0]} is {figures(found.scale, 3)} times the change of the {names[1]}"
    if found.scale < 0:
        turned = balance is not None and certain(-balance.power, balance.clusters)
        which = rate if turned else quantity
        return Finding(
            "velocity-sign",
            Severity.STOP if turned else Severity.WARN,
            rate,
            f"{says}; {'with this velocity friction would drive the joint' if turned else 'their signs differ'}",
            f"turn the sign of one of them, as in {log.turned(which)}",
        )
    if unit := clock.other_unit(log, decades(found.scale)):
        return clock.in_unit(log, unit, says)
    units = units_of(log, found.scale) if log.rotary and quantity == "position" else []
    if units:
        angle, speed = units[0]
        either = " or ".join(f"{a} and {b}" for a, b in units)
        where = "where they are logged in" if log.column(quantity)[1] or log.column(rate)[1] else "between"
        options = [
            log.option(channel, unit)
            for channel, unit, usual in (("position", angle, "rad"), ("velocity", speed, "rad/s"))
            if unit != (log.column(channel)[1] or usual)
        ]
        return Finding(
            "unit",
            Severity.STOP if not _whole(found.scale) else Severity.WARN,
            "velocity" if speed != (log.column("velocity")[1] or "rad/s") else "position",
            f"{says}, as {where} {either}",
            "give the unit, as in " + " ".join(options),
        )
    of_time = log.option("time", "min") if clock.is_of_minutes(found.scale) else ""
    return Finding(
        "velocity-scale",
        Severity.WARN,
        rate,
        f"{says}{_as_between(found.scale)}; a gear between the two sensors does the same",
        f"if it is a unit, give it, as in {of_time or as_scaled(log, rate, found.scale)}",
    )


def decades(scale: float) -> int:
    """Return of which power of ten a ratio is within a hundredth; 0 if of none."""
    power = round(math.log10(scale))
    return power if abs(scale / 10.0**power - 1.0) < clock.MATCHES else 0


def _as_between(scale: float) -> str:
    if clock.is_of_minutes(scale):
        return ", as of a time in minutes"
    if not (power := decades(scale)):
        return ""
    word = {3: "milli", 6: "micro", 9: "nano"}.get(abs(power))
    return ", a power of ten" if word is None else f", as between {word} and one, or with a time in another unit"


def as_scaled(log: Log, rate: str, scale: float) -> str:
    """Return the option that reads a rate so many times smaller: a tenth of its unit as ``0.1 rpm``, else ``UNIT``."""
    power, unit = decades(scale), log.column(rate)[1]
    return log.option(rate, f"{10.0**-power:g} {unit}" if power and unit and not unit[0].isdigit() else "UNIT")


def ratio_to_position(log: Log) -> float | None:
    """Return how many times the change of the position the velocity is; ``None`` where it does not follow it."""
    if not {"position", "velocity"} <= set(log.measured):
        return None
    found = link(log.short, log.short.recording["position"], log.short.recording["velocity"])
    return found.scale if found is not None and found.correlation > _IS else None


def units_of(log: Log, scale: float) -> list[tuple[str, str]]:
    """Return the units of angle and speed by which a ratio is explained, with which the two were logged.

    A unit that was given is one of them; where both were given, one of them is. The likelier come first: those with
    fewer strange units.
    """
    angle, speed = log.column("position")[1], log.column("velocity")[1]
    logged = scale * log.factor("position") / log.factor("velocity")
    found = [
        (a, s)
        for a, of_angle in _ANGLES.items()
        for s, of_speed in _SPEEDS.items()
        if abs(logged * of_angle / of_speed - 1.0) < clock.MATCHES
    ]
    agreeing = [((not angle or a == angle) + (not speed or s == speed), (a, s)) for a, s in found]
    needed = 1 if angle and speed else 2
    pairs = [pair for count, pair in agreeing if count >= needed]
    return sorted(pairs, key=lambda pair: (pair[0] != "rad") + (pair[1] != "rad/s"))


def _whole(scale: float) -> bool:
    """Whether a gear of whole numbers would do: 6 : 1, 60 : 1, 360 : 1."""
    larger = max(scale, 1.0 / scale)
    return abs(larger - round(larger)) < clock.MATCHES * larger and round(larger) in (6, 60, 360)


_OF_SAMPLING = 0.6
"""Samples that a backward difference comes late, a half, and a tenth for stamps that are not exact."""
_HARMS = 0.25
"""Samples from which a lag harms more than positions do, two of which are needed for one velocity. Found on rough
drives of 125 to 500 Hz: with 0.05 to 0.2 samples the error rose by a fifth to three times where positions took over,
with 0.4 to 0.5 it fell, and a viscous friction beside a spring was right."""


@dataclass(frozen=True)
class Lag:
    """By how much a measured velocity comes later than the motion.

    Attributes:
        late, error: the time and its standard error [s]; negative where the velocity is ahead of the position.
        clusters: parts of the record that the error is of.
        interval: between two samples [s].
    """

    late: float
    error: float
    clusters: int
    interval: float

    @property
    def is_certain(self) -> bool:
        """Whether it is longer, either way, than a difference of positions costs, with instants that are not exact."""
        return self._exceeds(_OF_SAMPLING)

    @property
    def harms(self) -> bool:
        """Whether the velocity is certainly so late that a better position should take its place."""
        return self.late > 0.0 and self._exceeds(_HARMS)

    def _exceeds(self, samples: float) -> bool:
        return certain((abs(self.late) - samples * self.interval) / self.error, self.clusters)


@once
def velocity_lag(recording: Recording) -> Lag | None:
    r"""Return by how much the measured velocity comes later than the position moves, where there are both.

    .. math:: \bar v_k - \frac{\Delta q_k}{\Delta t} = -T\,\bar{\dot v}_k

    T by least squares with the slopes of the measured velocity four cells earlier and later as the instrument of the
    slope of the position's, so that noise and rounding do not shrink it. Slopes at the same place would do so only
    where the two have noise of their own: most drives derive the velocity from the counts that they log. Error over 32
    clusters. Of cells of one sample, of four and of sixteen that with the least error.
    """
    log = Log(recording)
    if not {"position", "velocity"} <= set(log.measured):
        return None
    short, recording = log.short, log.short.recording
    surest: Lag | None = None
    area = short.area(recording.velocity)
    for width in _CELLS:
        if len(recording) < width * 8 * CLUSTERS:
            break
        cells = Cells.of(short, width)
        k = np.flatnonzero(cells.inside(_APART + 1)) + _APART + 1
        moved, mean = cells.slope(recording["position"]), cells.slope(area)
        step = 0.5 * (cells.time[k + 2] - cells.time[k - 1] + cells.time[k + 1] - cells.time[k])
        before, after = (mean[k + place + 1] - mean[k + place - 1] for place in (-_APART, _APART))
        group = clusters(cells.edges[k], len(recording), CLUSTERS)
        late, error, count = slope((moved - mean)[k], (moved[k + 1] - moved[k - 1]) / step, group, before + after)
        if error > 0 and (surest is None or error < surest.error):
            surest = Lag(late, error, count, recording.interval)
    return surest


def is_late(recording: Recording) -> bool:
    """Whether a measured velocity is that of the position, in the same unit, and certainly later than it.

    So it is for less than a sample: a viscous torque beside a spring of stiffness k is too small by k times the lag.
    """
    found = velocity_lag(recording)
    return found is not None and found.harms and in_same_unit(Log(recording))


def in_same_unit(log: Log) -> bool:
    """Whether a measured velocity may be the rate of the position in the same unit, with no gear between them."""
    same = link(log.short, log.short.recording["position"], log.short.recording.velocity)
    return same is not None and same.may_hold


def lag(log: Log) -> Iterator[Finding]:
    """Say whether the measured velocity comes later than the motion; see :func:`velocity_lag`."""
    found = velocity_lag(log.recording)
    if found is None or not found.is_certain:
        return
    behind = found.late > 0.0
    yield Finding(
        "velocity-lag",
        Severity.WARN,
        "velocity",
        f"the {log.called('velocity')} is {figures(1e3 * abs(found.late), 3)} ms "
        f"({abs(found.late) / found.interval:.1f} "
        f"samples) {'behind' if behind else 'ahead of'} the {log.called('position')}"
        + ("; where positions tell the motion more surely it is derived from them" if behind else ""),
        "" if behind else "leave the velocity out, so that it is derived from the position, or shift it",
    )
