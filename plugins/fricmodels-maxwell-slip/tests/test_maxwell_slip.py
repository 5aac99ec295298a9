"""The law against the published equations written out one element at a time, Masing's rules, and rig data."""

from __future__ import annotations

import itertools
import operator
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from fricmodels_maxwell_slip import SPREAD, GeneralisedMaxwellSlip
from numpy.typing import NDArray
from scipy.optimize import nnls

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.testing import LawExam
from fricmodels.tournament import load_config, run

Array = NDArray[np.float64]

VALUES = {
    "F_1": 0.25, "F_2": 0.25, "F_3": 0.3, "F_4": 0.2, "K_v": 0.4, "x_s": 2e-5, "r": 1.5, "v_s": 1e-3, "T": 0.02,
}  # fmt: skip
"""Newton, metre, second: F_c = 1 N, F_s = 1.5 N, C = 50 N/s."""
DRIVE = Drive(Model(GeneralisedMaxwellSlip()), 1.0, Motion.LINEAR)


class PublishedElements:
    """The equations of the papers in their own terms: k_i, α_i, C and s(v), in very small steps of Euler's rule."""

    def __init__(self, values: dict[str, float]) -> None:
        torques = np.array([values[f"F_{i}"] for i in range(1, 5)])
        self.F_c, self.values = float(torques.sum()), values
        self.alpha = torques / self.F_c
        self.stiffness = torques * values["r"] / (np.array(SPREAD) * values["x_s"])
        self.C = self.F_c / values["T"]
        self.force = np.zeros(4)
        self.slips = np.zeros(4, dtype=bool)
        self.direction = 0.0

    def s(self, velocity: float) -> float:
        """Stribeck curve, without its sign."""
        return float(self.F_c * (1 + (self.values["r"] - 1) * np.exp(-((velocity / self.values["v_s"]) ** 2))))

    def step(self, velocity: float, dt: float) -> float:
        """Advance by a time and return the friction force."""
        direction, s = float(np.sign(velocity)), self.s(velocity)
        if direction != self.direction:
            self.slips[:] = False
            self.direction = direction
        for i in range(4):
            if self.slips[i]:
                self.force[i] += direction * self.C * (self.alpha[i] - direction * self.force[i] / s) * dt
            else:
                self.force[i] += self.stiffness[i] * velocity * dt
                if direction * self.force[i] >= self.alpha[i] * s:
                    self.force[i] = direction * self.alpha[i] * s
                    self.slips[i] = True
        return float(self.force.sum()) + self.values["K_v"] * velocity


def published(time: Array, velocity: Callable[[Any], Any], parts: int, **changed: float) -> Array:
    """Return the friction of the published elements along a motion, each interval in so many parts."""
    elements = PublishedElements({**VALUES, **changed})
    forces = [0.0]
    for begin, end in itertools.pairwise(time):
        dt = (end - begin) / parts
        for middle in begin + dt * (np.arange(parts) + 0.5):
            force = elements.step(float(velocity(middle)), dt)
        forces.append(force)
    return np.array(forces)


def friction(time: Array, velocity: Array, **changed: float) -> Array:
    """Return the law's friction along a given motion."""
    channels = {"time": time, "torque": np.zeros_like(time), "velocity": velocity}
    recording = Recording("given motion", Motion.LINEAR, channels, np.zeros(len(time), dtype=np.int64))
    return DRIVE.friction(recording, {**VALUES, **changed})


def along(turning_points: list[float], each: int = 50) -> tuple[Array, Array, Array]:
    """Return time, velocity and position of a motion from 0 by way of turning points, at ±1 m/s but at rest in each."""
    positions, velocities, times = [0.0], [0.0], [0.0]
    for there in turning_points:
        fraction = np.arange(1, each + 1) / each
        length = there - positions[-1]
        duration = 2 * abs(length)
        start = (positions[-1], times[-1])
        positions.extend(start[0] + length * np.where(fraction < 0.5, 2 * fraction**2, 1 - 2 * (1 - fraction) ** 2))
        velocities.extend(np.sign(length) * 2 * np.minimum(fraction, 1 - fraction))
        times.extend(start[1] + duration * fraction)
    return np.array(times), np.array(velocities), np.array(positions)


