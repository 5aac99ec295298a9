"""One phase of a step of a drive that may stick, as a CasADi function: see :mod:`fricmodels.simulation`."""

from __future__ import annotations

from typing import Any

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.loop import Loop, closed

MOTION = ("velocity", "position", "acceleration")
_NEWTON_STEPS = 2
_AT_ONCE = 1e-9
"""Share of a step within which leaving rest is leaving at once."""


def pushing_signals(drive: Drive, loop: Loop | None = None) -> tuple[str, ...]:
    """Return the signals that a simulation takes as given: torques, temperature, time, further channels; in order.

    Args:
        drive: the model.
        loop: what says the motor torque, and perhaps the load, in place of the recording.
    """
    needed = {"motor_torque", "load_torque", *drive.model.needs} - set(MOTION)
    if loop is None:
        return tuple(name for name in drive.model.signals if name in needed)
    needed |= {"time", "temperature"} & set(loop.channels)
    said = {"motor_torque", *(["load_torque"] if loop.load else [])}
    own = [name for name in loop.channels if name not in drive.model.signals]
    return (*(name for name in drive.model.signals if name in (needed | set(loop.channels)) - said), *own)


class _Motion:
    """The drive's equations on one side of zero velocity, as expressions."""

    def __init__(self, drive: Drive, loop: Loop | None) -> None:
        import casadi

        e = drive.model.expression()
        around = None if loop is None else closed(loop, e.signals)
        if around is not None and "motor_torque_rate" in drive.model.needs:
            raise InputError(
                f"'{drive.model.name}' needs the rate of the motor torque, which a closed loop does not say"
            )
        states = e.states if around is None else casadi.vertcat(e.states, around.states)
        all_rates = e.rates if around is None else casadi.vertcat(e.rates, around.rates)
        symbols = {**e.signals, **({} if around is None else around.given)}
        pushing = [symbols[name] for name in pushing_signals(drive, loop)]

        def pushed(expression: Any) -> Any:
            """Put in what the loop says."""
            if around is None:
                return expression
            return casadi.substitute(
                expression,
                casadi.vertcat(*(e.signals[name] for name in around.torques)),
                casadi.vertcat(*around.torques.values()),
            )

        self.n_states = states.numel()
        self.parameters, self.width = e.parameters, e.width
        self.loop_parameters = casadi.SX(0, 1) if around is None else around.parameters
        self.inertia = casadi.SX.sym("inertia")
        acceleration = e.signals["acceleration"]
        slope = casadi.jacobian(e.torque, acceleration)
        if casadi.depends_on(slope, acceleration):
            raise InputError(f"'{drive.model.name}' is not affine in the acceleration and cannot be simulated")
        slope = pushed(slope)
        at_zero = pushed(casadi.substitute(e.torque, acceleration, 0))
        applied = pushed(e.signals["motor_torque"] - e.signals["load_torque"])
        rate = (applied - at_zero) / (self.inertia + slope)
        arguments = [e.signals["velocity"], e.signals["position"], states, *pushing]
        given = [self.inertia, self.parameters, self.width, self.loop_parameters]
        self._rate = casadi.Function("rate", [*arguments, *given], [rate])
        self._excess = casadi.Function("excess", [*arguments, *given], [applied - at_zero])
        sliding = casadi.substitute(pushed(all_rates), acceleration, rate) if self.n_states else all_rates
        resting = casadi.substitute(pushed(all_rates), acceleration, 0) if self.n_states else all_rates
        self._sliding = casadi.Function("sliding", [*arguments, *given], [sliding])
        self._resting = casadi.Function("resting", [*arguments, *given], [resting])
        later = {**e.later, **({} if around is None else {n: casadi.SX.sym(f"later_{n}") for n in around.given})}
        ends = [later["velocity"], later["position"], *(later[n] for n in pushing_signals(drive, loop)), e.step]
        self._stepped = list(e.discrete_step)
        self._discrete_step = casadi.Function(
            "discrete_step", [*arguments, *ends, *given], [pushed(casadi.vertcat(*e.discrete_step.values()))]
        )
        self._given = given

    def excess(self, direction: Any, position: Any, states: Any, inputs: list[Any]) -> Any:
        """Applied torque beyond what friction holds as the velocity goes to zero from one side."""
        tiny = 1e-9 * self.width
        return self._excess(direction * tiny, position, states, *inputs, *self._given)

    def _change(self, x: Any, direction: Any, position: Any, inputs: list[Any], *, moving: bool) -> Any:
        import casadi

        tiny = 1e-9 * self.width
        speed = casadi.fmax(direction * x[0], tiny) if moving else tiny
        states = x[1:]
        arguments = [direction * speed, position, states, *inputs, *self._given]
        if moving:
            return casadi.vertcat(self._rate(*arguments), self._sliding(*arguments))
        return casadi.vertcat(0, self._resting(*arguments))

    def leg(
        self,
        x: Any,
        position: Any,
        direction: Any,
        length: Any,
        begin: list[Any],
        end: list[Any],
        *,
        moving: bool,
    ) -> tuple[Any, Any]:
        """Advance ``x`` (velocity, internal states) and the position by the trapezium rule.

        Newton's matrix takes no credit for friction that falls with speed: where the law pushes, an iteration is a
        plain fixed-point one, and the rule is Heun's. States with a discrete step follow its formula.
        """
        import casadi

        first = self._change(x, direction, position, begin, moving=moving)
        solved = [0, *(1 + i for i in range(self.n_states) if i not in self._stepped)]
        unknown = casadi.SX.sym("x", len(solved))
        arrived = position + length / 2 * (x[0] + unknown[0])
        following = casadi.SX(x)
        following[solved] = unknown
        if self._stepped:
            speeds = [direction * casadi.fmax(direction * v, 0) if moving else 0 for v in (x[0], unknown[0])]
            stepped = self._discrete_step(
                speeds[0], position, x[1:], *begin, speeds[1], arrived, *end, length, *self._given
            )
            following[[1 + i for i in self._stepped]] = stepped
        last = self._change(following, direction, arrived, end, moving=moving)
        residual = (following - x - length / 2 * (first + last))[solved]
        matrix = casadi.jacobian(residual, unknown)
        matrix[0, 0] = casadi.fmax(matrix[0, 0], 1)
        improved = unknown - casadi.solve(matrix, residual)
        guess = (x + length * first)[solved]
        for _ in range(_NEWTON_STEPS):
            guess = casadi.substitute(improved, unknown, guess)
        return casadi.substitute(following, unknown, guess), position + length / 2 * (x[0] + guess[0])


