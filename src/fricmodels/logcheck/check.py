"""All checks of a recording, in the order in which what they find is printed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fricmodels.logcheck import (
    angle,
    clock,
    colour,
    command,
    dead_band,
    delay,
    end_stops,
    given_inertia,
    limits,
    magnitude,
    motion,
    rates,
    repeats,
    samples,
    scale,
    stamps,
    torque,
)
from fricmodels.logcheck.balance import balances, best
from fricmodels.logcheck.files import by_file
from fricmodels.logcheck.finding import GRAVEST_FIRST, Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.parameter import check_inertia
from fricmodels.recording import Recording


def findings(recording: Recording, inertia: float | None = None) -> tuple[Finding, ...]:
    """Return what is the matter with a recording, the gravest first.

    Args:
        recording: as read.
        inertia: the stated one [kg m² or kg], which the recording may contradict, and by which units are judged.

    Raises:
        InputError: for an inertia that is not positive and finite.
    """
    return findings_of(Log(recording), inertia)


def findings_of(log: Log, inertia: float | None = None) -> tuple[Finding, ...]:
    """Return what is the matter with the recording of a log, the gravest first; see :func:`findings`."""
    check_inertia(inertia)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = by_file(log.recording, [*_all(log, inertia)], lambda part: [*_all(Log(part), inertia)])
        found.extend(command.one_size(log, inertia))  # of the whole: another file may have commands of another size
        return tuple(sorted(found, key=lambda finding: GRAVEST_FIRST.index(finding.severity)))


def _all(log: Log, inertia: float | None) -> Iterator[Finding]:
    yield from stamps.gaps(log)
    yield from stamps.lost(log)
    yield from stamps.truth(log)
    yield from angle.wrapped(log)
    yield from samples.jumps(log)
    yield from angle.grid(log)
    yield from angle.counts(log)
    rows = balances(log)
    found = best(rows)
    related = list(rates.consistency(log, found))
    if found is not None and not related:
        related = list(rates.exchanged(log, found))
    judged = list(given_inertia.judged(log, rows, inertia)) if found is not None else []
    if judged and any(map(_of_motion, related)) and given_inertia.is_of_motion(log, rows, inertia):
        related, judged = [_certain(finding) for finding in related], []  # both say that it is a unit
    yield from related
    if found is not None and not any(finding.severity is Severity.STOP for finding in related):
        yield from magnitude.magnitude(log, rows)
        yield from torque.sign(log, found)
        yield from judged
        if (voltages := list(torque.voltage(log, found))) and not given_inertia.is_right(rows, inertia):
            yield from voltages  # of one the inertia would be off by the resistance over the torque constant
        yield from delay.delay(log, rows)
        yield from angle.periods(log, found)
    if not related:
        yield from scale.scale(log)
        yield from rates.lag(log)
    if not any(finding.channel == "time" for finding in (*related, *judged)):
        yield from clock.far_off(log)
    yield from limits.torque_limit(log)
    yield from end_stops.end_stop(log)
    yield from dead_band.dead(log)
    yield from samples.overlooked(log)
    yield from samples.unequal(log)
    yield from samples.unread_units(log)
    yield from samples.without_sign(log)
    yield from samples.wrapped_clock(log)
    constant = list(samples.constant(log))
    yield from constant
    spikes = list(samples.spikes(log))
    yield from spikes
    if not related and not any(finding.channel in ("velocity", "position") for finding in spikes):
        yield from samples.unlike_the_position(log)
    yield from repeats.polled(log)
    yield from repeats.outages(log)
    renewed = list(repeats.repeated(log))
    yield from renewed
    polled = {finding.channel for finding in renewed}
    yield from (finding for finding in repeats.held(log) if finding.channel not in polled)
    yield from samples.beginnings(log)
    yield from samples.quantisation(log)
    noises = {name: colour.channel_noise(log.short, log.short.recording[name]) for name in log.measured}
    dead = {finding.channel for finding in constant}
    if "velocity" in noises and "position" in noises and not related and "position" not in dead:
        noises["velocity"] = max(noises["velocity"], colour.difference_noise(log.short), key=colour.evidence)
    yield from colour.colour(log, noises)
    yield from motion.without_position(log)
    little = list(motion.little(log, noises["velocity"].size if "velocity" in noises else 0.0))
    yield from little
    if not little and not related:
        yield from motion.one_frequency(log)


def _of_motion(finding: Finding) -> bool:
    """Whether a finding is on the unit of the motion."""
    return finding.kind == "unit" and finding.channel in ("position", "velocity")


def _certain(finding: Finding) -> Finding:
    """Return the finding on a unit as one that stops: the given inertia says as well that a unit is wrong.

    The ratio of velocity and position names both units, the inertia alone names one and guesses the other.
    """
    return replace(finding, severity=Severity.STOP) if _of_motion(finding) else finding
