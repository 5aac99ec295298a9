"""The pendulum bench of the source: a servo swings a mass, and a law is judged by the position that it simulates."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels.kernels import Scan
from fricmodels.model import Model
from fricmodels_bam.m1 import CoulombViscous

Array: TypeAlias = NDArray[np.float64]

MASS, LENGTH, GRAVITY = 0.49, 0.10, 9.80665
"""Of the pendulum [kg, m, m/s²]."""
CONTROL_GAIN = 4096 / (2 * math.pi) / (256 * 885)
"""Duty cycle per position error [rad] and proportional gain in the firmware of the servo."""
STEP = 0.005
"""Step of the source's simulation [s]."""
MOTOR = ("k_t", "R", "armature", "q_offset")
"""What is identified beside the friction: torque constant [N m/A], resistance [Ω], armature [kg m²], offset [rad]."""
_INPUTS = ("goal", "enabled", "gain", "supply")
_WIDTH = 1e-9
"""Width of rest [rad/s]."""


@dataclass(frozen=True)
class Log:
    """One recording on an even grid of :data:`STEP`.

    Attributes:
        trajectory: name of the motion.
        gain: proportional gain of the position controller.
        position: measured [rad], shape (N,).
        speed: the first one [rad/s].
        inputs: goal position [rad], whether the motor is switched on, gain and supply voltage [V], shape (N, 4).
    """

    trajectory: str
    gain: int
    position: Array
    speed: float
    inputs: Array


def read_logs(path: Path) -> list[Log]:
    """Read the logs of the bench, interpolated to an even grid as the source does.

    Args:
        path: comma-separated file with the columns log, trajectory, kp, t, pos_rad, vel_rads, vin_V, torque_enable
            and goal_pos_rad.
    """
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    logs = []
    for name in np.unique(table["log"]):
        rows = table[table["log"] == name]
        time = rows["t"].astype(float)
        grid = np.arange(time[0], time[-1], STEP)
        columns = [np.interp(grid, time, rows[key]) for key in ("goal_pos_rad", "torque_enable", "vin_V", "pos_rad")]
        goal, enabled, supply, position = columns
        gain = int(rows["kp"][0])
        inputs = np.column_stack([goal, enabled > 0.5, np.full_like(goal, gain), supply])
        logs.append(Log(str(rows["trajectory"][0]), gain, position, float(rows["vel_rads"][0]), inputs))
    return logs


class Bench:
    r"""The source's simulation of the bench with one of its laws.

    .. math:: (m l^2 + J_a)\,\dot\omega = \frac{k_t}{R}(V - k_t\omega) - m g l\sin(q + q_0) - \tau_F

    with the voltage from the position controller of the servo's firmware, explicit steps of :data:`STEP`, and a
    friction that at most stops the pendulum within the step.

    Args:
        law: one of M1 to M6.
    """

    def __init__(self, law: type[CoulombViscous]) -> None:
        self.law = law
        self.model = Model(law())
        self.keys = (*MOTOR, *(p.key for p in self.model.parameters))

    @cached_property
    def _scan(self) -> Scan:
        import casadi

        state, inputs = casadi.SX.sym("state", 2), casadi.SX.sym("inputs", len(_INPUTS))
        constants = casadi.SX.sym("constants", len(self.keys))
        position, velocity = casadi.vertsplit(state)
        goal, enabled, gain, supply = casadi.vertsplit(inputs)
        k_t, resistance, armature, offset = casadi.vertsplit(constants[: len(MOTOR)])
        duty = casadi.fmax(-1, casadi.fmin(1, CONTROL_GAIN * gain * (goal - position)))
        motor = enabled * k_t / resistance * (supply * duty - k_t * velocity)
        load = MASS * GRAVITY * LENGTH * casadi.sin(position + offset)
        inertia = MASS * LENGTH**2 + armature
        friction = self._magnitude(casadi.fabs(velocity), motor, load, constants[len(MOTOR) :])
        stopping = inertia / STEP * velocity + motor - load
        net = motor - load - casadi.sign(stopping) * casadi.fmin(casadi.fabs(stopping), friction)
        acceleration = net / inertia
        faster = velocity + STEP * acceleration
        moved = position + STEP * faster + STEP**2 / 2 * acceleration
        return Scan(casadi.Function("bench", [state, inputs, constants], [casadi.vertcat(moved, faster), position]))

    def _magnitude(self, speed: Any, motor: Any, load: Any, parameters: Any) -> Any:
        """Return the law's torque at a speed, as an expression."""
        import casadi

        e = self.model.expression()
        given = {"velocity": speed, "motor_torque": motor, "load_torque": load}
        old = casadi.vertcat(*(e.signals[name] for name in given), e.parameters, e.width)
        return casadi.substitute(e.torque, old, casadi.vertcat(*given.values(), parameters, _WIDTH))

    def positions(self, log: Log, values: Mapping[str, float]) -> Array:
        """Return the simulated position [rad] at every step of a log, shape (N,).

        Args:
            log: gives the start, the goals and the supply voltage.
            values: those of :attr:`keys`.
        """
        start = [log.position[0], log.speed]
        _, outputs, _ = self._scan(start, log.inputs, [values[key] for key in self.keys])
        return outputs[:, 0]

    def error(self, logs: Sequence[Log], values: Mapping[str, float]) -> float:
        """Return the mean absolute error of the simulated position [rad] over all logs."""
        return float(np.mean(np.concatenate([np.abs(self.positions(log, values) - log.position) for log in logs])))
