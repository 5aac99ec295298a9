"""Whether the torque can be what drives the motion: its sign, or a voltage in its place."""

from __future__ import annotations

from collections.abc import Iterator

from fricmodels.logcheck.balance import Balance
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.signals.clusters import LEVEL, PROBABLE, certain, significance

_WHOLE = 0.75
"""Share of the variance from which one term makes the whole; a convention."""


def sign(log: Log, found: Balance) -> Iterator[Finding]:
    r"""Judge whether friction would drive the joint, or its inertia be negative.

    With the torque's sign turned, inertia and friction come out negative. The statistics are the inertia, and the power
    that the friction of the balance takes up, :math:`K_v\overline{\omega^2} + K_c\overline{|\omega|}`, each over its
    standard error; the one that is farther below zero is compared with Student's t (of 31, of a short log of fewer),
    and counts for two. Two more things must hold: the other one is not positive beyond chance (the inertia is where the
    velocity lags, which makes the viscous coefficient alone negative; friction is where a late torque makes the inertia
    negative), and the work of the torque is negative as a whole (a speed loop that fights cogging has a torque that
    falls with the speed, but still drives). Where no negative inertia shows, something else may have moved the drive.
    """
    short = log.short
    pushing = short.recording.driving_torque
    friction, mass = found.power, found.ratio({"J": 1.0})
    chance = min(1.0, 2.0 * significance(min(friction, mass), found.clusters))
    if min(friction, mass) >= 0.0 or chance >= PROBABLE or certain(max(friction, mass), found.clusters):
        return
    if max(short.work(pushing)) >= 0.0:
        return
    constant = log.recording.provenance.get("torque_constant")
    remedy = (
        f"turn the sign of the torque constant, as in --torque-constant={-constant:g}"
        if constant is not None
        else f"turn its sign, as in {log.turned('torque')}"
    )
    if found.share("K_v") ** 2 > _WHOLE or not certain(-mass, found.clusters):
        remedy += "; but if something else moved it, as a hand or a load does, and its motor braked or answered, drive "
        remedy += "it by its motor"
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
    friction is nearly all viscous looks the same, so that this is no more than a question, and none of a current whose
    column says its unit.
    """
    columns = log.recording.provenance.get("columns", {})
    if "torque" not in columns and "current" in columns and log.column("current")[1]:
        return
    share = min(found.share("K_v") ** 2, found.explained_alone("K_v"))
    if share > _WHOLE and certain(found.ratio({"K_v": 1.0}), found.clusters):
        yield Finding(
            "not-a-torque",
            Severity.WARN,
            "torque",
            f"{100 * share:.0f} % of the variance of the {log.called('torque')} goes with "
            f"the velocity alone, as a voltage does by its back-EMF",
            "if it is one, give the current or the torque instead, or read all parameters in volts: K_v then has the "
            "back-EMF in it",
        )