def virgin(displacement: float) -> float:
    """The first loading of the elements without a Stribeck fall: a polygon."""
    breaks = np.array(SPREAD) * VALUES["x_s"]
    torques = np.array([VALUES[f"F_{i}"] for i in range(1, 5)])
    return float(np.sum(torques * np.minimum(displacement / breaks, 1.0)))


def masing(turning_points: list[float], each: int = 50) -> Array:
    """Force along :func:`along` by Masing's rules: doubled branches from each reversal, closed loops are forgotten."""
    _, _, positions = along(turning_points, each)
    open_reversals = [(0.0, 0.0)]
    forces = [0.0]
    for k in range(len(turning_points)):
        branch = positions[k * each : (k + 1) * each + 1]
        direction = np.sign(branch[-1] - branch[0])
        for position in branch[1:]:
            while len(open_reversals) > 2 and direction * (position - open_reversals[-2][0]) > 0:
                del open_reversals[-2:]
            if len(open_reversals) == 2 and abs(position) > abs(open_reversals[1][0]):
                del open_reversals[1:]
            at, held = open_reversals[-1]
            scale = 1 if len(open_reversals) == 1 else 2
            forces.append(held + scale * direction * virgin(abs(position - at) / scale))
        open_reversals.append((branch[-1], forces[-1]))
    return np.array(forces)


@pytest.mark.parametrize("seed", range(5))
def test_presliding_has_nonlocal_memory(seed: int) -> None:
    """Hysteresis in position by Masing's rules, to rounding, for random loops within loops."""
    rng = np.random.default_rng(seed)
    turning_points = list(np.cumsum(2e-6 * rng.uniform(1, 20, 40) * np.array([1, -1] * 20)))
    time, velocity, _ = along(turning_points)
    np.testing.assert_allclose(friction(time, velocity, r=1.0, K_v=0.0), masing(turning_points), atol=1e-12)


def test_inner_loops_return_to_the_outer_loop() -> None:
    """After loops within loops the force is the same as without them, at slow speed with the Stribeck fall too."""
    inner = [2e-5, -1.5e-5, 1e-5, -0.5e-5, 0.8e-5, -0.5e-5, 1e-5]
    for changed in ({"r": 1.0}, {"v_s": 1e3}):
        ends = []
        for path in ([*inner, 1.8e-5], [2e-5, -1.5e-5, 1.8e-5]):
            time, velocity, _ = along(path)
            ends.append(friction(time, velocity, **changed)[-1])
        assert ends[0] == pytest.approx(ends[1], rel=1e-6)


def test_a_step_may_be_longer_than_the_contact() -> None:
    """With five samples between reversals the ends of the branches are as with five hundred."""
    path = [3e-5, -1e-5, 2.5e-5, -3e-5, 0.4e-5]
    coarse, fine = (friction(*along(path, each)[:2], r=1.0, K_v=0.0)[each::each] for each in (6, 500))
    np.testing.assert_allclose(coarse, fine, atol=1e-9)


@pytest.mark.parametrize("speed", [1e-4, 1e-3, 2e-3, 0.1, -1e-3])
def test_velocity_weakening(speed: float) -> None:
    """Steady sliding is on the Stribeck curve."""
    time = np.linspace(0, 1.0, 1001)
    force = friction(time, np.full_like(time, speed))[-1]
    curve = 1 + 0.5 * np.exp(-((speed / 1e-3) ** 2))
    assert force == pytest.approx(np.sign(speed) * curve + 0.4 * speed, rel=1e-6)


def test_frictional_lag() -> None:
    """Friction lags behind the speed while everything slips; it is that of the published elements."""
    areas = []
    for frequency in (1.0, 5.0, 20.0):
        time = np.linspace(0.0, 6 * np.pi / frequency, 1201)

        def velocity(t: Any, frequency: float = frequency) -> Any:
            return 1.55e-3 - 1.45e-3 * np.cos(frequency * t)

        force = friction(time, velocity(time))
        assert np.max(np.abs(force - published(time, velocity, 10))) < 2e-3
        last = time >= 4 * np.pi / frequency
        areas.append(float(np.trapezoid(force[last], velocity(time[last]))))
    assert areas[0] > 0
    assert areas[1] > 2 * areas[0]


