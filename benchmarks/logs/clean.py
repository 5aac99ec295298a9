"""Recordings in which nothing is hidden."""

from __future__ import annotations

import math
from typing import Any

from logs.case import Case, Sensors
from logs.makes import ARM, BELT, COBOT, DIRECT, HYDRAULIC, MOTOR, SCREW, SERVO, Make
from logs.motions import Fourier, Jog, Motion, OpenLoop, PointToPoint, Steps, waves

TWO_THOUSAND_COUNTS = math.pi / 1000
FIVE_HUNDRED_COUNTS = math.pi / 250


def clean(number: int, name: str, make: Make, motion: Motion, seconds: float, **options: Any) -> Case:
    return Case(number, name, make, motion, seconds, "clean", **options)


# fmt: off
CLEAN = (
    clean(100, "robot-fourier", COBOT, Fourier(), 30),
    clean(101, "robot-moves", COBOT, PointToPoint(), 30, inertia_told=None, sensors=Sensors("command")),
    clean(102, "arm-fourier", ARM, Fourier(), 20),
    clean(103, "arm-jog", ARM, Jog(), 30, inertia_told=None),
    clean(104, "servo-moves", SERVO, PointToPoint(), 40, sensors=Sensors(torque_low_pass=60)),
    clean(105, "servo-steps-at-50-hz", SERVO, Steps(shares=(0.1, 0.2, 0.4, 0.7, 1)), 40,
          inertia_told=None, sensors=Sensors(log_rate=50)),
    clean(106, "motor-steps", MOTOR, Steps(travel=200), 30, position_loop=False),
    clean(107, "motor-jog", MOTOR, Jog(), 20),
    clean(108, "screw-moves", SCREW, PointToPoint(), 12),
    clean(109, "screw-steps", SCREW, Steps(shares=(0.05, 0.15, 0.3, 0.6, 1)), 30,
          inertia_told=None, sensors=Sensors("mean")),
    clean(110, "direct-fourier", DIRECT, Fourier(0.2), 20),
    clean(111, "direct-open-loop", DIRECT, OpenLoop(waves((0.55, 0.5, 0), (0.35, 1.3, 1), (0.15, 3.1, 0))), 15),
    clean(112, "belt-moves", BELT, PointToPoint(), 30),
    clean(113, "hydraulic-steps", HYDRAULIC, Steps(shares=(0.2, 0.5, 1)), 60),
    clean(114, "hydraulic-jog-polled", HYDRAULIC, Jog(), 60, inertia_told=None, sensors=Sensors(stamps="polled")),
    clean(160, "robot-moves-at-125-hz", COBOT, PointToPoint(), 40,
          inertia_told=None, sensors=Sensors(log_rate=125, torque_low_pass=40)),
    clean(161, "servo-jog-late-stamps", SERVO, Jog(), 40, sensors=Sensors(stamps="late", torque_low_pass=60)),
    clean(162, "arm-slow-torque", ARM, Fourier(0.25), 20,  # the torque comes 5.3 ms late
          beside=("sensor-delay",), sensors=Sensors(torque_low_pass=30)),
    clean(163, "motor-jog-500-counts", MOTOR, Jog(), 20,
          sensors=Sensors(resolution=FIVE_HUNDRED_COUNTS, speed_low_pass=80)),
    clean(164, "motor-steps-500-counts", MOTOR, Steps(travel=200), 30, position_loop=False,
          inertia_told=None, sensors=Sensors(resolution=FIVE_HUNDRED_COUNTS, speed_low_pass=80)),
)
