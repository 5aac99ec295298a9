"""The simulated drive under a digital controller: sampled, late, and with an encoder that counts.

At sample k the controller reads the encoder, :math:`\\hat q_k = \\Delta\\,\\mathrm{round}(q(t_k)/\\Delta)`. With the
low-passed difference :math:`D x_k = D x_{k-1} + s\\,[(x_k - x_{k-1})/h - D x_{k-1}]` its torque

.. math:: u_k = f_k + c(\\hat q_k, D\\hat q_k) + K_p\\,e_k + K_d\\,D e_k, \\qquad e_k = r_k - \\hat q_k

is limited, and acts from :math:`t_k + T` on, held for an interval h: f is the feed-forward, r the reference, c a
compensation that is computed in the loop. Between the instants the drive is that of :mod:`fricmodels.rig.motion`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.rig.motion import _past, advance
from fricmodels.rig.physics import compiled, known_load, slow_factors

if TYPE_CHECKING:
    from fricmodels.rig.rig import Rig


@dataclass(frozen=True)
class Control:
    """What a controller is, in SI units.

    Attributes:
        interval: h [s]. delay: T, from reading the encoder to the torque [s].
        proportional, derivative: K_p [N m/rad] and K_d [N m s/rad].
        smoothing: s, the share of a new difference in D, 0 to 1.
        encoder_step: Δ [rad or m]; 0 for a perfect encoder.
    """

    interval: float
    delay: float
    proportional: float
    derivative: float
    smoothing: float = 1.0
    encoder_step: float = 0.0


@dataclass(frozen=True)
class InLoop:
    """A compensation that the controller computes from what it measures.

    Attributes:
        function: pointer to compiled ``(memory, row, constants, result)``; see :class:`fricmodels.kernels.Callback`.
        rows: what it is given at each sample, shape (N, m); the measured velocity and position are put in.
        velocity, position: their places in a row, −1 where it does not take one.
        memory: before the first sample. constants: of the function.
    """

    function: Any
    rows: Array
    velocity: int
    position: int
    memory: Array
    constants: Array


@dataclass(frozen=True)
class Driven:
    """A run under a controller, at its samples: true position and velocity, and the torque asked."""

    position: Array
    velocity: Array
    torque: Array


def closed_loop(
    rig: Rig,
    control: Control,
    reference: Array,
    feedforward: Array,
    load: Array,
    in_loop: InLoop,
    *,
    active: bool = True,
    origin: float = 0.0,
) -> Driven:
    """Run the drive along a reference.

    Args:
        rig: the drive; its excitation and its sensors take no part.
        control: the controller.
        reference: position that is wanted at each sample, shape (N,). The drive starts there, at rest.
        feedforward: f at each sample, shape (N,), which acts a delay later.
        load: load torque put on from outside at each sample, shape (N,).
        in_loop: c; left out where it is not ``active``.
        origin: time of the first sample, on the clock by which the drive warms and drifts [s].
    """
    substeps = rig.model_copy(update={"rate": 1 / control.interval})._steps(rig._physics())
    count = len(feedforward)
    torque, velocity, position = feedforward.astype(float), np.zeros(count), np.zeros(count)
    follow(
        rig._physics(),
        torque,
        np.ascontiguousarray(reference),
        np.ascontiguousarray(load),
        control.interval,
        substeps,
        round(control.delay / control.interval * substeps),
        control.proportional,
        control.derivative,
        control.smoothing,
        control.encoder_step,
        origin,
        in_loop.function,
        active,
        np.ascontiguousarray(in_loop.rows),
        in_loop.velocity,
        in_loop.position,
        in_loop.memory.copy(),
        in_loop.constants,
        np.zeros(count * substeps),
        position,
        velocity,
    )
    return Driven(position, velocity, torque)


@compiled
def counted(position: float, step: float) -> float:
    """Return a position as an encoder shows it, to the nearest count."""
    return math.floor(position / step + 0.5) * step if step > 0.0 else position


@compiled
def follow(
    p: Any,
    torque: Any,
    reference: Any,
    load: Any,
    interval: float,
    substeps: int,
    late: int,
    proportional: float,
    derivative: float,
    smoothing: float,
    encoder_step: float,
    origin: float,
    function: Any,
    active: bool,
    rows: Any,
    velocity_place: int,
    position_place: int,
    memory: Any,
    constants: Any,
    fine_velocity: Any,
    position: Any,
    velocity: Any,
) -> None:
    """Run the loop; see :func:`closed_loop`. ``torque`` holds the feed-forward, and then all that was asked for.

    ``late`` is the delay in sub-steps. The last three are filled: every sub-step's velocity, and the true motion.
    """
    n = torque.shape[0]
    step = interval / substeps
    behind = p.lag / step
    whole, part = late // substeps, late % substeps
    x = (reference[0], 0.0, reference[0], 0.0, 0.0)
    s1, s2, dwell = 0.0, 0.0, 0.0
    z = (0.0, 0.0, 0.0, 0.0)
    result = np.zeros(1)
    before = counted(x[0], encoder_step)
    error_before = reference[0] - before
    smooth, rate = 0.0, 0.0
    start = torque[0]
    for k in range(n):
        slow = slow_factors(p, origin + k * interval)
        position[k], velocity[k] = x[0], x[1]
        now = counted(x[0], encoder_step)
        error = reference[k] - now
        if k > 0:
            smooth += smoothing * ((now - before) / interval - smooth)
            rate += smoothing * ((error - error_before) / interval - rate)
        before, error_before = now, error
        asked = torque[k] + proportional * error + derivative * rate
        if active:
            if velocity_place >= 0:
                rows[k, velocity_place] = smooth
            if position_place >= 0:
                rows[k, position_place] = now
            function(memory.ctypes, rows[k].ctypes, constants.ctypes, result.ctypes)
            asked += result[0]
        torque[k] = min(max(asked, -p.torque_limit), p.torque_limit)
        newer = torque[k - whole] if k >= whole else start
        older = torque[k - whole - 1] if k >= whole + 1 else start
        load_last = load[min(k + 1, n - 1)]
        for j in range(substeps):
            i = k * substeps + j
            fine_velocity[i] = x[1]
            f0, f1 = j / substeps, (j + 1) / substeps
            l0, l1 = 0.0, 0.0
            if behind > 0.0:
                l0, l1 = _past(fine_velocity, i - behind, i), _past(fine_velocity, i + 1 - behind, i)
            motor = newer if j >= part else older
            x, s1, s2, dwell, z = advance(
                p,
                x,
                s1,
                s2,
                dwell,
                z,
                motor,
                motor,
                load[k] + f0 * (load_last - load[k]),
                load[k] + f1 * (load_last - load[k]),
                l0,
                l1,
                step,
                slow,
            )


@compiled
def temperatures(p: Any, time: Any) -> Any:
    """Return the drive's temperature [°C] at each time, shape (N,)."""
    found = np.zeros(time.shape[0])
    for k in range(time.shape[0]):
        found[k] = slow_factors(p, time[k])[4]
    return found


@compiled
def known_loads(p: Any, position: Any, load: Any) -> Any:
    """Return the known load torque where the drive is at given positions, shape (N,)."""
    found = np.zeros(position.shape[0])
    for k in range(position.shape[0]):
        found[k] = known_load(p, position[k], load[k])
    return found
