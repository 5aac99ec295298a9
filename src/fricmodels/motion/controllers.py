"""Controllers of a drive as they are written in YAML: the usual ones, and those that plugins bring."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, get_args

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator, model_validator

from fricmodels.documents import NotNegative, Positive
from fricmodels.errors import InputError, suggestion
from fricmodels.expressions import Expression
from fricmodels.loop import Loop
from fricmodels.parameter import Parameter, State
from fricmodels.recording import OTHER
from fricmodels.results.words import lacks
from fricmodels.term import Parameters, Signals

Kind: TypeAlias = Literal["position-gain", "pd", "speed-loop"]
_KINDS: tuple[str, ...] = get_args(Kind)


class Motor(BaseModel):
    r"""A motor under a voltage, :math:`\tau_m = \tfrac{k_t}{R}(u - k_t\omega)`: the back-EMF brakes.

    Attributes:
        torque_constant: k_t [N m/A], and of the back-EMF [V s/rad]; estimated where it is left out.
        resistance: R [Ω]; estimated where it is left out.
        supply: voltage of a duty cycle of 1 [V], a number or the channel that has it; left out, the controller gives
            volts.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    torque_constant: Positive | None = None
    resistance: Positive | None = None
    supply: Positive | str | None = None


class Controller(BaseModel):
    r"""A controller that moves a drive after a reference r.

    .. math::
        \text{position-gain: } & u = g\,(r - q) \\
        \text{pd: } & u = g\,(r - q) + d\,(\dot r - \omega) \\
        \text{speed-loop: } & u = s\,e + \tfrac{s}{T}\!\int\! e\,dt, \qquad e = g\,(r - q) + \dot r - \omega

    The output u is limited to ± ``limit`` and is a torque [N m or N]; with a ``motor`` it is a voltage, or a duty cycle
    of its supply. While u is at its limit the integral stands still.

    Attributes:
        kind: which of the three.
        reference: channel of r, such as ``other.reference``.
        reference_velocity: channel of dr/dt; zero where it is left out.
        gain: g, of position. scale: channel that g is multiplied by, such as a gain that was changed between runs.
        derivative: d, of ``pd``. speed_gain, integral_time: s and T [s], of ``speed-loop``.
        limit: of the output. enabled: channel that is 0 while the motor is switched off, and its torque zero.
        motor: what makes torque of the output.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    kind: Kind
    reference: str
    reference_velocity: str | None = None
    gain: Positive
    scale: str | None = None
    derivative: NotNegative = 0.0
    speed_gain: Positive | None = None
    integral_time: Positive | None = None
    limit: Positive | None = None
    enabled: str | None = None
    motor: Motor | None = None

    @model_validator(mode="after")
    def _belongs(self) -> Controller:
        if self.kind != "pd" and self.derivative:
            raise ValueError(f"'derivative' goes with kind: pd, not with {self.kind}")
        if self.kind == "speed-loop" and self.speed_gain is None:
            raise ValueError("kind: speed-loop needs 'speed_gain'")
        for key in ("speed_gain", "integral_time"):
            if self.kind != "speed-loop" and getattr(self, key) is not None:
                raise ValueError(f"'{key}' goes with kind: speed-loop, not with {self.kind}")
        return self

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels of a recording that it follows, each a further one."""
        supply = self.motor.supply if self.motor is not None and isinstance(self.motor.supply, str) else None
        named = [self.reference, self.reference_velocity, self.scale, self.enabled, supply]
        return tuple(dict.fromkeys(_channel(name) for name in named if name is not None))

    def loop(self) -> Loop:
        """Return what drives a simulation with it."""
        kind = _Integrating if self.integral_time is not None else _Controlled
        if self.motor is not None:
            kind = _VoltageIntegrating if self.integral_time is not None else _Voltage
        return kind(self)


def _channel(name: str) -> str:
    return name if name.startswith(OTHER) else f"{OTHER}{name}"


class PluginController(BaseModel):
    """A controller that a plugin brings, by its name.

    Attributes:
        kind: under which it is registered.
        values: of its parameters that are known, by symbol; the others are estimated.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    kind: str
    values: dict[str, Annotated[float, Field(allow_inf_nan=False)]] = Field(default_factory=dict)

    @field_validator("kind")
    @classmethod
    def _registered(cls, kind: str) -> str:
        try:
            _brought(kind)
        except InputError as error:
            raise ValueError(str(error)) from None
        return kind

    @model_validator(mode="after")
    def _has_them(self) -> PluginController:
        try:
            self.loop()
        except InputError as error:
            raise ValueError(str(error)) from None
        return self

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels of a recording that it follows."""
        return tuple(name for name in self.loop().channels if name.startswith(OTHER))

    def loop(self) -> Loop:
        """Return what drives a simulation with it.

        Raises:
            InputError: where no plugin has it, or it has no such parameter.
        """
        return _brought(self.kind)(**self.values)


def _brought(kind: str) -> type[Loop]:
    """Return the class of a controller that a plugin brings."""
    from fricmodels import plugins

    registry = plugins.load().controllers
    if kind not in registry:
        known = (*_KINDS, *registry.names)
        try:
            registry.entry(kind)
        except plugins.LeftOut:
            raise
        except InputError:
            raise InputError(f"unknown kind of controller '{kind}'{suggestion(kind, known)}") from None
    found: type[Loop] = registry[kind]
    return found


