"""What drives a drive in a simulation: a controller, a motor with back-EMF, a load that depends on the position.

Without one, the recorded torques are what pushes (open loop). A :class:`Loop` says them as expressions of the simulated
motion instead (closed loop); like a law it is written once, and all that simulates is compiled from it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from fricmodels.errors import InputError
from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter, State
from fricmodels.term import Parameters, Signals

PREFIX = "loop."
"""What the keys of a loop's parameters begin with, beside those of the model."""


class Loop(ABC):
    r"""What pushes a simulated drive, :math:`\tau_m` and :math:`\tau_L`, as it depends on the motion.

    A subclass declares parameters and states as a term does, names the channels of the recording that it follows (a
    reference, a supply voltage), and writes :meth:`motor_torque`. It may use ``s.velocity``, ``s.position``, ``s.time``
    and its channels; within a sampling interval the channels run straight from sample to sample.

    Attributes:
        name: in messages.
        parameters, states: collected from the class body, in order of declaration.
        channels: of the recording, such as ``other.reference``.
        load: whether it says the load torque too; where it does not, the recorded one acts.
        fixed: values of parameters that are known and not fitted, by symbol.
    """

    name: str = "loop"
    parameters: tuple[Parameter, ...] = ()
    states: ClassVar[tuple[State, ...]] = ()
    channels: tuple[str, ...] = ()
    load: ClassVar[bool] = False
    fixed: Mapping[str, float]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.parameters = (*cls.parameters, *(v for v in vars(cls).values() if isinstance(v, Parameter)))
        cls.states = (*cls.states, *(v for v in vars(cls).values() if isinstance(v, State)))

    def __init__(self, **fixed: float) -> None:
        unknown = set(fixed) - {p.symbol for p in self.parameters}
        if unknown:
            known = ", ".join(p.symbol for p in self.parameters) or "none"
            raise InputError(f"'{self.name}' has no parameter '{min(unknown)}'; it has {known}")
        self.fixed = dict(fixed)

    @abstractmethod
    def motor_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the motor torque [N m] or force [N]."""

    def load_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the load torque that the motor has to overcome [N m or N], where :attr:`load` says that it does."""
        return s.load_torque

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return d/dt of each declared state, by symbol."""
        return {}

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The parameters that are to be found."""
        return tuple(p for p in self.parameters if p.symbol not in self.fixed)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of all its parameters, as they stand beside those of a model: ``loop.k_t``."""
        return tuple(f"{PREFIX}{p.symbol}" for p in self.parameters)

    def values(self, given: Mapping[str, float]) -> list[float]:
        """Return its parameters in order: the fixed ones, and the others from values by key.

        Raises:
            InputError: naming the first that has none.
        """
        listed = []
        for p, key in zip(self.parameters, self.keys, strict=True):
            if p.symbol not in self.fixed and key not in given:
                raise InputError(f"'{self.name}' needs a value for '{key}'")
            listed.append(float(self.fixed.get(p.symbol, given.get(key, p.initial))))
        return listed


@dataclass(frozen=True)
class Closed:
    """A loop as expressions.

    Attributes:
        torques: expression of each signal that the loop says. given: symbol of each channel. parameters: of the loop.
        states, rates: its own.
    """

    torques: Mapping[str, Any]
    given: Mapping[str, Any]
    parameters: Any
    states: Any
    rates: Any


def closed(loop: Loop, signals: Mapping[str, Any]) -> Closed:
    """Return what a loop says, in the symbols of a model's signals.

    Args:
        loop: the loop. signals: symbols of the model's signals, by name.

    Raises:
        InputError: where it uses its own motor torque, or the acceleration.
    """
    import casadi

    given = {name: casadi.SX.sym(name.replace(".", "_")) for name in loop.channels}
    symbols = {p.symbol: casadi.SX.sym(f"loop_{p.symbol}") for p in loop.parameters}
    states = {z.symbol: casadi.SX.sym(f"loop_{z.symbol}") for z in loop.states}
    names = ("velocity", "position", "time", "load_torque", "temperature")
    seen = Signals({**{name: signals[name] for name in names}, **given}, states)
    values = Parameters(symbols)
    torques = {"motor_torque": casadi.SX(loop.motor_torque(seen, values))}
    if loop.load:
        torques["load_torque"] = casadi.SX(loop.load_torque(seen, values))
        if casadi.depends_on(torques["load_torque"], signals["load_torque"]):
            raise InputError(f"'{loop.name}' says the load torque, and must not use the recorded one for it")
        torques["motor_torque"] = casadi.substitute(
            torques["motor_torque"], signals["load_torque"], torques["load_torque"]
        )
    rates = loop.rates(seen, values)
    missing = set(states) - set(rates)
    if missing:
        raise InputError(f"'{loop.name}' declares the state '{min(missing)}' and gives no rate for it")
    return Closed(
        torques,
        given,
        casadi.vertcat(*symbols.values()),
        casadi.vertcat(*states.values()),
        casadi.vertcat(*(rates[name] for name in states)),
    )
