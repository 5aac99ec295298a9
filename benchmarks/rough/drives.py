"""Draws a drive, its loop, its sensors and its motion; nothing is hidden in it yet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rough.motion import MOTIONS, reference
from rough.plant import Loop, Plant

Array = NDArray[np.float64]
SAMPLES = 8_000
"""A recording is cut shorter than drawn where it would have more samples: trials are to take seconds."""
INTEGRATION = 24_000.0
"""Least rate of integration [Hz]."""
RATES = {50.0: 10, 100.0: 15, 125.0: 10, 200.0: 10, 250.0: 15, 500.0: 17, 1000.0: 15, 2000.0: 5, 5000.0: 3}
"""Rates of the logger [Hz], and how often each is drawn."""
LEAST_SAMPLES = 60
"""Samples of the logger in a base period; the fastest line of a multisine then has fifteen."""
COURSE = 4_000.0
"""Least rate at which the course of the motion is known to the sensors [Hz]."""


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


class Class(NamedTuple):
    """Ranges of a class of drives: inertia, peak speed, base period; whether its travel ends."""

    inertia: tuple[float, float]
    speed: tuple[float, float]
    period: tuple[float, float]
    ends: bool
    linear: bool


CLASSES: Mapping[str, Class] = {
    "robot-joint": Class((0.02, 10.0), (0.3, 4.0), (1.0, 5.0), True, False),
    "spindle": Class((1e-4, 1e-2), (50.0, 600.0), (1.0, 6.0), False, False),
    "servo": Class((1e-5, 1e-3), (5.0, 200.0), (0.4, 3.0), False, False),
    "linear-axis": Class((1.0, 200.0), (0.05, 2.0), (0.5, 4.0), True, True),
}


@dataclass(frozen=True)
class Sensors:
    """What the logger makes of the motion.

    Attributes:
        rate: samples per second.
        bits: of the encoder, per turn.
        resolution: of the position [rad or m].
        velocity: ``measured``, ``low-passed`` (causally), ``drive`` (backward difference at the rate of the controller,
            filtered), ``backward`` or ``central`` difference of the logged position, or ``absent``.
        velocity_noise, torque_noise: RMS, as a share of the RMS of the channel.
        velocity_colour, torque_colour: coefficient of the first-order autoregression of that noise, 0 is white.
        low_pass: time constant of the velocity's filter [s].
        torque_low_pass: time constant of the torque's filter [s].
        jitter: standard deviation of the time between samples, as a share of it.
        false_stamps: whether the jitter is in the stamps alone.
        before: whether the torque that was held before the sample is recorded, not that after it.
        position: whether there is a position column.
        temperature: whether there is a thermometer.
    """

    rate: float
    bits: int
    resolution: float
    velocity: str
    velocity_noise: float
    velocity_colour: float
    torque_noise: float
    torque_colour: float
    low_pass: float
    torque_low_pass: float
    jitter: float
    false_stamps: bool
    before: bool
    position: bool
    temperature: bool


@dataclass(frozen=True)
class Drive:
    """A drive in its loop, with nothing hidden.

    Attributes:
        kind: name of the class.
        linear: whether it is a linear axis.
        plant: its parameters.
        stated: whether its inertia is told.
        motion: kind of motion, and that of the other recording of the same drive.
        speed, period, travel, duration: of the motion, in SI; the duration is of one run.
        runs: number of runs.
        control: ``position``, ``velocity``, ``weak`` (hardly more than feed-forward) or ``open``.
        bandwidth: of the loop [rad/s].
        feed_forward: share of the clean drive's torque that is fed forward.
        control_rate: of the controller [Hz].
        load: RMS of a known load torque [N m or N]; 0 without.
        payload: whether that is a weight on an arm; it changes with time otherwise.
    """

    kind: str
    linear: bool
    plant: Plant
    stated: bool
    motion: str
    other_motion: str
    speed: float
    period: float
    travel: float
    duration: float
    runs: int
    control: str
    bandwidth: float
    feed_forward: float
    control_rate: float
    load: float
    payload: bool
    sensors: Sensors

    @property
    def substeps(self) -> tuple[int, int]:
        """Integration steps per period of the controller, and between the points of the course."""
        points = math.ceil(COURSE / self.control_rate)
        within = math.ceil(INTEGRATION / self.control_rate / points)
        return points * within, within


@dataclass(frozen=True)
class Nominal:
    """The motion that is asked for, with the torque of the clean drive: what sizes are drawn by."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    load: Array
    torque: Array

    @property
    def rms(self) -> float:
        """RMS torque [N m or N]."""
        return float(np.sqrt(np.mean(self.torque**2)))

    @property
    def range(self) -> float:
        """Distance between the ends of the motion [rad or m]."""
        return float(np.ptp(self.position))


