"""From a case to the log of its drive: the motion, the drive behind its controller, sensors, a CSV file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from logs.case import Case
from logs.makes import LOAD, TEMPERATURE, Column
from logs.motions import OpenLoop, Signal
from logs.plant import Course, Loop, Plant, simulate

Array = NDArray[np.float64]
INTEGRATED = 40_000.0
"""Integration steps in a second."""
SEEDS = 1000
"""Numbers of cases between two seeds."""
POLLED, LATE = 0.25, 0.1
"""Wander of the moment of a sample, and delay of its stamp, over the interval."""
OIL, WARMER, WARMS = 32.0, 18.0, 35.0
"""Temperature of the oil at first, by how much it rises [°C], and its time constant [s]."""


@dataclass(frozen=True)
class Drawn:
    """A recording as it is logged, in SI units.

    Attributes:
        channels: by name, in the order of the columns, shape (N,) each.
        course: what happened, at the rate of the controller.
        at: periods at which it is logged.
    """

    channels: dict[str, Array]
    course: Course
    at: NDArray[np.int64]


def drawn(case: Case, seed: int = 0, integrated: float = INTEGRATED) -> Drawn:
    """Simulate a case.

    Args:
        case: which one.
        seed: another draws another motion where that is random, and other noise, and turns all waves by an angle.
        integrated: integration steps in a second.
    """
    make, sensors = case.make, case.sensors
    rng = np.random.default_rng(case.number + SEEDS * seed)
    turned = float(np.random.default_rng([seed, case.number]).uniform(0, 2 * np.pi)) if seed else 0.0
    rate = make.control_rate
    position = case.motion.reference(rng, rate, case.seconds, make.speed, make.travel)
    speed = np.gradient(position) * rate
    time = np.arange(len(position)) / rate

    def signal(given: Signal | None, otherwise: float) -> Array:
        return np.full(len(time), otherwise) if given is None else given(time, rng, turned)

    inputs = np.stack(
        [
            signal(case.motion.torque if isinstance(case.motion, OpenLoop) else None, 0.0),
            signal(case.friction, 1.0),
            signal(case.viscous, 1.0),
            signal(case.disturbance, 0.0),
            signal(case.load, 0.0),
        ]
    )
    plant = plant_of(case, turned)
    reference = np.stack([position, speed, np.gradient(speed) * rate])
    course = simulate(plant, loop_of(case, plant), reference, inputs, max(1, round(integrated / rate)))
    every = round(rate / (sensors.log_rate or make.log_rate))
    return _logged(case, course, every, rng)


def plant_of(case: Case, turned: float = 0.0) -> Plant:
    """Return the parameters of a drive, the waves of its position turned by an angle."""
    make = case.make
    own = {
        "inertia": make.inertia,
        "coulomb": make.coulomb,
        "viscous": make.viscous,
        "torque_time": make.torque_time,
        **case.hidden,
    }
    for phase in ("friction_wave_phase", "wave_phase", "second_wave_phase", "ripple_phase"):
        own[phase] = own.get(phase, 0.0) + turned
    return Plant(**{name: float(value) for name, value in own.items()})


def loop_of(case: Case, plant: Plant) -> Loop:
    """Return the controller: a speed loop of a bandwidth, its integral and the position loop four times slower."""
    make, sensors = case.make, case.sensors
    fast = 2 * math.pi * (sensors.bandwidth or make.bandwidth)
    corner = 2 * math.pi * (sensors.speed_low_pass or make.speed_low_pass)
    return Loop(
        closed=not isinstance(case.motion, OpenLoop),
        rate=make.control_rate,
        position_gain=fast / 4 if case.position_loop else 0.0,
        velocity_gain=make.inertia * fast,
        integral_gain=make.inertia * fast**2 / 4,
        feed_inertia=plant.inertia,
        feed_viscous=plant.viscous,
        limit=make.torque_limit,
        resolution=sensors.resolution or make.resolution,
        filter_share=1 - math.exp(-corner / make.control_rate),
    )


def _logged(case: Case, course: Course, every: int, rng: np.random.Generator) -> Drawn:
    make, sensors = case.make, case.sensors
    rate, count = make.control_rate, len(course.position)
    at = np.arange(0, count, every)
    stamps = at / rate
    if sensors.stamps == "polled":
        wander = int(POLLED * every)
        at = np.unique(np.clip(at + rng.integers(-wander, wander + 1, len(at)), 0, count - 1))
        stamps = at / rate
    elif sensors.stamps == "late":
        stamps = stamps + np.abs(rng.normal(0, LATE * every / rate, len(stamps)))
        stamps = np.maximum.accumulate(stamps) + np.arange(len(stamps)) * 1e-9
    torque = _torque(case, course, at, every)
    if sensors.torque != "command":
        torque = torque + rng.normal(0, make.torque_noise, len(torque))
    seen = np.maximum(at - round(sensors.motion_delay * rate), 0)
    channels = {
        "time": stamps,
        "position": course.seen_position[seen],
        "velocity": course.seen_velocity[seen],
        "torque": torque / sensors.torque_gain,
    }
    if case.load is not None:
        channels["load"] = course.load[at]
    if case.temperature:
        channels["temperature"] = OIL + WARMER * (1 - np.exp(-stamps / WARMS))
    return Drawn(channels, course, at)


def _torque(case: Case, course: Course, at: NDArray[np.int64], every: int) -> Array:
    """Return the torque that is logged, without noise."""
    sensors = case.sensors
    if sensors.torque_low_pass:
        from scipy.signal import lfilter

        share = 1 - math.exp(-2 * math.pi * sensors.torque_low_pass / case.make.control_rate)
        return np.asarray(lfilter([share], [1.0, share - 1.0], course.mean_torque)[at])
    if sensors.torque == "command":
        return course.command[at]
    if sensors.torque == "mean":
        total = np.concatenate([[0.0], np.cumsum(course.mean_torque)])
        until = np.minimum(at + every, len(course.torque))
        return np.asarray((total[until] - total[at]) / (until - at))
    torque = course.torque[at]
    return np.clip(torque, -sensors.torque_clip, sensors.torque_clip) if sensors.torque_clip else torque


def columns(case: Case) -> tuple[Column, ...]:
    """Return the columns of a log."""
    more = [*([LOAD] if case.load is not None else []), *([TEMPERATURE] if case.temperature else [])]
    return (*case.make.columns, *more)


def write(case: Case, log: Drawn, path: Path) -> None:
    """Write a recording as the logger of its make does."""
    values = []
    for column, channel in zip(columns(case), log.channels.values(), strict=True):
        factor = case.make.torque_constant if column.channel == "current" else None
        written = channel / (column.scale * (factor or 1.0))
        values.append(np.round(written / column.step) * column.step if column.step else written)
    digits = ",".join(f"%.{column.decimals}f" for column in columns(case))
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(column.header for column in columns(case)) + "\n")
        np.savetxt(file, np.column_stack(values), fmt=digits)


def options(case: Case) -> list[str]:
    """Return what an engineer tells ``fricmodels`` of a log."""
    make = case.make
    told = [word for column in columns(case) if column.told for word in ("--column", column.option)]
    if make.torque_constant:
        told += ["--torque-constant", str(make.torque_constant)]
    if make.linear:
        told.append("--linear")
    if case.inertia_told is not None:
        told += ["--inertia", f"{make.inertia * case.inertia_told:g}"]
    return told


def figures(case: Case, log: Drawn) -> dict[str, float]:
    """Return sizes of a recording: RMS torque, peak speed, share that is hidden and of noise [% of the RMS torque]."""
    course = log.course
    rms = float(np.sqrt(np.mean(course.torque**2)))
    return {
        "samples": len(log.at),
        "rms_torque": rms,
        "peak_speed": float(np.max(np.abs(course.velocity))),
        "travelled": float(np.ptp(course.position)),
        "hidden_percent": 100 * float(np.sqrt(np.mean(course.hidden**2))) / rms,
        "noise_percent": 100 * case.make.torque_noise / rms if case.sensors.torque != "command" else 0.0,
    }
