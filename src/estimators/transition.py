"""One sampling step of the drive and its derivative, with sticking, as the filters need them.

The drive ``dx/dt = g(x, u)`` is advanced by the explicit midpoint rule in the direction of motion. Where the velocity
would change its sign within the step, the step is cut at the instant of rest; from there the drive goes on in the other
direction if the torque overcomes the friction torque of that direction, and else stays at rest for what is left of the
step (Karnopp's stick condition, without a velocity band: the friction torque at rest is whatever holds the drive).

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

from fricmodels.drive import StateSpace


@dataclass(frozen=True)
class Transition:
    """``x⁺ = f(x, u, Δt)`` and ``F = ∂f/∂x`` as CasADi ``SX`` expressions of the state space's own symbols.

    ``u`` holds the inputs in the middle of the step.
    """

    space: StateSpace
    duration: Any
    following: Any
    jacobian: Any


def transition(space: StateSpace) -> Transition:
    """Build the step of a drive; the width of rest stays a symbol."""
    import casadi

    x, u, width = space.x, space.u, space.width
    rate = casadi.Function("rate", [x, u, width], [space.rate])
    duration = casadi.SX.sym("duration")
    moving = len(space.states)
    velocity = x[0]
    direction = casadi.if_else(velocity >= 0, 1, -1)
    creeping = 1e-3 * width

    middle = x + 0.5 * duration * rate(x, u, width)
    middle[0] = direction * casadi.fmax(direction * middle[0], creeping)
    end = x + duration * rate(middle, u, width)

    turns = direction * end[0] < 0
    fall = casadi.if_else(turns, direction * (velocity - end[0]), 1)
    remaining = duration * (1 - direction * velocity / fall)
    at_rest = casadi.vertcat(-direction * creeping, end[1:])
    backward = rate(at_rest, u, width)[0]
    reverses = direction * backward < 0
    after_rest = casadi.if_else(reverses, remaining * backward, 0)
    following = casadi.vertcat(casadi.if_else(turns, after_rest, end[0]), end[1:moving], x[moving:])
    return Transition(space, duration, following, casadi.jacobian(following, x))
