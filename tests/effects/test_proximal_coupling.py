"""Two links: what the second joint feels of the first, by the equations of motion and as a name."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording

NAME = "proximal-coupling(j1_velocity)"
MASS, LENGTH, CENTRE, INERTIA, IN_LINE = 0.604, 0.3, 0.184, 0.0035, 0.4
"""m_2 [kg], l_1 [m], r_2 [m], the second link's inertia about its centre [kg m²], and q_0 [rad]."""


def angles(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles of both joints; the second is relative to the first."""
    first = 0.9 * np.sin(2.1 * time) + 0.35 * np.sin(5.3 * time + 1.0)
    second = 1.1 * np.sin(1.3 * time + 0.5) + 0.5 * np.sin(3.7 * time)
    return first, second


def energy(q_1: float, v_1: float, q_2: float, v_2: float) -> float:
    """Return the kinetic energy of the second link, from the velocity of its centre."""
    turn, place = v_1 + v_2, q_1 + q_2 - IN_LINE
    x = -LENGTH * np.sin(q_1) * v_1 - CENTRE * np.sin(place) * turn
    y = LENGTH * np.cos(q_1) * v_1 + CENTRE * np.cos(place) * turn
    return float(0.5 * MASS * (x**2 + y**2) + 0.5 * INERTIA * turn**2)


def lagrange(time: float, step: float = 1e-4) -> float:
    """Return the torque of the second joint, d/dt ∂T/∂v_2 − ∂T/∂q_2, by differences of the energy."""

    def state(t: float) -> list[float]:
        now, before, after = (np.array(angles(np.array([t + d]))).ravel() for d in (0.0, -1e-5, 1e-5))
        speed = (after - before) / 2e-5
        return [now[0], speed[0], now[1], speed[1]]

    def slope(at: list[float], which: int) -> float:
        less, more = list(at), list(at)
        less[which] -= step
        more[which] += step
        return (energy(*more) - energy(*less)) / (2 * step)

    return (slope(state(time + step), 3) - slope(state(time - step), 3)) / (2 * step) - slope(state(time), 2)


def recorded(noise: float, seed: int = 0, coupling: bool = True) -> Recording:
    """Return the second joint with friction, and the velocity of the first beside it."""
    rng = np.random.default_rng(seed)
    time = 0.005 * np.arange(4000)
    (q_1, q_2), fine = angles(time), 1e-4
    speeds = [(a - b) / (2 * fine) for a, b in zip(angles(time + fine), angles(time - fine), strict=True)]
    rates = [
        (a - 2 * b + c) / fine**2 for a, b, c in zip(angles(time + fine), (q_1, q_2), angles(time - fine), strict=True)
    ]
    own, product = INERTIA + MASS * CENTRE**2, MASS * LENGTH * CENTRE
    turned = q_2 - IN_LINE
    torque = own * rates[1] + 0.02 * speeds[1] + 0.08 * np.sign(speeds[1])
    if coupling:
        torque += own * rates[0] + product * (np.cos(turned) * rates[0] + np.sin(turned) * speeds[0] ** 2)
    torque += noise * rng.standard_normal(len(time))
    channels = {"time": time, "torque": torque, "velocity": speeds[1], "position": q_2, "other.j1_velocity": speeds[0]}
    units = {"other.j1_velocity": "rad/s"}
    return Recording("elbow", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64), units=units)


def test_it_is_what_the_equations_of_motion_say() -> None:
    own, product = INERTIA + MASS * CENTRE**2, MASS * LENGTH * CENTRE
    drive = Drive(Model.parse(f"coulomb-viscous+{NAME}"), own)
    values = {"K_v": 0.0, "K_c": 0.0, f"{NAME}.c": own}
    values |= {f"{NAME}.a": product * np.cos(IN_LINE), f"{NAME}.b": product * np.sin(IN_LINE)}
    recording = recorded(0.0)
    speed = recording.velocity
    acceleration = np.gradient(speed, recording.time)
    torque = own * acceleration + drive.friction(recording, values)
    for place in (200, 1111, 2750, 3900):
        assert torque[place] == pytest.approx(lagrange(float(recording.time[place])), abs=2e-4)


def test_an_elbow_is_told_from_friction_and_its_friction_is_right() -> None:
    found = diagnose(recorded(0.01), "coulomb-viscous")
    assert [finding.names for finding in found.findings] == [(NAME,)]
    estimate = compare(recorded(0.01), f"coulomb-viscous+{NAME}").estimate
    product = np.hypot(estimate.parameters[f"{NAME}.a"], estimate.parameters[f"{NAME}.b"])
    assert product == pytest.approx(MASS * LENGTH * CENTRE, rel=0.02)
    assert estimate.parameters["K_c"] == pytest.approx(0.08, rel=0.02)


@pytest.mark.long
def test_a_joint_before_that_does_nothing_is_not_named() -> None:
    assert diagnose(recorded(0.01, coupling=False), "coulomb-viscous").findings == ()


@pytest.mark.long
def test_the_integral_of_this_joints_velocity_is_angle_enough() -> None:
    own = recorded(0.01)
    without = Recording(
        "elbow", own.motion, {k: v for k, v in own.channels.items() if k != "position"}, own.run, units=own.units
    )
    (found,) = diagnose(without, "coulomb-viscous").findings
    assert found.names == (NAME,)