def nominal(rng: np.random.Generator, drive: Drive, kind: str) -> Nominal:
    """Draw one run of the motion, at the rate of the controller."""
    motion = reference(rng, kind, drive.speed, drive.period, drive.duration, drive.control_rate, drive.travel)
    position, velocity, acceleration = motion
    time = np.arange(len(position)) / drive.control_rate
    load = np.zeros(len(time))
    if drive.load and drive.payload:
        load = drive.plant.payload_sine * np.sin(position) + drive.plant.payload_cosine * np.cos(position)
    elif drive.load:
        for _ in range(3):
            f = log_uniform(rng, 0.1, 2.0) / drive.period
            load += np.sin(2 * np.pi * f * time + rng.uniform(0, 2 * np.pi))
        load = drive.load * (0.4 * rng.uniform(-1, 1) + load / np.sqrt(1.5))
    p = drive.plant
    friction = p.coulomb_forward * np.tanh(velocity / (0.01 * drive.speed)) + p.viscous_forward * velocity
    return Nominal(time, position, velocity, acceleration, load, p.inertia * acceleration + friction + load)


def drive(
    rng: np.random.Generator, *, loaded: bool = False, stated: bool | None = None, turning: bool = False
) -> Drive:
    """Draw a drive.

    Args:
        rng: source of what is random.
        loaded: whether it must have a known load.
        stated: whether its inertia must be told, ``None`` for either.
        turning: whether it must be rotary.
    """
    names = [name for name in CLASSES if not (turning and CLASSES[name].linear)]
    kind = str(rng.choice(names))
    ranges = CLASSES[kind]
    inertia, speed = log_uniform(rng, *ranges.inertia), log_uniform(rng, *ranges.speed)
    period = log_uniform(rng, *ranges.period)
    motion, other = (str(m) for m in rng.choice(MOTIONS, 2, replace=False))
    typical = inertia * speed / period * 6.0
    dry = typical * log_uniform(rng, 0.1, 2.0)
    viscous = dry * log_uniform(rng, 0.1, 1.5) / speed
    load, payload, angle = 0.0, False, float(rng.uniform(0, 2 * np.pi))
    if loaded or rng.random() < 0.25:
        payload = not ranges.linear and ranges.ends and bool(rng.random() < 0.6)
        load = (typical + dry) * log_uniform(rng, 0.3, 1.5)
    weight = load * math.sqrt(2) if payload else 0.0
    plant = Plant(
        inertia,
        dry,
        dry,
        viscous,
        viscous,
        payload_sine=weight * math.sin(angle),
        payload_cosine=weight * math.cos(angle),
    )
    travel = speed * period * rng.uniform(0.3, 1.0) if ranges.ends else math.inf
    enough = [(rate, share) for rate, share in RATES.items() if rate * period >= LEAST_SAMPLES]
    shares = np.array([share for _, share in enough])
    rate = float(rng.choice([rate for rate, _ in enough], p=shares / shares.sum()))
    control_rate = rate * math.ceil(1000 / rate) * float(rng.choice([1, 2, 4]))
    control_rate = rate * max(math.floor(min(control_rate, 10_000) / rate), 1)
    longest = SAMPLES / rate
    duration = min(max(8.0, float(rng.uniform(6, 20)) * period), 60.0, max(longest, 8.0, 3 * period))
    runs = 1 if rng.random() < 0.7 else int(rng.integers(2, 6))
    control = str(rng.choice(["position", "velocity", "open"], p=[0.5, 0.35, 0.15]))
    if control == "open" and (ranges.ends or load):
        control = "weak"
    sensors = _sensors(rng, kind, rate, control_rate)
    bandwidth = _bandwidth(rng, control, period, control_rate, sensors.resolution, inertia, typical + dry)
    return Drive(
        kind=kind,
        linear=ranges.linear,
        plant=plant,
        stated=bool(rng.random() < 0.7) if stated is None else stated,
        motion=motion,
        other_motion=other,
        speed=speed,
        period=period,
        travel=travel,
        duration=duration / runs if duration / runs > 4 * period else duration,
        runs=runs if duration / runs > 4 * period else 1,
        control=control,
        bandwidth=bandwidth,
        feed_forward=1.0 if control in ("open", "weak") else float(rng.choice([0.0, 0.5, 0.8, 1.0])),
        control_rate=control_rate,
        load=load,
        payload=payload,
        sensors=sensors,
    )