def phase_of_step(drive: Drive, loop: Loop | None = None) -> Any:
    """Build one phase of a step: the drive rests, or slides in one direction, until that ends or the step does.

    State: velocity, position, internal states, and how much of the step is done. Input: length of the step, each
    signal at its beginning and its end, and whether this is the step's last phase, which goes to its end. Constants:
    inertia, parameters of the model, width of rest, parameters of the loop.
    """
    import casadi

    motion = _Motion(drive, loop)
    state = casadi.SX.sym("state", 3 + motion.n_states)
    count = len(pushing_signals(drive, loop))
    inputs = casadi.SX.sym("input", 2 + 2 * count)
    constants = casadi.vertcat(motion.inertia, motion.parameters, motion.width, motion.loop_parameters)
    x, position, done = casadi.vertcat(state[0], state[2:-1]), state[1], state[-1]
    last_phase = inputs[-1] > 0
    end = [inputs[2 + 2 * i] for i in range(count)]
    begin = [inputs[1 + 2 * i] + done * (inputs[2 + 2 * i] - inputs[1 + 2 * i]) for i in range(count)]
    left = (1 - done) * inputs[0]
    goes_on = done < 1  # what the first phase has brought to the end is not computed again

    # At rest: held while neither limit is passed; ``wait`` is the share of what is left until one of them is.
    above = [motion.excess(1, position, x[1:], ends) for ends in (begin, end)]
    below = [motion.excess(-1, position, x[1:], ends) for ends in (begin, end)]
    within = casadi.logic_and(x[0] == 0, casadi.logic_and(above[0] <= 0, below[0] >= 0))
    up = above[1] > 0
    leaves = casadi.logic_or(up, below[1] < 0)
    share = casadi.if_else(up, above[0] / (above[0] - above[1]), below[0] / (below[0] - below[1]))
    at_once = casadi.logic_and(leaves, share <= _AT_ONCE)
    rests = casadi.logic_and(within, casadi.logic_not(at_once))
    wait = casadi.if_else(casadi.logic_and(leaves, casadi.logic_not(last_phase)), share, 1)
    held, _ = motion.leg(x, position, 1, wait * left, begin, end, moving=False)

    # Sliding, up to where the velocity passes zero.
    leaving_up = casadi.if_else(within, up, above[0] > 0)
    forward = casadi.if_else(x[0] == 0, leaving_up, x[0] > 0)
    direction = casadi.if_else(forward, 1, -1)
    slid, reached = motion.leg(x, position, direction, left, begin, end, moving=True)
    stops = casadi.logic_and(direction * slid[0] <= 0, left > 0)
    part = casadi.if_else(stops, x[0] / (x[0] - slid[0]), 1)
    stopped = x + part * (slid - x)
    stopped[0] = 0

    def choose(yes: Any, no: Any, otherwise: Any) -> Any:
        return casadi.if_else(rests, yes, casadi.if_else(stops, no, otherwise))

    final = [choose(held[i], stopped[i], slid[i]) for i in range(x.numel())]
    final_position = choose(position, position + part * left * x[0] / 2, reached)
    final_done = casadi.if_else(last_phase, 0, done + (1 - done) * choose(wait, part, 1))
    moved = [final[0], final_position, *final[1:], final_done]
    kept = [*(state[i] for i in range(len(moved) - 1)), casadi.if_else(last_phase, 0, done)]
    following = casadi.vertcat(*(casadi.if_else(goes_on, m, k) for m, k in zip(moved, kept, strict=True)))
    return casadi.Function("step", [state, inputs, constants], [following, following[:2]], {"cse": True})
