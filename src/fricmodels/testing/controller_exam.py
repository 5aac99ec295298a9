"""The exam of controllers: what a :class:`fricmodels.loop.Loop` says is an expression, and drives a simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.loop import PREFIX, Loop, closed
from fricmodels.model import Model
from fricmodels.motion import Simulator
from fricmodels.recording import OTHER, Recording
from fricmodels.testing.declared import Declared
from fricmodels.testing.exam import check_registered
from fricmodels.testing.faults import Fault

_OWN = ("time", "temperature")
_SAMPLES, _INTERVAL = 400, 2e-3


class ControllerExam(Declared):
    """The exam of a controller::

        class TestMyController(ControllerExam):
            controller = MyController

    Attributes:
        controller: the class that sits the exam.
        inertia: of the drive that it moves [kg m²].
        channels: for each channel that it follows a function of time (an array in, an array out) or a number; a sine
            of 1 rad at 0.5 Hz where none is given.

    The last two may also stand in the class, ``exam = {"inertia": 0.01, "channels": {"other.gain": 400.0}}``; then they
    count for ``fricmodels check`` as well.
    """

    of, _may_say = "controller", ("inertia", "channels")
    kind: ClassVar[str] = "controller"
    controller: ClassVar[type[Loop]]
    inertia: ClassVar[float] = 0.01
    channels: ClassVar[Mapping[str, Callable[[Array], Array] | float]] = {}

    def test_declaration(self) -> None:
        """Name, docstring, channels, and what its parameters mean."""
        cls = self.controller
        if not cls.name or cls.name != cls.name.lower() or " " in cls.name:
            raise Fault(f"name is {cls.name!r}; write it in lower case with hyphens, such as 'my-servo'")
        if not (cls.__doc__ or "").strip():
            raise Fault(f"{cls.__name__} has no docstring; write its law there")
        for channel in cls.channels:
            if not channel.startswith(OTHER) and channel not in _OWN:
                raise Fault(f"the channel {channel!r} is none of a recording; write '{OTHER}{channel}'")
        for p in cls.parameters:
            if not p.meaning:
                raise Fault(f"the parameter '{p.symbol}' has no meaning; say in words what it is")
            if not p.lower <= p.initial <= p.upper:
                raise Fault(f"the initial value {p.initial:g} of '{p.symbol}' is not between its bounds")

    def test_registered(self) -> None:
        """Found by the plugin manager."""
        check_registered(self.kind, self.controller)

    def test_torque_is_an_expression(self) -> None:
        """One scalar each of motor torque, load and rates, of the declared channels alone."""
        self._said()

    def test_parameters_matter(self) -> None:
        """No parameter and no channel is idle."""
        import casadi

        said = self._said()
        everything = casadi.vertcat(*said.torques.values(), said.rates)
        for i, p in enumerate(self.controller.parameters):
            if not casadi.depends_on(everything, said.parameters[i]):
                raise Fault(f"the parameter '{p.symbol}' changes nothing; use it, or leave it out")
        for channel, symbol in said.given.items():
            if not casadi.depends_on(everything, symbol):
                raise Fault(f"the channel '{channel}' changes nothing; use it, or leave it out of channels")

    def test_drives_a_simulation(self) -> None:
        """Through the compiled loop the motion stays a number, and is the same every time."""
        loop, recording = self.controller(), self._recording()
        simulator = Simulator(Drive(Model.parse("coulomb-viscous"), self.inertia), recording, loop=loop)
        values = {"K_v": 0.05, "K_c": 0.02, **dict(zip(loop.keys, (p.initial for p in loop.parameters), strict=True))}
        first, second = simulator(values), simulator(values)
        for name, own, again in zip(("position", "velocity"), first, second, strict=True):
            if not np.all(np.isfinite(own)):
                end = float(recording.time[int(np.argmin(np.isfinite(own)))])
                raise Fault(
                    f"the {name} is no number from {end:.3g} s on, with the initial values of its parameters; choose "
                    f"some that hold a drive of {self.inertia:g} kg m², or say in exam what it moves and follows"
                )
            if not np.array_equal(own, again):
                raise Fault(f"the {name} is another at the second call; an expression depends on its arguments alone")

    def test_values_may_be_given(self) -> None:
        """Each parameter can be fixed, and the others are left to be found."""
        for p in self.controller.parameters:
            try:
                loop = self.controller(**{p.symbol: p.initial})
            except Exception as error:
                raise Fault(
                    f"{self.controller.__name__}({p.symbol}={p.initial:g}) raises {type(error).__name__}: {error}; "
                    f"call super().__init__(**fixed)"
                ) from None
            if p in loop.free:
                raise Fault(f"{p.symbol} was given and is not fixed; call super().__init__(**fixed)")
            if f"{PREFIX}{p.symbol}" not in loop.keys:
                raise Fault(f"{p.symbol} is not among its keys; declare it in the class body")

    def _said(self) -> Any:
        """Return what it says, as expressions."""
        import casadi

        try:
            said = closed(self.controller(), Model.parse("coulomb-viscous").expression().signals)
        except Exception as error:
            text = " ".join(str(error).split())
            raise Fault(
                f"motor_torque(), load_torque() or rates() raises {type(error).__name__}: {text}; use s.velocity, "
                f"s.position, s['{OTHER}NAME'] of its channels, p.SYMBOL and fricmodels.expressions"
            ) from None
        for name, value in said.torques.items():
            if not isinstance(value, casadi.SX) or value.shape != (1, 1):
                raise Fault(f"{name}() returns no scalar; return one expression, the torque at one instant")
        return said

    def _recording(self) -> Recording:
        time: Array = np.arange(_SAMPLES, dtype=np.float64) * _INTERVAL
        channels: dict[str, Array] = {"time": time}
        channels |= {name: np.zeros(_SAMPLES) for name in ("torque", "position", "velocity")}
        for name in set(self.controller.channels) - set(channels):
            given: Any = self.channels.get(name, _sine)
            channels[name] = np.full(_SAMPLES, given(time) if callable(given) else given, dtype=float)
        run = np.zeros(_SAMPLES, dtype=np.int64)
        return Recording("exam", Motion.ROTARY, channels, run)


def _sine(time: Array) -> Array:
    return np.asarray(np.sin(np.pi * time))
