"""Play between motor and load."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, exp, expm1, maximum, minimum, sign, sqrt, where
from fricmodels.parameter import Parameter, State
from fricmodels.results.experiments import SMALL_REVERSALS
from fricmodels.term import Effect, Parameters, Signals


class Backlash(Effect):
    r"""Play: the motor crosses a gap of width w without the load, which goes on by itself and is then struck.

    .. math::
        \tau &= -J_l\,\big[\dot\omega + a\operatorname{sgn}\omega + \tfrac{a}{\omega_v}\,\omega
                + a\,\big(b + \tfrac{\tau_L}{F}\big)\big] && \text{within the gap, } |x| < w/2 \\
        \tau &= J_l\,v/T && \text{in contact}

    It takes away what a drive without play would need to move the load, and gives back the blow at the end of the gap.
    x is the twist between motor and load and v its rate, so that the load's speed is ω − v. Within the gap the load is
    braked by its own friction, dry friction of a·(1 ± b) forward and backward among it, and moved by the known load
    torque,

    .. math::
        \dot x = v, \qquad
        \dot v = \dot\omega + a\operatorname{sgn}(\omega - v) + \tfrac{a}{\omega_v}(\omega - v)
                 + a\,\big(b + \tfrac{\tau_L}{F}\big)

    until it rests; in contact the motor takes it along, :math:`\dot x = 0,\ \dot v = -v/T`, and the contact can only
    push: it opens where the load would run ahead. The blow takes the time T, a fiftieth of √(w/a), short against all
    that is recorded; nothing bounces. The drive's inertia and friction stay the whole ones, motor and load. Where a
    drive stands in its gap at first is not known: x = 0 is taken for contact, on the flank that the first motion loads.

    F, the dry friction J_l·a of a load on which all of the known load torque acts, is not to be told without one. A
    constant torque on the load does what b does.

    Source: Nordin and Gutman (2002), the dead-zone model, with a contact that is stiff against all that is recorded.
    """

    name = "backlash"
    formula = "τ = −J_l·(dω/dt + a·(sgn ω + b) + a·ω/ω_v + a·τ_L/F) while |x| < w/2, else J_l·v/T;  dx/dt = v"
    signature = "a pulse where the joint's torque turns, of fixed width in position, and a shock at its end"
    needs_motion = "reversals"
    separated_from = dict.fromkeys(
        ("stribeck", "nonlinear-viscous", "rising-stiction", "frictional-lag", "sensor-delay"), SMALL_REVERSALS
    )
    optional = frozenset({"load_torque"})
    J_l = Parameter("J_l", unit="kg m^2", lower=0.0, part_of_drive=True, meaning="inertia of the load behind the gap")
    w = Parameter(
        "w",
        unit="rad",
        initial=1e-3,
        lower=1e-12,
        meaning="width of the gap",
        scan=(0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.03),
    )
    a = Parameter(
        "a",
        unit="rad/s^2",
        initial=10.0,
        lower=1e-9,
        meaning="deceleration of the load by its own dry friction",
        scan=(0.03, 0.1, 0.3, 1.0, 3.0),
    )
    omega_v = Parameter(
        "omega_v",
        unit="rad/s",
        initial=10.0,
        lower=1e-9,
        meaning="speed at which the load's viscous friction is as much as its dry friction",
        scan=(0.5, 1.0, 2.0),
        doubtful_ends=(),
    )
    F = Parameter(
        "F",
        unit="N m",
        initial=1.0,
        lower=1e-12,
        meaning="dry friction torque of the load, against which a load torque counts",
        scan=(0.14, 0.2, 0.28),
        doubtful_ends=(),
    )
    b = Parameter(
        "b",
        unit="1",
        initial=0.0,
        lower=-0.9,
        upper=0.9,
        meaning="share by which the load's dry friction is more forward and less backward, or a constant torque on it",
        scan=(0.0,),
    )
    x = State("x", unit="rad", meaning="twist between motor and load, 0 where it is not known", unknown_at_rest=True)
    v = State("v", unit="rad/s", meaning="rate of twist", unknown_at_rest=True)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return what is missing within the gap, and the blow at its end."""
        within = (absolute(s.x) < p.w / 2) * (s.x != 0)
        missing = s.acceleration + _braking(s.velocity, p) + _pushed(s.load_torque, p)
        return p.J_l * ((1 - within) * s.v / _blow(p) - within * missing)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the rates of twist; that the gap closes and opens in no time only :meth:`discrete_step` can say."""
        pushed = _pushed(s.load_torque, p)
        side = where(s.x > 0, 1, -1)
        held = side * (s.acceleration + _braking(s.velocity, p) + pushed + s.v / _blow(p)) >= 0
        contact = (absolute(s.x) >= p.w / 2) * held
        alone = s.acceleration + _braking(s.velocity - s.v, p) + pushed
        return {"x": where(contact, 0, s.v), "v": where(contact, -s.v / _blow(p), alone)}

    def discrete_step(self, s: Signals, later: Signals, h: Expression, p: Parameters) -> Mapping[str, Expression]:
        """Return the twist after a step in which the velocity changes linearly; the load rests, strikes or leaves."""
        first, last, half = s.velocity, later.velocity, p.w / 2
        pushed = _pushed((s.load_torque + later.load_torque) / 2, p)
        rigid = (last - first) / h + _braking((first + last) / 2, p) + pushed
        side = where(s.x == 0, where(rigid >= 0, 1, -1), where(s.x > 0, 1, -1))
        known = where(s.x == 0, side * half, s.x)
        contact = (absolute(known) >= half) * (side * (rigid + s.v / _blow(p)) >= 0)
        # The load by itself: its friction brakes it down to rest, and not beyond.
        slowing = 1 + h * p.a / p.omega_v
        free, stop = (first - s.v - h * pushed) / slowing, h * p.a / slowing
        speed = maximum(free - stop, 0) + minimum(free + stop, 0)
        left = last - speed
        moved = h * (s.v + left) / 2
        reached = known + moved
        strikes = (absolute(known) < half) * (absolute(reached) >= half)
        there = where(reached > 0, 1, -1)
        share = where(strikes, (there * half - known) / where(moved == 0, 1, moved), 0)
        # However short a blow is, the samples after it add up to its momentum.
        struck = there * maximum(there * (s.v + share * (left - s.v)), 0)
        blow = -struck * expm1(-h / _blow(p)) * _blow(p) / h
        fading = where(s.v == 0, 0, s.v * exp(-h / _blow(p)))
        return {
            "x": where(contact, known, where(strikes, there * half, reached)),
            "v": where(contact, fading, where(strikes, blow, left)),
        }

    def own_friction(self, speed: float, parameters: Mapping[str, float]) -> float:
        """Return J_l·a·(1 + ω/ω_v), dry and viscous friction of the load."""
        p = parameters
        return p["J_l"] * p["a"] * (1 + speed / p["omega_v"])


def _blow(p: Parameters) -> Expression:
    """Return the duration of a blow."""
    return 0.02 * sqrt(p.w / p.a)


def _braking(velocity: Expression, p: Parameters) -> Expression:
    """Return the deceleration of the load by its own friction."""
    return p.a * sign(velocity) + p.a / p.omega_v * velocity


def _pushed(load_torque: Expression, p: Parameters) -> Expression:
    """Return the deceleration of the load by what acts on it whichever way it moves."""
    return p.a * (p.b + load_torque / p.F)