def test_transition_curves() -> None:
    """From rest at constant acceleration: the faster, the lower the peak, and all end on the Stribeck curve."""
    peaks = []
    for acceleration in (0.001, 0.01, 0.1, 1.0):
        time = np.linspace(0.0, np.sqrt(2e-4 / acceleration), 1501)
        force = friction(time, acceleration * time)
        expected = published(time, partial(operator.mul, acceleration), 10)
        assert np.max(np.abs(force - expected)) < 1e-4
        peaks.append(float(force.max()))
    assert np.all(np.diff(peaks) < 0)
    assert peaks[0] > 1.45


def test_reversals_at_speed_are_those_of_the_published_elements() -> None:
    """Presliding, break-away, Stribeck fall and lag in one motion, at a few samples per presliding."""
    time = np.linspace(0.0, 3.0, 3001)

    def velocity(t: Any) -> Any:
        return 2e-3 * np.sin(2 * np.pi * 1.3 * t) + 1e-3 * np.sin(2 * np.pi * 3.1 * t + 1.0)

    force, expected = friction(time, velocity(time)), published(time, velocity, 8)
    assert np.sqrt(np.mean((force - expected) ** 2)) < 1e-3 * np.sqrt(np.mean(expected**2))


def test_simulated_motion_is_that_of_the_published_elements() -> None:
    """A mass of 1 kg pushed to and fro beyond its break-away force."""
    time = np.linspace(0.0, 1.0, 1001)
    force = 1.8 * np.sin(2 * np.pi * 2 * time)
    found = simulate(DRIVE, VALUES, time, force, substeps=4)
    elements, velocity, parts = PublishedElements(VALUES), 0.0, 40
    expected = [0.0]
    for begin, end, before in zip(time[:-1], time[1:], force[:-1], strict=True):
        dt = (end - begin) / parts
        rise = (force[len(expected)] - before) / (end - begin)
        for part in range(parts):
            friction_force = elements.step(velocity, dt)
            velocity += dt * (before + rise * dt * (part + 0.5) - friction_force)
        expected.append(velocity)
    assert np.max(np.abs(found.velocity - np.array(expected))) < 1e-3 * np.max(np.abs(expected))


@pytest.mark.long
def test_hidden_presliding(tmp_path: Path) -> None:
    """On a drive with hidden presliding the error falls to a tenth or less, and the drawn values are near."""
    folder = Path(__file__).parents[1]
    board = run(load_config(folder / "tournament.yaml"), tmp_path, directory=folder, executor="serial")
    assert [row["status"] for row in board.rows] == ["ok"] * 3, [row["message"] for row in board.rows]
    rows = {row["model"]: row for row in board.rows}
    error = "held_out_rms_torque_error_percent"
    assert rows["maxwell-slip"][error] < 0.1 * rows["coulomb-viscous"][error]
    found = rows["maxwell-slip"]["parameters"]
    coulomb = sum(found[f"F_{i}"] for i in range(1, 5))
    assert coulomb == pytest.approx(0.4, rel=0.05)
    assert coulomb * found["r"] == pytest.approx(0.55, rel=0.05)
    assert found["x_s"] == pytest.approx(nearest_width(0.02), rel=0.05)


def nearest_width(width: float) -> float:
    """Return x_s of the law that comes nearest to the first bending of the rig's contacts, by least squares.

    The rig's four equal contacts break away at quarters of its width; the corners of the law's polygon lie at
    :data:`SPREAD` times x_s, so that the last but one and the last contact share a corner.
    """
    bent = np.linspace(0.0, 1.5 * width, 600)
    true = np.mean([np.minimum(bent / (share * width), 1.0) for share in (0.25, 0.5, 0.75, 1.0)], axis=0)
    widths = np.linspace(0.5 * width, 1.5 * width, 201)
    left = [nnls(np.stack([np.minimum(bent / (d * x), 1.0) for d in SPREAD], axis=1), true)[1] for x in widths]
    return float(widths[np.argmin(left)])


class TestExam(LawExam):
    """The exam of laws, on a drive that comes through presliding and the falling part of the friction often."""

    term = GeneralisedMaxwellSlip
    truth: ClassVar = {
        "F_1": 0.05, "F_2": 0.05, "F_3": 0.06, "F_4": 0.04, "K_v": 0.02, "x_s": 0.1, "r": 1.5, "v_s": 0.3, "T": 0.02,
    }  # fmt: skip
