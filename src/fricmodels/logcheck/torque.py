"""Whether the torque can be what drives the motion: its sign, its delay, or a voltage in its place."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.logcheck.balance import CLUSTERS, Balance
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.signals.clusters import LEVEL, PROBABLE, certain, significance, slope

_VOLTAGE = 0.75
"""Share of the variance from which one term makes the whole; a convention."""
_LEAST_LATE = 2.0
"""Samples: sampling and holding alone make about one."""
_AGREED = 0.05
"""Level at which a delay has to be above zero at every width that knows it better."""


def sign(log: Log, found: Balance) -> Iterator[Finding]:
    r"""Judge whether friction would drive the joint, or its inertia be negative.

    With the torque's sign turned, inertia and friction come out negative. The statistics are the inertia, and the power
    that the friction of the balance takes up, :math:`K_v\overline{\omega^2} + K_c\overline{|\omega|}`, each over its
    standard error; the one that is farther below zero is compared with Student's t of 31, and counts for two. Two more
    things must hold: the other one is not positive beyond chance (the inertia is where the velocity lags, which makes
    the viscous coefficient alone negative; friction is where a late torque makes the inertia negative), and the work of
    the torque is negative as a whole (a speed loop that fights cogging has a torque that falls with the speed, but
    still drives).
    """
    short = log.short
    pushing = short.recording.driving_torque
    friction, mass = found.power, found.ratio({"J": 1.0})
    chance = min(1.0, 2.0 * significance(min(friction, mass), CLUSTERS))
    if min(friction, mass) >= 0.0 or chance >= PROBABLE or certain(max(friction, mass), CLUSTERS):
        return
    if float(np.mean(pushing * short.velocity)) >= 0.0:
        return
    constant = log.recording.provenance.get("torque_constant")
    remedy = (
        f"turn the sign of the torque constant, as in --torque-constant={-constant:g}"
        if constant is not None
        else f"turn its sign, as in {log.turned('torque')}"
    )
    verb, driven = "has" if chance < LEVEL else "may have", "joint" if log.rotary else "axis"
    why = f"friction would drive the {driven}" if friction <= mass else f"the {driven} would have a negative inertia"
    yield Finding(
        "torque-sign",
        Severity.STOP if chance < LEVEL else Severity.WARN,
        "torque",
        f"the {log.called('torque')} {verb} the wrong sign: {why} (p = {chance:.1g})",
        remedy,
    )


def voltage(log: Log, found: Balance) -> Iterator[Finding]:
    r"""Judge whether what is taken for a torque may be a voltage: the back-EMF makes it go with the velocity.

    Said where :math:`K_v\omega` makes three quarters of the torque's variance, both beside the other terms and without
    them, and is certainly positive: beside a Coulomb torque it may be large only because the two cancel. A drive whose
    friction is nearly all viscous looks the same, so that this is no more than a question.
    """
    share = min(found.share("K_v") ** 2, found.explained_alone("K_v"))
    if share > _VOLTAGE and certain(found.ratio({"K_v": 1.0}), CLUSTERS):
        yield Finding(
            "not-a-torque",
            Severity.WARN,
            "torque",
            f"{100 * share:.0f} % of the variance of the {log.called('torque')} goes with "
            f"the velocity alone, as a voltage does by its back-EMF",
            "if it is one, give the current or the torque instead",
        )


def delay(log: Log, rows: list[Balance]) -> Iterator[Finding]:
    r"""Judge whether the torque was recorded later than it acted.

    .. math:: \tau(t) = m(t - T) \approx m - T\,\dot m

    where m is the balance fitted to uninterrupted sliding, away from reversals, where presliding, backlash and
    frictional lag look like a delay, with columns for |ω| and ω|ω| besides. T is the coefficient of the change of m
    after all columns of the balance are projected out, at the width at which it explains most; its error is over 32
    clusters. Said where T is longer than two samples at the level of
    :data:`~fricmodels.signals.clusters.PROBABLE`, and every width that knows T better says as well that it is above
    zero: a delay is the same at all widths, what else the balance leaves out is not. A motion that is recorded late is
    not told here from friction with memory; that is the effect ``sensor-delay``.
    """
    interval = log.recording.interval
    found = [outcome for row in rows if (outcome := _late(row, interval)) is not None]
    if not found:
        return
    late, error, count, _ = max(found, key=lambda outcome: outcome[3])
    surer = [outcome for outcome in found if outcome[1] < error]
    agreed = all(significance(max(other, 0.0) / its, several) < _AGREED for other, its, several, _ in surer)
    if agreed and significance(max(late - _LEAST_LATE, 0.0) / error, count) < PROBABLE:
        yield Finding(
            "torque-delay",
            Severity.WARN,
            "torque",
            f"the {log.called('torque')} is {1e3 * late * interval:.3g} ms ({late:.1f} samples) behind the motion",
            "shift it, or see what the effect sensor-delay makes of it",
        )


def _late(row: Balance, interval: float) -> tuple[float, float, int, float] | None:
    """Return T and its error in samples, the number of clusters, and the share of the rest that it explains."""
    sliding = np.abs(row.columns[:, row.names.index("K_c")]) > 1.0 - 1e-9
    middle = np.zeros(len(row.start), dtype=bool)
    middle[1:-1] = (row.start[2:] - row.start[:-2] == 2 * row.width) & sliding[1:-1] & sliding[2:] & sliding[:-2]
    at = np.flatnonzero(middle)
    if len(at) < 4 * CLUSTERS:
        return None
    speed = np.abs(row.columns[:, row.names.index("K_v")])
    wider = np.column_stack([row.columns, speed, speed * row.columns[:, row.names.index("K_v")]])
    scale = np.sqrt(np.mean(wider**2, axis=0))
    columns = wider / np.where(scale > 0, scale, 1.0)
    fitted = columns @ np.linalg.lstsq(columns[sliding], row.target[sliding], rcond=1e-10)[0]
    both = np.stack([row.target[at], (fitted[at + 1] - fitted[at - 1]) / (2 * row.width)], axis=1)
    both -= columns[at] @ np.linalg.lstsq(columns[at], both, rcond=1e-10)[0]
    cluster = np.unique(row.cluster[at], return_inverse=True)[1]
    value, error, count = slope(both[:, 0], both[:, 1], cluster)
    left = both[:, 0] - value * both[:, 1]
    whole = float(both[:, 0] @ both[:, 0])
    return -value, error, count, 1.0 - float(left @ left) / whole if whole > 0 else 0.0