def _bandwidth(
    rng: np.random.Generator,
    control: str,
    period: float,
    rate: float,
    resolution: float,
    inertia: float,
    torque: float,
) -> float:
    """Draw a bandwidth; it is lowered until the torque that the encoder's steps cause is a few hundredths."""
    if control == "open":
        return 0.0
    base = 2 * math.pi / period
    wanted = 1.5 * base if control == "weak" else base * log_uniform(rng, 8, 60)
    wanted = min(wanted, 0.1 * rate)
    while wanted > base:
        cut = 4 * wanted
        noise = resolution / math.sqrt(12) * cut * math.sqrt(min(cut / (2 * rate), 1.0))
        if inertia * wanted * noise < 0.03 * torque:
            break
        wanted *= 0.8
    return wanted


def _sensors(rng: np.random.Generator, kind: str, rate: float, control_rate: float) -> Sensors:
    bits = int(rng.integers(12, 21))
    turn = 2 * math.pi
    if kind == "robot-joint":
        gear = log_uniform(rng, 50, 160)
        turn = turn / gear if bits < 17 or rng.random() < 0.5 else turn
    elif kind == "linear-axis":
        turn = float(rng.choice([0.005, 0.01, 0.02]))
    velocity = str(
        rng.choice(
            ["measured", "low-passed", "drive", "backward", "central", "absent"], p=[0.3, 0.1, 0.25, 0.05, 0.1, 0.2]
        )
    )
    coloured = rng.random(2) < 0.35
    colours = rng.uniform([0.9, 0.9], [0.98, 0.99])
    stamps = rng.random()
    slow, fast = log_uniform(rng, 0.3, 3.0) / rate, log_uniform(rng, 0.5, 8.0) / control_rate
    position = velocity in ("backward", "central", "absent") or bool(rng.random() < 0.75)
    return Sensors(
        rate=rate,
        bits=bits,
        resolution=turn / 2**bits,
        velocity=velocity,
        velocity_noise=log_uniform(rng, 3e-4, 1e-2) if velocity in ("measured", "low-passed") else 0.0,
        velocity_colour=float(colours[0]) if coloured[0] else 0.0,
        torque_noise=log_uniform(rng, 5e-4, 2e-2),
        torque_colour=float(colours[1]) if coloured[1] else 0.0,
        low_pass={"low-passed": slow, "drive": fast}.get(velocity, 0.0),
        torque_low_pass=0.0,
        jitter=0.0 if stamps < 0.7 else log_uniform(rng, 0.01, 0.2),
        false_stamps=stamps > 0.85,
        before=bool(rng.random() < 0.5),
        position=position,
        temperature=bool(rng.random() < 0.1),
    )


def loop(drive: Drive, torque: float) -> Loop:
    """Return the controller of a drive whose usual torque is given."""
    wc, inertia, period = drive.bandwidth, drive.plant.inertia, 1 / drive.control_rate
    kp = 0.25 * inertia * wc**2 if drive.control == "position" else (0.1 * inertia * wc**2) * (drive.control == "weak")
    ki = 0.2 * inertia * wc**2 if drive.control == "velocity" else 0.0
    every, _ = drive.substeps
    return Loop(
        kp=kp,
        kd=inertia * wc,
        ki=ki,
        torque_limit=8 * torque,
        resolution=drive.sensors.resolution,
        filter_share=1 - math.exp(-4 * wc * period) if wc else 1.0,
        every=every,
    )
