"""One sampling step of the drive and its derivative, with sticking, as the filters need them.

The drive ``dx/dt = g(x, u)`` is advanced by the explicit midpoint rule in the direction of motion. Where the velocity
would change its sign within the step, the step is cut at the instant of rest; from there the drive goes on in the other
direction if the torque overcomes the friction torque of that direction, and else stays at rest for what is left of the
step (Karnopp's stick condition, without a velocity band: the friction torque at rest is whatever holds the drive).

Internal states are advanced by the exponential midpoint rule, each with its own decay ∂ż/∂z ≤ 0, so that a contact
that bends within less than a step settles instead of ringing.

Therefore

* a drive at rest has a velocity of exactly zero and the derivative of the next velocity by every state and parameter is
  zero: samples at standstill say nothing about the coefficients and cannot bias them;
* a drive that rests although the estimated friction torque is less than the applied one raises the estimate: the
  inequality "stick torque ≥ applied torque" is used, and no more;
* the derivative through a reversal includes that of the instant of reversal.

Source: Karnopp (1985) for the condition; Moreau's time stepping for the limit of no velocity band.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmodels.filtering.normalisation import NormalisedSpace


@dataclass(frozen=True)
class Transition:
    """``x⁺ = f(x, u, Δt)`` and ``F = ∂f/∂x`` as CasADi ``SX`` expressions of the state space's own symbols.

    ``u`` holds the inputs in the middle of the step.
    """

    duration: Any
    following: Any
    jacobian: Any


def transition(space: NormalisedSpace) -> Transition:
    """Build the step of a drive."""
    import casadi

    x, u, known = space.x, space.u, space.known
    rate = casadi.Function("rate", [x, u, known], [space.rate])
    duration = casadi.SX.sym("duration")
    moving = space.moving
    velocity = x[0]
    direction = casadi.if_else(velocity >= 0, 1, -1)
    creeping = space.creeping

    first = rate(x, u, known)
    middle = x + 0.5 * duration * first
    middle[0] = direction * casadi.fmax(direction * middle[0], creeping)
    fading = casadi.Function("fading", [x, u, known], [_fading(space)])
    decay = fading(x, u, known)
    middle[1:moving] = x[1:moving] + 0.5 * duration * _mean_decay(0.5 * duration * decay) * first[1:moving]
    second = rate(middle, u, known)
    end = x + duration * second
    decay = fading(middle, u, known)
    from_start = second[1:moving] - decay * (middle[1:moving] - x[1:moving])
    end[1:moving] = x[1:moving] + duration * _mean_decay(duration * decay) * from_start

    turns = direction * end[0] < 0
    fall = casadi.if_else(turns, direction * (velocity - end[0]), 1)
    remaining = duration * (1 - direction * velocity / fall)
    at_rest = casadi.vertcat(-direction * creeping, end[1:])
    backward = rate(at_rest, u, known)[0]
    reverses = direction * backward < 0
    after_rest = casadi.if_else(reverses, remaining * backward, 0)
    following = casadi.vertcat(casadi.if_else(turns, after_rest, end[0]), end[1:moving], x[moving:])
    return Transition(duration, following, casadi.jacobian(following, x))


def _fading(space: NormalisedSpace) -> Any:
    """Return how fast each internal state forgets itself, ∂ż/∂z where it is negative."""
    import casadi

    moving = space.moving
    own = [casadi.jacobian(space.rate[i], space.x[i]) for i in range(1, moving)]
    return casadi.fmin(casadi.vertcat(*own), 0) if own else casadi.SX(0, 1)


def _mean_decay(exponent: Any) -> Any:
    """Return (e^x − 1)/x for x ≤ 0, the mean of e^(x s) over s from 0 to 1."""
    import casadi

    below = casadi.fmin(exponent, -1e-8)
    return casadi.expm1(below) / below