def _which(given: Any) -> str:
    """Say whether a controller is one of the usual ones; one without a kind is taken for one of them."""
    kind = given.get("kind") if isinstance(given, Mapping) else getattr(given, "kind", None)
    return "usual" if kind is None or kind in _KINDS else "plugin"


AnyController: TypeAlias = Annotated[
    Annotated[Controller, Tag("usual")] | Annotated[PluginController, Tag("plugin")], Discriminator(_which)
]
"""A usual controller, or one that a plugin brings; ``kind`` says which."""


def read_controller(path: str | Path) -> Controller | PluginController:
    """Read a controller from a YAML file.

    Raises:
        InputError: in one line, naming file, line and key.
    """
    from fricmodels.documents import read_yaml, validate

    document = read_yaml(path)
    if _which(document.content) == "plugin":
        try:
            _brought(str(document.content["kind"]))
        except InputError as error:
            raise document.error(("kind",), str(error)) from None
        return validate(document, PluginController)
    return validate(document, Controller)


def stored_controller(given: Mapping[str, Any]) -> Controller | PluginController:
    """Return a controller from what :meth:`pydantic.BaseModel.model_dump` made of it.

    Raises:
        InputError: where it is none that is known here.
    """
    from pydantic import ValidationError

    from fricmodels.documents import first_problem

    kind: type[Controller] | type[PluginController] = Controller if _which(given) == "usual" else PluginController
    try:
        return kind.model_validate(given)
    except ValidationError as error:
        raise InputError(f"the controller: {first_problem(error, kind)}") from None


class _Controlled(Loop):
    """A controller whose output is a torque."""

    name = "controller"

    def __init__(self, controller: Controller) -> None:
        motor = controller.motor
        given = {} if motor is None else {"k_t": motor.torque_constant, "R": motor.resistance}
        super().__init__(**{key: value for key, value in given.items() if value is not None})
        self.controller = controller
        self.name = f"{controller.kind} controller"
        self.channels = controller.channels

    def motor_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the output."""
        return self._switched(s, self._limited(self._wanted(s)))

    def _error(self, s: Signals) -> tuple[Expression, Expression]:
        """Return the position's share of the output and the error of the velocity."""
        own = self.controller
        gain = own.gain * (1 if own.scale is None else s[_channel(own.scale)])
        rate = 0 if own.reference_velocity is None else s[_channel(own.reference_velocity)]
        return gain * (s[_channel(own.reference)] - s.position), rate - s.velocity

    def _wanted(self, s: Signals) -> Expression:
        """Return the output without its limit."""
        own = self.controller
        position, speed = self._error(s)
        if own.speed_gain is None:
            return position + own.derivative * speed
        return own.speed_gain * (position + speed)

    def _limited(self, output: Expression) -> Expression:
        import casadi

        limit = self.controller.limit
        return output if limit is None else casadi.fmax(-limit, casadi.fmin(limit, output))

    def _switched(self, s: Signals, torque: Expression) -> Expression:
        enabled = self.controller.enabled
        return torque if enabled is None else torque * s[_channel(enabled)]


class _Integrating(_Controlled):
    """A speed loop with an integral."""

    z = State("z", meaning="output of the integral")

    def _wanted(self, s: Signals) -> Expression:
        return super()._wanted(s) + s.z

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the rate of the integral, none at the limit."""
        import casadi

        own = self.controller
        rate = super()._wanted(s) / own.integral_time
        output = self._wanted(s)
        return {"z": rate if own.limit is None else casadi.if_else(casadi.fabs(output) < own.limit, rate, 0)}


class _MotorConstants(Loop):
    """The constants of a motor under a voltage."""

    k_t = Parameter("k_t", unit="N m", initial=0.1, lower=1e-9, meaning="torque constant [N m/A]")
    R = Parameter("R", initial=1.0, lower=1e-9, meaning="resistance [Ω]")

    def motor_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the motor torque under a voltage."""
        raise NotImplementedError


class _Voltage(_Controlled, _MotorConstants):
    """A controller whose output is a voltage."""

    parameters = _MotorConstants.parameters

    def motor_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return k_t/R (u − k_t ω)."""
        motor = self.controller.motor
        supply: Any = 1 if motor is None or motor.supply is None else motor.supply
        supply = s[_channel(supply)] if isinstance(supply, str) else supply
        volts = supply * self._limited(self._wanted(s))
        return self._switched(s, p.k_t / p.R * (volts - p.k_t * s.velocity))


class _VoltageIntegrating(_Voltage, _Integrating):
    """A speed loop with an integral whose output is a voltage."""

    parameters = _MotorConstants.parameters
    states = _Integrating.states


def check_controller(controller: Controller | PluginController, channels: frozenset[str], name: str) -> None:
    """Refuse a controller whose channels a recording does not have.

    Raises:
        InputError: naming the channel, and how to map it.
    """
    for channel in controller.channels:
        if channel not in channels:
            raise InputError(f"the controller follows the channel '{channel}', {lacks(channel, name)}")
