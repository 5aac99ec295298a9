"""Whether the inertia that is given can be that of the recording."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.logcheck import clock
from fricmodels.logcheck.balance import CLUSTERS, Balance
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.rates import as_scaled, decades, ratio_to_position, units_of
from fricmodels.logcheck.view import Log
from fricmodels.readers import units
from fricmodels.results.words import figures
from fricmodels.signals.clusters import LEVEL, PROBABLE, certain, slope

_UNITS = {
    "velocity": {"deg/s": math.pi / 180.0, "rpm": math.pi / 30.0, "turn/s": 2.0 * math.pi, "rad/s": 1.0},
    "position": {"deg": math.pi / 180.0, "turn": 2.0 * math.pi, "rad": 1.0},
    "torque": {"mN*m": 1e-3, "N*m": 1.0, "N*cm": 1e-2, "kN*m": 1e3},
    "current": {"mA": 1e-3, "A": 1.0},
}
_LINEAR_UNITS = {
    "velocity": {"mm/s": 1e-3, "m/s": 1.0},
    "position": {"mm": 1e-3, "m": 1.0},
    "torque": {"mN": 1e-3, "N": 1.0, "kN": 1e3},
    "current": {"mA": 1e-3, "A": 1.0},
}
"""Units that a channel may be in, of a rotary and of a linear drive → how much SI one is."""
_SLIPS = {1e3: "g m²", 3417.17: "lb in²", 1e4: "kg cm²", 54674.8: "oz in²", 1e6: "kg mm²", 1e7: "g cm²", 1e9: "g mm²"}
"""How many times the inertia in kg m² its number is in another unit."""
_LINEAR_SLIPS = {1e3: "g"}
_NEAR = 1.3
"""So many times the inertia may be off by friction or another joint."""
_ERROR = 3.0
"""So many times may be an unlisted load, or what the effect ``inertia-error`` finds."""
_SAME = 0.1
"""A velocity that is the change of the position within a tenth is in its unit."""
_SMALLEST = 1e-6
"""Share of the torque below which no sensor tells it: its error is taken to be so much."""
_EXPLAINS = 1.0 / 3.0
"""As in a diagnosis, where an effect explains a third of what is left at the least. Of 538 simulated drives with their
own inertia three were accused, which is half a percent."""
_NONSENSE = 10.0
"""So many times is no error of an inertia any more; that effect takes no less than a tenth."""


@dataclass(frozen=True)
class Told:
    """The inertia that a recording tells by itself.

    Attributes:
        value, error: the inertia and its standard error.
        clusters: parts of the record that the error is of.
        seen: mean square of the acceleration that neighbouring cells tell, beside all other columns.
        left: mean square of the torque that nothing explains.
        share: that of the torque's variance which the balance leaves.
    """

    value: float
    error: float
    clusters: int
    seen: float
    left: float
    share: float

    @property
    def is_sure(self) -> bool:
        """Whether it is told from zero."""
        return self.value > self.half(LEVEL)

    @property
    def size(self) -> float:
        """The inertia; the greatest that it may be where it is not told from zero."""
        return self.value if self.is_sure else self.value + self.half(LEVEL)

    def contradicts(self, inertia: float) -> bool:
        """Whether an inertia is off for certain, by more than is left to the diagnosis; see :func:`judged`."""
        reach, near = self.half(LEVEL), self.half(PROBABLE)
        if self.value + reach <= 0.0 or (inertia - self.value) ** 2 * self.seen < _EXPLAINS * self.left:
            return False
        too_small = inertia < self.value - reach and _ERROR * inertia < self.value - near
        return too_small or (inertia > self.value + reach and inertia > _ERROR * (self.value + near))

    def fits(self, inertia: float) -> bool:
        """Whether it may be so much, but for what friction or another joint makes of it."""
        reach = self.half(0.025)
        return self.is_sure and (self.value - reach) / _NEAR < inertia < (self.value + reach) * _NEAR

    def half(self, level: float) -> float:
        """Return half the width of the interval outside of which either side has so small a chance."""
        from scipy.special import stdtrit

        return -float(stdtrit(max(self.clusters - 1, 1), level)) * self.error


def told(rows: Sequence[Balance]) -> list[Told]:
    r"""Return the inertia that a recording tells by itself, at each width that does; first where most is explained.

    The torque and the acceleration of each row are taken as what the other columns of the balance leave of them. Noise
    of the velocity would make the slope of the one on the other too small. So the acceleration between cells farther
    out, with none in common, is the instrument: noise is not the same there. It has to go with that of the row for
    certain.
    """
    found = [one for row in rows if (one := _at_width(row)) is not None]
    return sorted(found, key=lambda one: one.share)


def _at_width(row: Balance) -> Told | None:
    at = np.flatnonzero(np.isfinite(row.beside))
    if len(at) < 4 * CLUSTERS:
        return None
    place = row.names.index("J")
    others = np.delete(row.columns[at], place, axis=1)
    scale = np.sqrt(np.mean(others**2, axis=0))
    others = others / np.where(scale > 0.0, scale, 1.0)
    own = np.stack([row.target[at], row.columns[at, place], row.beside[at]], axis=1)
    torque, acceleration, beside = (own - others @ np.linalg.lstsq(others, own, rcond=1e-10)[0]).T
    cluster = np.unique(row.cluster[at], return_inverse=True)[1]
    follows, its_error, count = slope(acceleration, beside, cluster)
    if not certain(follows / its_error if its_error > 0.0 else 0.0, count):
        return None
    value, error, count = slope(torque, acceleration, cluster, beside)
    error = max(error, _SMALLEST * float(np.sqrt(np.mean(own[:, 0] ** 2) / np.mean(acceleration**2))))
    alone = slope(torque, acceleration, cluster)[0]
    seen = float(np.mean((follows * beside) ** 2))
    left = float(np.mean((torque - alone * acceleration) ** 2))
    return Told(value, error, count, seen, left, row.unexplained)


def judged(log: Log, rows: Sequence[Balance], given: float | None) -> Iterator[Finding]:
    """Judge the inertia that is given by the one that the recording tells.

    A finding is one that is off at the level of :data:`~fricmodels.signals.clusters.LEVEL`, and by more than three
    times at that of :data:`~fricmodels.signals.clusters.PROBABLE`, where the torque for the difference is more than a
    third of what the balance leaves, in squares: else it may be of what is left out. Every width that tells the inertia
    better must say so, too. Less than that is for the diagnosis to name. It stops where the inertia is ten times off,
    or where a unit fits: of the inertia, of the motion, or of the torque. Motion in degrees taken for radians makes the
    inertia that the recording tells 57.3 times too small, one in rpm 9.55 times; a torque in mN m makes it a thousand
    times too large. A unit fits within three tenths of the interval of 95 %; one that was given does not.

    Where the velocity is the same power of ten times the change of the position, it is the velocity; where the samples
    are too far apart for a drive, and that power of ten puts them right, it is the time.
    """
    found = [] if given is None else told(rows)
    if given is None or not found or not found[0].contradicts(given):
        return
    first, surer = found[0], [one for one in found[1:] if one.error < found[0].error]
    if all(one.size > _ERROR * given if first.size > given else _ERROR * one.size < given for one in surer):
        yield _of_channel(log, given, first) or _of_inertia(log, given, first)


def _of_channel(log: Log, given: float, found: Told) -> Finding | None:
    """Return what is in another unit where the motion, or its time, says so as well."""
    apart = given / found.size
    says = (
        f"the torque asks for an inertia of {figures(found.size, 3)} where {figures(given, 3)} is given, a ratio of "
        f"{figures(apart, 3)}"
    )
    scale = ratio_to_position(log)
    if scale is not None and decades(scale) and found.fits(given / scale):
        return Finding(
            "unit",
            Severity.STOP,
            "velocity",
            f"{says}: so many times the change of the position the {log.called('velocity')} is, too",
            f"give its unit, as in {as_scaled(log, 'velocity', scale)}",
        )
    if scale is not None and clock.is_of_minutes(scale) and found.fits(given * scale):
        return clock.in_unit(log, "min", f"{says}, and the position says so, too")
    if {"position", "velocity"} <= set(log.measured):
        return None  # the two agree, and so does the time
    slopes = 1 if "velocity" in log.measured else 2  # of what is measured, to the acceleration
    power = round(-math.log10(apart) / slopes)
    unit = clock.other_unit(log, power) if found.fits(given * 10.0 ** (power * slopes)) else ""
    return clock.in_unit(log, unit, says) if unit else None


def _of_inertia(log: Log, given: float, found: Told) -> Finding:
    """Return that the inertia is not that of the recording, and beside it which units would make it so."""
    unit = "kg m²" if log.rotary else "kg"
    slips = _SLIPS if log.rotary else _LINEAR_SLIPS
    fitting = [one for one in slips if found.fits(given / one)]
    slip = min(fitting, key=lambda one: _off(given / one, found), default=None)
    times = f"{'' if found.is_sure else 'over '}{figures(given / found.size, 3)} times"
    says = (
        f"the inertia that is given, {figures(given, 3)} {unit}, is {times} the one that the recording tells, "
        f"{figures(found.value, 3)} ± {figures(found.half(0.025), 1)} {unit}"
    )
    remedy = f"give the inertia in {unit}, and of the side of a gear on which the motion was recorded"
    if slip is not None:
        says += f", as one in {slips[slip]} is"
        remedy = f"give the inertia in {unit}, {figures(given / slip, 3)}"
    remedy += ", or leave it out to have it estimated"
    units = _units(log, given, found)
    if units:
        names = " and ".join(f"the {log.called(channel)} in {name}" for channel, name in units)
        options = " ".join(log.option(channel, name) for channel, name in units)
        says += f"; {names} would do the same"
        remedy += f"; if the inertia is right, give the unit, as in {options}"
    stops = slip is not None or units or _off(given, found) * _NEAR >= _NONSENSE
    return Finding("inertia", Severity.STOP if stops else Severity.WARN, "torque", says, remedy)


def is_right(rows: Sequence[Balance], given: float | None) -> bool:
    """Whether the inertia that is given is the one that the recording tells."""
    found = told(rows) if given is not None else []
    return bool(found) and found[0].fits(given or 0.0)


def is_of_motion(log: Log, rows: Sequence[Balance], given: float | None) -> bool:
    """Whether units of the motion would make a given inertia that of the recording."""
    found = told(rows) if given is not None else []
    return bool(found) and any(name != "torque" for name, _ in _units(log, given or 0.0, found[0]))


def _off(given: float, found: Told) -> float:
    """Return how many times an inertia is off, 1 at the least."""
    return max(given / found.size, found.size / given)


def _units(log: Log, given: float, found: Told) -> list[tuple[str, str]]:
    """Return the channels, each with a unit that it may be in, with which the given inertia would be right.

    The inertia goes with the torque, and against the acceleration. Either was read in the unit that its header states,
    or that was given.
    """
    known = _UNITS if log.rotary else _LINEAR_UNITS
    motion = "velocity" if "velocity" in log.measured else "position"
    scale = ratio_to_position(log)
    for unit, size in known[motion].items():
        times = abs(log.factor(motion)) / size
        if math.isclose(times, 1.0, rel_tol=_SAME) or not found.fits(given / times):
            continue
        beside = _position_beside(log, unit) if motion == "velocity" else []
        if scale is None or beside or math.isclose(scale, times, rel_tol=_SAME):  # else the position refutes it
            return [(motion, unit), *beside]
    columns = log.recording.provenance.get("columns", {})
    pushes = "current" if "torque" not in columns and "current" in columns else "torque"
    of_current = units.is_current(log.column(pushes)[1] or "N*m")
    was = abs(units.further(log.column(pushes)[1])[0].factor) if of_current else abs(log.factor(pushes))
    for unit, size in known["current" if of_current else "torque"].items():
        if not math.isclose(size, was, rel_tol=_SAME) and found.fits(given * was / size):
            return [(pushes, unit)]
    return []


def _position_beside(log: Log, unit: str) -> list[tuple[str, str]]:
    """Return in which unit the position is beside a velocity in that unit; nothing where it is in rad or m."""
    if "position" not in log.measured:
        return []
    scale = ratio_to_position(log)
    if scale is None or abs(scale - 1.0) < _SAME:
        return [("position", "turn" if unit == "rpm" else unit.removesuffix("/s"))]
    return [("position", angle) for angle, speed in units_of(log, scale) if speed == unit and angle != "rad"][:1]
