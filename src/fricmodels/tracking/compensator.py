r"""A model as a compensation that runs beside a controller: one expression for the reference and for the loop.

The motor torque is to be :math:`\tau_m = J_0\,a + \tau_L + c`, with the stated inertia :math:`J_0`, and has to satisfy
the model's equation :math:`\tau_m = J a + \tau_L + \tau_F(\omega, q, a, \tau_m, \dots)`. With
:math:`b = J_0 a + \tau_L` and :math:`\tau_F` affine in the motor torque (a gain error, a ripple of commutation),
:math:`\tau_F = \tau_0 + s\,\tau_m`,

.. math:: c = \frac{\tau_0 + (J - J_0)\,a + s\,b}{1 - s},

taken on both sides of zero velocity and weighted by the direction, as
:meth:`fricmodels.FittedModel.compensation` does. Internal states go on from sample to sample as in
:class:`fricmodels.memory.MemoryStep`. While nothing is to move, nine tenths are held of what they carry to either side:
a bent contact carries as much as it can, and with the least error of the model the whole would push the drive on.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from functools import lru_cache
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.kernels import Callback, Scan
from fricmodels.memory import memory_step
from fricmodels.model import Model

AtRest: TypeAlias = Literal["none", "reference", "smooth"]
SIGNALS = ("velocity", "position", "acceleration", "load_torque", "temperature", "time")
"""What a controller knows at every sample. A delay of a record is no friction, and the torque is solved for."""
_SOLVED = ("motor_torque", "motor_torque_rate")
_TINY = 1e-9
HELD = 0.9
"""Share that is held at rest of what bent contacts carry: a model that is right to a tenth does not push them on."""
_LEAST = 0.1
"""Least share of the motor torque that a model may leave to reach the shaft; it bounds the division."""
FIRST = 3
"""Place of the first signal in a row: before it stand interval, feed-forward without friction, direction wanted."""


class Compensator:
    """A model's compensation, sample by sample.

    Args:
        drive: the model; its inertia is used where it is known.
        values: parameters by key, SI.
        width: width of rest of the model [rad/s or m/s].
        at_rest: as of :meth:`fricmodels.FittedModel.compensation`.
        turn: the speed that counts as rest, or within which ``smooth`` turns over; the width of rest if not given.
        stated: J_0, the inertia in the feed-forward; the model's own if not given.

    Raises:
        InputError: for a model that needs a channel which a controller does not have.
    """

    def __init__(
        self,
        drive: Drive,
        values: Mapping[str, float],
        width: float,
        *,
        at_rest: AtRest = "none",
        turn: float | None = None,
        stated: float | None = None,
    ) -> None:
        self.drive, self.at_rest = drive, at_rest
        missing = sorted(name for name in drive.model.required if name not in (*SIGNALS, *_SOLVED))
        if missing:
            raise InputError(f"'{drive.model.name}' needs '{missing[0]}', which a controller does not have")
        self._scan, self._callback = _compiled(drive.model, at_rest)
        inertia, parameters = drive.split(values)
        more = 0.0 if stated is None else inertia - stated
        self.constants = np.array([*parameters, width, width if turn is None else turn, more, 1.0], dtype=float)
        self.memory = np.zeros(self._scan.n_states)

    @property
    def pointer(self) -> Any:
        """Address of a step, for :class:`fricmodels.rig.closed_loop.InLoop`."""
        return self._callback.pointer

    def times(self, factor: float) -> Compensator:
        """Return the compensation multiplied by a factor: what a model does that is wrong by it."""
        other = copy(self)
        other.constants = self.constants.copy()
        other.constants[-1] = factor
        return other

    def rows(self, interval: float, base: Array, direction: ArrayLike, signals: Mapping[str, ArrayLike]) -> Array:
        """Return what a step takes at each sample, shape (N, 9).

        Args:
            interval: between samples [s].
            base: feed-forward without friction, J_0 a + τ_L, shape (N,).
            direction: the velocity that is wanted, or anything of its sign.
            signals: of :data:`SIGNALS`; what is not given is 0.
        """
        rows = np.zeros((len(base), FIRST + len(SIGNALS)))
        rows[:, 0], rows[:, 1], rows[:, 2] = interval, base, np.sign(direction)
        for name, values in signals.items():
            rows[:, FIRST + SIGNALS.index(name)] = values
        return rows

    def along(self, rows: Array) -> Array:
        """Return the compensation at each sample of a motion that is known beforehand, shape (N,).

        Raises:
            InputError: where it does not stay a number.
        """
        _, outputs, done = self._scan(self.memory, rows, self.constants)
        if done < len(rows) or not np.all(np.isfinite(outputs)):
            raise InputError(f"the compensation by '{self.drive.model.name}' is no number along this motion")
        return np.asarray(outputs[:, 0])


def place(signal: str) -> int:
    """Return the place of a signal in a row."""
    return FIRST + SIGNALS.index(signal)


@lru_cache(maxsize=64)
def _compiled(model: Model, at_rest: AtRest) -> tuple[Scan, Callback]:
    step = compensation_step(model, at_rest)
    return Scan(step), Callback(step)


def compensation_step(model: Model, at_rest: AtRest) -> Any:
    """Build a step as a CasADi function for :class:`Scan` and :class:`Callback`.

    State: the internal states, the signals that the model needs at the last sample, and whether there was one.
    Input: a row, see :meth:`Compensator.rows`. Constant: ``[parameters; width of rest; turn; J − J_0; factor]``.
    Output: the compensation.
    """
    import casadi

    e = model.expression()
    needed = [name for name in model.signals if name in model.needs]
    count, n = e.states.numel(), len(needed)
    state = casadi.SX.sym("state", count + n + 1)
    row = casadi.SX.sym("row", FIRST + len(SIGNALS))
    turn, more, factor = (casadi.SX.sym(name) for name in ("turn", "more", "factor"))
    constants = casadi.vertcat(e.parameters, e.width, turn, more, factor)
    base, wanted = row[1], row[2]
    before = state[count : count + n]
    known = {name: row[place(name)] for name in SIGNALS}
    begun = state[-1] > 0
    velocity = known["velocity"]

    now = [known.get(name, before[i] if name == "motor_torque" else casadi.SX(0)) for i, name in enumerate(needed)]
    if count:
        last = [casadi.if_else(begun, before[i], now[i]) for i in range(n)]
        interval = casadi.if_else(begun, row[0], 1)
        given = casadi.vertcat(interval, *last, *now)
        moved = memory_step(model)(state[:count], given, casadi.vertcat(e.parameters, e.width))[0]
        initial = casadi.DM([float(s.initial) for s in model.states])
        states = casadi.if_else(begun, moved, initial)
    else:
        states = state[:0]

    symbols = casadi.vertcat(*e.signals.values(), e.states)
    slope_by_motor = casadi.jacobian(e.torque, e.signals["motor_torque"])

    if at_rest == "smooth":
        resting, direction = casadi.SX(0), casadi.tanh(velocity / turn)
    else:
        slow, asked = casadi.fabs(velocity) <= turn, wanted if at_rest == "reference" else casadi.SX(0)
        resting = casadi.logic_and(slow, asked == 0)
        direction = casadi.if_else(slow, asked, casadi.sign(velocity))

    def side(speed: Any, at_states: Any) -> Any:
        own = {**known, "velocity": speed, "motor_torque": casadi.SX(0)}
        at = casadi.vertcat(*(own.get(name, casadi.SX(0)) for name in e.signals), at_states)
        alone = casadi.substitute(e.torque, symbols, at)
        slope = casadi.fmin(casadi.substitute(slope_by_motor, symbols, at), 1 - _LEAST)
        return (alone + more * known["acceleration"] + slope * base) / (1 - slope)

    tiny = _TINY * e.width
    forward, backward = casadi.fmax(velocity, tiny), casadi.fmin(velocity, -tiny)
    above, below = side(forward, states), side(backward, states)
    torque = (above * (1 + direction) + below * (1 - direction)) / 2
    if count:  # at rest
        free = side(forward, initial), side(backward, initial)
        carried = above - free[0], below - free[1]
        least = casadi.fmin(casadi.fabs(carried[0]), casadi.fabs(carried[1]))
        alike = casadi.sign(carried[0]) + casadi.sign(carried[1])
        torque = casadi.if_else(resting, (free[0] + free[1] + HELD * alike * least) / 2, torque)
    compensation = factor * torque
    kept = [base + compensation if name == "motor_torque" else now[i] for i, name in enumerate(needed)]
    following = casadi.vertcat(states, *kept, 1)
    return casadi.Function("compensation", [state, row, constants], [following, compensation], {"cse": True})
