"""The drive's equation of motion ``J dω/dt = τ_m − τ_L − τ_F`` around a friction model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array, Mask
from fricmodels.dimension import INERTIA, Dimension, Motion, Scales
from fricmodels.errors import InputError
from fricmodels.expressions import constant_slopes
from fricmodels.kernels import ArrayFunction
from fricmodels.model import Model
from fricmodels.parameter import Parameter, check_inertia
from fricmodels.recording import Recording
from fricmodels.state_space import StateSpace

if TYPE_CHECKING:
    from fricmodels.beginning import Balance
    from fricmodels.memory import Memory

_SURELY_MOVING = 0.01
"""Share of the peak speed above which a drive does not stick."""

SHARE_OF_REST = 1e-6
"""Width of rest of a law over the peak speed."""


@dataclass(frozen=True)
class DriveParameter:
    """A coefficient that an estimator is to find: a model's, or the inertia."""

    key: str
    dimension: Dimension
    declared: Parameter
    at_least: str | None
    linear: bool


class Drive:
    """One drive: a friction model, its inertia (given, or to be estimated) and its kind of motion.

    Args:
        model: law plus effects.
        inertia: J [kg m²] or M [kg]; ``None`` to estimate it.
        motion: rotary or linear.

    Raises:
        InputError: for an inertia that is not positive and finite.
    """

    def __init__(self, model: Model, inertia: float | None = None, motion: Motion = Motion.ROTARY) -> None:
        check_inertia(inertia)
        self.model = model
        self.inertia = inertia
        self.motion = motion

    @property
    def inertia_key(self) -> str:
        """``J`` on a rotary drive, ``M`` on a linear axis."""
        return "J" if self.motion is Motion.ROTARY else "M"

    @cached_property
    def parameters(self) -> tuple[DriveParameter, ...]:
        """What is to be estimated: the inertia first, unless it is given, then the model's parameters."""
        listed = [
            DriveParameter(p.key, p.declared.dimension, p.declared, p.at_least, linear)
            for p, linear in zip(self.model.parameters, self.model.linear, strict=True)
        ]
        if self.inertia is None:
            declared = Parameter(self.inertia_key, "kg m^2", initial=1.0, lower=0.0, meaning="inertia")
            listed.insert(0, DriveParameter(self.inertia_key, INERTIA, declared, None, linear=True))
        return tuple(listed)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter by key."""
        return {p.key: p.declared.unit_for(self.motion) for p in self.parameters}

    @property
    def model_parameters(self) -> tuple[DriveParameter, ...]:
        """The model's parameters, without the inertia."""
        return self.parameters if self.inertia is not None else self.parameters[1:]

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """Keys of the estimated parameters, in order."""
        return tuple(p.key for p in self.parameters)

    def scaled(self, scales: Scales) -> Drive:
        """Return the same drive in normalised units."""
        inertia = None if self.inertia is None else self.inertia / scales.of(INERTIA)
        return Drive(self.model, inertia, self.motion)

    def restore(self, values: Sequence[float] | Array, scales: Scales) -> Array:
        """Turn estimated parameters from normalised to SI units."""
        return np.asarray(values, dtype=float) * self.parameter_scales(scales)

    def parameter_scales(self, scales: Scales) -> Array:
        """Return the SI size of one normalised unit of each estimated parameter."""
        return np.array([scales.of(p.dimension) for p in self.parameters])

    def split(self, values: Mapping[str, float]) -> tuple[float, Array]:
        """Return the inertia and the model's parameters in order, from values by key."""
        inertia = self.inertia if self.inertia is not None else values[self.inertia_key]
        return float(inertia), np.array([values[p.key] for p in self.model.parameters], dtype=float)

    def timed(self, recording: Recording, values: Mapping[str, float]) -> tuple[Recording, Mapping[str, float]]:
        """Return the recording with its torques at the time of its motion, and the values with no delay left.

        The equations of a term know a delay by its first order only; a delay that is known is taken out of the record.
        """
        delay = values.get(self.model.delay, 0.0) if self.model.delay else 0.0
        if self.model.delay is None or delay == 0.0:
            return recording, values
        return recording.retimed(delay), {**values, self.model.delay: 0.0}

    # ---- evaluation on arrays -------------------------------------------------------------------------------------

    def friction(
        self,
        recording: Recording,
        values: Mapping[str, float],
        *,
        velocity: Array | float | None = None,
        states: Sequence[Array] | None = None,
        width: float | None = None,
    ) -> Array:
        """Return the friction torque τ_F of every sample, shape (N,).

        Args:
            recording: gives the signals that the model needs.
            values: the model's parameters by key.
            velocity: replaces the recorded velocity, such as ``±tiny`` for the two ends of the sticking interval.
            states: one array for each internal state of the model; by default they are integrated along the motion.
            width: width of rest [velocity]; see :func:`fricmodels.expressions.power`.
        """
        return _at_each(self._torque_at(recording, values, velocity, states, width), recording)

    def _torque_at(
        self,
        recording: Recording,
        values: Mapping[str, float],
        velocity: Array | float | None,
        states: Sequence[Array] | None,
        width: float | None = None,
    ) -> Array:
        """Return :meth:`friction`, or its one value where it is the same at every sample."""
        given = self._signals(recording, velocity)
        _, parameters = self.split(values)
        chosen = rest_width(recording) if width is None else width
        if states is None:
            states = self.states(recording, parameters)
        return np.asarray(self._torque(*given, *parameters, *states, chosen)[0][0])

    def torque_of(
        self,
        signals: Mapping[str, ArrayLike],
        parameters: Sequence[float] | Array,
        states: Sequence[ArrayLike],
        width: float,
    ) -> Array:
        """Return the friction torque τ_F at given signals, shape (N,), or (1,) where all of them are numbers.

        Args:
            signals: a number or an array of shape (N,) of every signal that the model needs.
            parameters: of the model, in order.
            states: a number or an array of each internal state.
            width: width of rest [velocity].
        """
        given = [signals.get(name, 0.0) for name in self.model.signals]
        return np.asarray(self._torque(*given, *parameters, *states, width)[0][0])

    def states(self, recording: Recording, parameters: Sequence[float] | Array) -> tuple[Array, ...]:
        """Integrate the model's internal states along the recorded motion; empty for a model without memory.

        Of a recording that was cut from another one, they are those of the whole motion.

        Args:
            recording: gives the signals.
            parameters: the model's parameters, in order.
        """
        if not self.model.states:
            return ()
        whole, width = recording.whole(), rest_width(recording)
        balance = self.balance(whole, parameters) if self.model.beginning_unknown else None
        along = self.memory(whole, width, balance)(parameters)
        return along if recording.origin is None else tuple(state[recording.origin.index] for state in along)

    def states_moved(
        self, recording: Recording, parameters: Sequence[float] | Array, states: Sequence[Array], way: float
    ) -> tuple[Array, ...]:
        """Return the states if the drive goes a way [rad or m] within the next sampling interval, at every sample."""
        from fricmodels.memory import moved

        given = dict(zip(self.model.signals, self._signals(recording, way / recording.interval), strict=True))
        return moved(self.model, states, given, recording.interval, parameters, rest_width(recording))

    def memory(self, recording: Recording, width: float, balance: Balance | None = None) -> Memory:
        """Return what integrates the model's internal states along a motion, for whatever parameters.

        Args:
            recording: gives the signals; width: of rest [velocity].
            balance: what the torque is seen in, where first states are to be found from it.
        """
        from fricmodels.memory import Memory

        signals = dict(zip(self.model.signals, self._signals(recording, None), strict=True))
        return Memory(self.model, signals, recording.time, recording.run, width, balance)

    def balance(
        self, recording: Recording, parameters: Sequence[float] | Array, moving: Mask | None = None
    ) -> Balance | None:
        """Return what the terms without memory leave of the torque; ``None`` where the acceleration is not known.

        Args:
            recording: with ``velocity``; parameters: the model's, of which no linear one is used.
            moving: samples at which the torque is a function of the motion; those not slow by default.
        """
        from fricmodels.beginning import Balance

        if "acceleration" not in recording:
            return None
        known = Drive(self.model.without_memory(), None, self.motion)
        values = dict(zip([p.key for p in self.model.parameters], parameters, strict=True))
        columns, offset = known.regressors(recording, known.model.nonlinear_of(values))
        acceleration = recording["acceleration"]
        needed = recording.driving_torque - offset - (self.inertia or 0.0) * acceleration
        columns = columns if self.inertia else np.vstack([columns, acceleration])
        if moving is None:
            moving = np.abs(recording.velocity) > _SURELY_MOVING * recording.peak_speed
        return Balance(needed, columns, moving)

    def sticking_interval(
        self, recording: Recording, values: Mapping[str, float], *, states: Sequence[Array] | None = None
    ) -> tuple[Array, Array]:
        """Return the least and the greatest friction torque that holds the drive at rest, at each sample.

        They are the limits of the model's torque as the velocity goes to zero from below and from above. ``states`` are
        those of :meth:`friction`.
        """
        tiny = 1e-9 * rest_width(recording)
        if states is None:
            states = self.states(recording, self.split(values)[1])
        below, above = (self._torque_at(recording, values, velocity, states) for velocity in (-tiny, tiny))
        return _at_each(np.minimum(below, above), recording), _at_each(np.maximum(below, above), recording)

    def regressors(
        self, recording: Recording, nonlinear: Sequence[float] = (), *, states: Sequence[Array] | None = None
    ) -> tuple[Array, Array]:
        """Split the friction torque into its linear part: ``τ_F = A.T θ_linear + b``.

        Internal states depend on nonlinear parameters only; they are integrated along the recorded motion.

        Args:
            recording: gives the signals.
            nonlinear: values of the model parameters that are not linear, in order.
            states: one array for each internal state, where they are known.

        Returns:
            A of shape (number of linear model parameters, N) and b of shape (N,).
        """
        signals = self._signals(recording, None)
        given = iter(nonlinear)
        parameters = [0.0 if is_linear else next(given) for is_linear in self.model.linear]
        if states is None:
            states = self.states(recording, parameters)
        design, offset = self._linear_part(*signals, *nonlinear, *states, rest_width(recording))
        if design.shape[1] == len(recording):
            return design, offset[0]
        return np.broadcast_to(design, (len(design), len(recording))), np.broadcast_to(offset[0], len(recording))

    def jacobian(self, recording: Recording, values: Mapping[str, float]) -> Array:
        """Return the derivative of τ_F by each model parameter at fixed internal states, shape (parameters, N)."""
        signals = self._signals(recording, None)
        _, parameters = self.split(values)
        states = self.states(recording, parameters)
        (derivative,) = self._torque_jacobian(*signals, *parameters, *states, rest_width(recording))
        return np.broadcast_to(derivative, (len(parameters), len(recording)))

    def linearised(self, recording: Recording, values: Mapping[str, float]) -> tuple[Array, Array, Array, Array]:
        """Return τ_F of every sample and its derivatives: by velocity, by acceleration, by each model parameter.

        For a model without internal states; shapes (N,), (N,), (N,) and (parameters, N). What is not finite, as the
        slope of a root at standstill, is 0.
        """
        _, parameters = self.split(values)
        (rows,) = self._linearised(*self._signals(recording, None), *parameters, rest_width(recording))
        rows = np.broadcast_to(rows, (len(rows), len(recording)))
        if not np.isfinite(rows).all():
            rows = np.where(np.isfinite(rows), rows, 0.0)
        return rows[0], rows[1], rows[2], rows[3:]

    def _signals(self, recording: Recording, velocity: Array | float | None) -> list[Any]:
        recording.require(self.model.required, self.model.name)
        values: list[Any] = [recording.signal(name) if name in self.model.needs else 0.0 for name in self.model.signals]
        if velocity is not None:
            values[self.model.signals.index("velocity")] = velocity
        return values

    @cached_property
    def _torque(self) -> ArrayFunction:
        import casadi

        e = self.model.expression()
        given = [*e.signals.values(), e.parameters, e.states, e.width]
        return ArrayFunction(casadi.Function("torque", given, [e.torque]))

    @cached_property
    def _torque_jacobian(self) -> ArrayFunction:
        import casadi

        e = self.model.expression()
        derivative = casadi.jacobian(e.torque, e.parameters).T
        return ArrayFunction(
            casadi.Function("jacobian", [*e.signals.values(), e.parameters, e.states, e.width], [derivative])
        )

    @cached_property
    def _linearised(self) -> ArrayFunction:
        import casadi

        e = self.model.expression()
        by = casadi.vertcat(e.signals["velocity"], e.signals["acceleration"], e.parameters)
        rows = casadi.vertcat(e.torque, casadi.jacobian(e.torque, by).T)
        given = [*e.signals.values(), e.parameters, e.width]
        return ArrayFunction(casadi.Function("linearised", given, [rows], {"cse": True}))

    @cached_property
    def _linear_part(self) -> ArrayFunction:
        return ArrayFunction(self.linear_function)

    @cached_property
    def constant_derivatives(self) -> Array:
        """Constant derivatives by acceleration and motor torque of each linear column, then of the rest, (2, k)."""
        given = self.linear_function.sx_in()
        by = [given[self.model.signals.index(name)] for name in ("acceleration", "motor_torque")]
        return constant_slopes(self.linear_function(*given), by)

    @cached_property
    def linear_function(self) -> Any:
        """The linear part of τ_F as a CasADi function.

        From every signal, the nonlinear parameters, the internal states and the width of rest, to the column of
        regressors of the linear parameters and what is left without them.
        """
        import casadi

        e = self.model.expression()
        linear = [i for i, is_linear in enumerate(self.model.linear) if is_linear]
        other = [i for i, is_linear in enumerate(self.model.linear) if not is_linear]
        chosen = e.parameters[linear] if linear else casadi.SX(0, 1)
        design = casadi.jacobian(e.torque, chosen).T
        zero = casadi.SX.zeros(len(linear), 1)
        design, offset = (casadi.substitute(part, chosen, zero) for part in (design, e.torque))
        rest = e.parameters[other] if other else casadi.SX(0, 1)
        return casadi.Function("linear", [*e.signals.values(), rest, e.states, e.width], [design, offset])

    # ---- state space ----------------------------------------------------------------------------------------------

    def state_space(self) -> StateSpace:
        """Build ``dx/dt = g(x, u)``; an acceleration in the torque (an inertia error) is solved for.

        Raises:
            InputError: when the torque is not affine in the acceleration.
        """
        import casadi

        e = self.model.expression()
        inertia = casadi.SX.sym("inertia") if self.inertia is None else casadi.SX(self.inertia)
        acceleration = e.signals["acceleration"]
        slope = casadi.jacobian(e.torque, acceleration)
        if casadi.depends_on(slope, acceleration):
            raise InputError(f"'{self.model.name}' is not affine in the acceleration and cannot be simulated")
        at_zero = casadi.substitute(e.torque, acceleration, 0)
        rate_of_velocity = (e.signals["motor_torque"] - e.signals["load_torque"] - at_zero) / (inertia + slope)
        rates = casadi.substitute(e.rates, acceleration, rate_of_velocity)
        names = ("velocity", *(state.symbol for state in self.model.states))
        parameters = casadi.vertcat(inertia, e.parameters) if self.inertia is None else e.parameters
        needed = self.model.needs | {"motor_torque", "load_torque"}
        inputs = tuple(n for n in self.model.signals if n in needed and n not in ("velocity", "acceleration"))
        x = casadi.vertcat(e.signals["velocity"], e.states, parameters)
        rate = casadi.vertcat(rate_of_velocity, rates, casadi.SX.zeros(parameters.numel(), 1))
        u = casadi.vertcat(*(e.signals[name] for name in inputs))
        return StateSpace(x, u, e.width, rate, e.signals["velocity"], inputs, names)


def _at_each(values: Array, recording: Recording) -> Array:
    """Return values at each sample of a recording, where they may be one for all of them."""
    return np.full(len(recording), values[0]) if len(values) == 1 else values


def rest_width(recording: Recording) -> float:
    """Return the speed below which a drive counts as at rest for a law's slope: 1e-6 of the peak speed."""
    return SHARE_OF_REST * recording.peak_speed or 1e-9
