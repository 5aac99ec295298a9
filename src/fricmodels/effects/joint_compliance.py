"""Elasticity between motor and link."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, cos, exp, maximum, sin, sqrt, where
from fricmodels.parameter import Parameter, State
from fricmodels.results.experiments import SEVERAL_FREQUENCIES, SMALL_REVERSALS
from fricmodels.term import Effect, Parameters, Signals

_LEAST = 1e-12
"""Distance from critical damping, of 1 − ζ², below which there is no difference."""


class JointCompliance(Effect):
    r"""A link of inertia J_l on a spring, where the drive model has it rigid: a resonance between motor and link.

    .. math:: \tau = -J_l \dot v, \quad \dot x = v, \quad \dot v = \dot\omega - \omega_n^2 x - 2\zeta\omega_n v

    x and v are the twist and its rate; J stays the whole inertia, motor and link. Where J is given as that of the motor
    alone, what is missing beside the spring is ``inertia-error``, ΔJ = J_l.

    Source: Spong (1987), the elastic joint linearised about the motor.
    """

    name = "joint-compliance"
    formula = "τ = −J_l·dv/dt;  dx/dt = v;  dv/dt = dω/dt − ω_n²·x − 2·ζ·ω_n·v"
    signature = "a resonance"
    needs_motion = "acceleration up to the resonance"
    beginning_unknown = True
    separated_from = {
        **dict.fromkeys(("inertia-error", "frictional-lag"), SEVERAL_FREQUENCIES),
        "backlash": SMALL_REVERSALS,
    }
    J_l = Parameter("J_l", unit="kg m^2", lower=0.0, part_of_drive=True, meaning="inertia of the link, a part of J")
    omega_n = Parameter(
        "omega_n",
        unit="1/s",
        initial=100.0,
        lower=1e-9,
        meaning="natural angular frequency of the link",
        own_time=True,
        resonance=True,
        scan=tuple(round(10 ** (1.5 + 0.15 * i), 1) for i in range(19)),
    )
    zeta = Parameter(
        "zeta",
        initial=0.1,
        lower=0.0,
        upper=1.0,  # beyond, nothing resonates: what fits best there is something else
        meaning="damping ratio",
        scan=(0.03, 0.15),
        doubtful_ends=("upper",),
    )
    x = State("x", unit="rad", meaning="twist")
    v = State("v", unit="rad/s", meaning="rate of twist")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return what the spring transmits less what a rigid link would take."""
        spring = p.omega_n**2 * s.x + 2 * p.zeta * p.omega_n * s.v
        return p.J_l * (spring - s.acceleration)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the rates of twist."""
        spring = p.omega_n**2 * s.x + 2 * p.zeta * p.omega_n * s.v
        return {"x": s.v, "v": s.acceleration - spring}

    def discrete_step(self, s: Signals, later: Signals, h: Expression, p: Parameters) -> Mapping[str, Expression]:
        """Return the twist after a step in which the velocity changes linearly, exactly."""
        fading, turning = p.zeta * p.omega_n, p.omega_n * sqrt(maximum(absolute(1 - p.zeta**2), _LEAST))
        slow, fast = exp((turning - fading) * h), exp(-(turning + fading) * h)
        swings = p.zeta < 1
        cosine = where(swings, exp(-fading * h) * cos(turning * h), (slow + fast) / 2)
        sine = where(swings, exp(-fading * h) * sin(turning * h), (slow - fast) / 2) / turning
        lasting = (later.velocity - s.velocity) / h / p.omega_n**2
        away = s.x - lasting
        return {
            "x": lasting + (cosine + fading * sine) * away + sine * s.v,
            "v": (cosine - fading * sine) * s.v - p.omega_n**2 * sine * away,
        }

    def first_states(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the twist with which the link follows a lasting acceleration: x = (dω/dt)/ω_n²."""
        return {"x": s.acceleration / p.omega_n**2}
