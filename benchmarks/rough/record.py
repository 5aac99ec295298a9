"""Runs a drive with what is hidden in it, and records it as its logger would."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from rough.drives import Drive, Nominal, Sensors, log_uniform, loop, nominal
from rough.effects import Change, changed
from rough.plant import Course, simulate

Array = NDArray[np.float64]
PAUSE = 1.0
"""Time between two runs [s]."""


@dataclass(frozen=True)
class Case:
    """A drive with effects, and the seed of its motion, its noise and what changes by chance."""

    drive: Drive
    changes: tuple[Change, ...]
    motion: str
    seed: int

    @property
    def inertia(self) -> float | None:
        """The inertia that is told [kg m² or kg]."""
        return self.drive.plant.inertia if self.drive.stated else None

    @property
    def lag(self) -> float:
        """Delay of the recorded motion behind the recorded torque that sensors and sampling make by themselves [s]."""
        s, period = self.drive.sensors, 1 / self.drive.control_rate
        velocity = s.low_pass + {"drive": 0.5 * period, "backward": 0.5 / s.rate}.get(s.velocity, 0.0)
        return velocity + 0.5 * period - (period if s.before else 0.0) - s.torque_low_pass


def simulated(case: Case) -> list[tuple[float, Nominal, Course]]:
    """Return when each run begins, the motion that was asked for, and what happened."""
    d = case.drive
    plant, waves = changed(d.plant, case.changes)
    every, stride = d.substeps
    runs = []
    rng = np.random.default_rng([case.seed, 1])
    whole = d.runs * (d.duration + PAUSE)
    walk = np.random.default_rng([case.seed, 2])
    level = 0.0
    for number in range(d.runs):
        asked = nominal(rng, d, case.motion)
        begin = number * (d.duration + PAUSE)
        coulomb, viscous = np.ones(len(asked.time)), np.ones(len(asked.time))
        other = np.zeros(len(asked.time))
        for one in case.changes:
            course = _course(one, begin + asked.time, whole, walk, level)
            level = float(course[-1]) if one.course == "walk" else level
            coulomb, viscous = coulomb + one.coulomb * course, viscous + one.viscous * course
            if one.coupling:
                other = other + one.coupling * _other_joint(rng, asked.time, d.period)
        own = asked.torque - asked.load
        steered = _feed_forward(d, asked)
        weight = asked.load if d.payload else 0.0
        inputs = np.stack([asked.load - weight, other, np.maximum(coulomb, 0.05), np.maximum(viscous, 0.05)])
        usual = float(np.sqrt(np.mean(own**2))) + float(np.max(np.abs(asked.load)))
        reference = np.stack([asked.position, asked.velocity, steered])
        runs.append(
            (
                begin,
                asked,
                simulate(plant, loop(d, usual), waves, reference, inputs, 1 / d.control_rate / every, stride),
            )
        )
    return runs


def _feed_forward(drive: Drive, asked: Nominal) -> Array:
    return drive.feed_forward * asked.torque if drive.control != "velocity" else 0.5 * drive.feed_forward * asked.torque


def _course(one: Change, time: Array, whole: float, rng: np.random.Generator, level: float) -> Array:
    """Return how far a change has come, of the order of one."""
    if one.course == "step":
        return (time >= one.at * whole).astype(float)
    if one.course == "time":
        end = 1 - math.exp(-1 / one.at)
        return np.asarray((1 - np.exp(-time / (one.at * whole))) / end)
    if one.course == "warming":
        return warmth(one, time, whole)
    if one.course == "walk":
        steps = rng.standard_normal(len(time)) * math.sqrt((time[1] - time[0]) / whole)
        return level + np.cumsum(steps)
    return np.zeros(len(time))


def warmth(one: Change | None, time: Array, whole: float) -> Array:
    """Return the warming over its end; a drive that nothing shows warms too."""
    share = 0.4 if one is None else one.at
    cycle = 0.25 * np.sin(2 * np.pi * 2.3 * time / whole)
    return np.asarray((1 - np.exp(-time / (share * whole))) / (1 - math.exp(-1 / share)) + cycle * (share > 0.5))


def _other_joint(rng: np.random.Generator, time: Array, period: float) -> Array:
    total = np.zeros(len(time))
    for _ in range(4):
        f = log_uniform(rng, 0.4, 3.0) / period
        total += np.sin(2 * np.pi * f * time + rng.uniform(0, 2 * np.pi))
    return total / math.sqrt(2)


def coloured(rng: np.random.Generator, count: int, size: float, colour: float) -> Array:
    """Return noise of an RMS size, white or autoregressive of first order."""
    white = rng.standard_normal(count)
    if not colour:
        return size * white
    return np.asarray(size * math.sqrt(1 - colour**2) * lfilter([1.0], [1.0, -colour], white))


def record(case: Case) -> Recording:
    """Return what is logged."""
    return logged(case, simulated(case))


def logged(case: Case, runs: list[tuple[float, Nominal, Course]]) -> Recording:
    """Return what the logger makes of what happened."""
    d, s = case.drive, case.drive.sensors
    rng = np.random.default_rng([case.seed, 3])
    course_rate = d.control_rate * d.substeps[0] / d.substeps[1]
    delay = sum(one.delay for one in case.changes)
    clip = min((one.clip for one in case.changes), default=math.inf)
    torques = np.concatenate([course.torque for _, _, course in runs])
    sizes = {"torque": _rms(torques), "velocity": _rms(np.concatenate([c.velocity for _, _, c in runs]))}
    whole = d.runs * (d.duration + PAUSE)
    warming = next((one for one in case.changes if one.course == "warming"), None)
    parts: dict[str, list[Array]] = {}
    for number, (begin, _, course) in enumerate(runs):
        known = np.arange(len(course.torque)) / course_rate
        count = int((known[-1] - 0.05 * d.period) * s.rate)
        regular = np.arange(count) / s.rate + 0.02 * d.period
        shaken = regular + s.jitter / s.rate * np.clip(rng.standard_normal(count), -2, 2)
        taken, stamps = (regular, shaken) if s.false_stamps else (shaken, shaken)
        row = _row(rng, s, course, known, taken, stamps, course_rate, d.control_rate, sizes, delay, clip)
        row["time"] = begin + stamps
        if s.temperature or warming is not None:
            row["temperature"] = 20 + 20 * warmth(warming, begin + taken, whole) + 0.05 * rng.standard_normal(count)
        if d.load:
            row["load_torque"] = np.interp(taken, known, course.load)
        row["run"] = np.full(count, number)
        for name, values in row.items():
            parts.setdefault(name, []).append(values)
    channels: dict[str, Any] = {name: np.concatenate(values) for name, values in parts.items()}
    run = channels.pop("run").astype(np.int64)
    return Recording("rough", Motion.LINEAR if d.linear else Motion.ROTARY, channels, run)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) or 1.0


def _row(
    rng: np.random.Generator,
    s: Sensors,
    course: Course,
    known: Array,
    taken: Array,
    stamps: Array,
    course_rate: float,
    control_rate: float,
    sizes: dict[str, float],
    delay: float,
    clip: float,
) -> dict[str, Array]:
    """Return the channels of one run."""
    count = len(taken)
    torque = course.torque
    if s.torque_low_pass:
        torque = _low_passed(torque, s.torque_low_pass, course_rate)
    index = np.floor(taken * course_rate + 1e-6).astype(int) - int(s.before)
    read = torque[np.clip(index, 0, len(torque) - 1)]
    read = np.clip(read, -clip, clip) + coloured(rng, count, s.torque_noise * sizes["torque"], s.torque_colour)
    moved = taken - delay
    position = np.round(np.interp(moved, known, course.position) / s.resolution) * s.resolution
    row = {"torque": read}
    if s.position:
        row["position"] = position
    noise = coloured(rng, count, s.velocity_noise * sizes["velocity"], s.velocity_colour)
    if s.velocity in ("measured", "low-passed"):
        velocity = course.velocity
        if s.low_pass:
            velocity = _low_passed(velocity, s.low_pass, course_rate)
        row["velocity"] = np.interp(moved, known, velocity) + noise
    elif s.velocity == "drive":
        stride = max(round(course_rate / control_rate), 1)
        steps = np.round(course.position[::stride] / s.resolution) * s.resolution
        fast = _low_passed(np.diff(steps, prepend=steps[0]) * control_rate, s.low_pass, control_rate)
        row["velocity"] = fast[np.clip(np.floor(moved * control_rate + 1e-6).astype(int), 0, len(fast) - 1)]
    elif s.velocity == "backward":
        row["velocity"] = np.diff(position, prepend=position[0]) / np.diff(stamps, prepend=stamps[0] - 1 / s.rate)
    elif s.velocity == "central":
        row["velocity"] = np.gradient(position, stamps)
    return row


def _low_passed(values: Array, constant: float, rate: float) -> Array:
    share = 1 - math.exp(-1 / (constant * rate))
    state = np.array([(1 - share) * values[0]])
    return np.asarray(lfilter([share], [1.0, share - 1.0], values, zi=state)[0])
