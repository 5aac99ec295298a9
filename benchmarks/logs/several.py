"""Recordings in which several effects of the list are hidden, or causes that no list has."""

from __future__ import annotations

from typing import Any

from logs.case import Case, Sensors
from logs.makes import ARM, BELT, COBOT, DIRECT, HYDRAULIC, MOTOR, SCREW, SERVO, Make
from logs.motions import (
    Chirp,
    Fourier,
    Jog,
    Motion,
    PointToPoint,
    Steps,
    catches,
    jump,
    square,
    walk,
    warming,
    waves,
)
from logs.single import HANDED, SCALED

MOVES = PointToPoint()
SLOW_TO_FAST = (0.02, 0.05, 0.1, 0.2, 0.5, 1)


def several(
    number: int, name: str, make: Make, motion: Motion, seconds: float, *there: tuple[str, ...] | str, **options: Any
) -> Case:
    groups = tuple((names,) if isinstance(names, str) else names for names in there)
    return Case(number, name, make, motion, seconds, "several", groups, **options)


def unlisted(
    number: int, name: str, make: Make, motion: Motion, seconds: float, cause: str, *there: str, **options: Any
) -> Case:
    return Case(number, name, make, motion, seconds, "unlisted", tuple((n,) for n in there), cause=cause, **options)


# fmt: off
SEVERAL = (
    several(140, "robot-gravity-stribeck", COBOT, Steps(shares=(0.02, 0.05, 0.1, 0.3, 0.6, 1), travel=2.5), 40,
            "gravity", "stribeck", hidden={"gravity_sine": 12, "stribeck_rise": 6, "stribeck_speed": 0.05}),
    several(141, "robot-gravity-gear-wave", COBOT, Fourier(), 30, "gravity", "cogging",
            hidden={"gravity_sine": 10, "gravity_cosine": 3, "wave": 2.5, "wave_number": 101}),
    several(142, "arm-asymmetry-square-root", ARM, MOVES, 30, "asymmetry", "nonlinear-viscous",
            hidden={"asymmetry_dry": 0.2, "square_root": 0.8}, inertia_told=None),
    several(143, "arm-gravity-delay", ARM, Fourier(0.3), 20, "gravity", "sensor-delay",
            hidden={"gravity_sine": 2.5}, sensors=Sensors(motion_delay=0.010)),
    several(144, "servo-gravity-stribeck", SERVO, MOVES, 60, "gravity", "stribeck",
            hidden={"gravity_sine": 0.3, "stribeck_rise": 0.1, "stribeck_speed": 0.4},
            sensors=Sensors(torque_low_pass=60)),
    several(145, "motor-cogging-asymmetry", MOTOR, Jog(), 20, "cogging", "asymmetry",
            hidden={"wave": 1.8e-3, "wave_number": 2, "asymmetry_dry": 1.5e-3}),
    several(146, "motor-stribeck-friction-wave", MOTOR, Steps(shares=SLOW_TO_FAST, travel=200), 40,
            "stribeck", "position-friction", position_loop=False,
            hidden={"stribeck_rise": 4e-3, "stribeck_speed": 12, "friction_wave": 1.5e-3, "friction_wave_number": 1}),
    several(147, "screw-spring-jump", SCREW, MOVES, 20, "stiffness", "step-change",
            hidden={"stiffness": 250}, friction=jump(0.3, 7.7)),
    several(148, "direct-cogging-stribeck-offset", DIRECT, Fourier(0.2), 30, "cogging", "stribeck", HANDED,
            hidden={"wave": 0.08, "wave_number": 24, "stribeck_rise": 0.18, "stribeck_speed": 0.5, "offset": 0.08}),
    several(149, "belt-inertia-asymmetry", BELT, Jog(), 30, SCALED, "asymmetry",
            hidden={"asymmetry_dry": 0.02}, inertia_told=0.7),
    several(150, "hydraulic-asymmetry-drift", HYDRAULIC, Steps(shares=(0.3, 0.7, 1, 0.3, 0.7, 1)), 60,
            "asymmetry", "drift",
            hidden={"asymmetry_dry": 150}, friction=warming(0.35, 25), viscous=warming(0.35, 25)),
    several(151, "arm-presliding-gravity", ARM, Chirp(0.1, 2.5, 0.5), 30, "presliding", "gravity",
            hidden={"presliding_distance": 0.006, "gravity_cosine": 2, "gravity_sine": 1.2}),
    several(184, "hydraulic-jump-stribeck", HYDRAULIC, MOVES, 60, "step-change", "stribeck",
            hidden={"stribeck_rise": 250, "stribeck_speed": 0.01}, friction=jump(0.35, 37)),
    several(186, "arm-ripple-gravity", ARM, Fourier(), 30, "torque-ripple", "gravity",
            hidden={"ripple": 0.06, "ripple_wave_number": 100, "gravity_sine": 2}),
    several(187, "direct-inertia-delay", DIRECT, Fourier(0.3), 20, SCALED, "sensor-delay",
            inertia_told=0.8, sensors=Sensors(motion_delay=0.004)),
)

UNLISTED = (
    unlisted(152, "screw-friction-bump", SCREW, MOVES, 20, "more friction at one place",
             hidden={"friction_bump": 120, "bump_place": 0.08, "bump_width": 0.02}),
    unlisted(153, "robot-coupling", COBOT, Fourier(), 30, "a joint that is not recorded",
             disturbance=waves((3.5, 0.37, 0.5), (2.5, 0.91, 0))),
    unlisted(154, "arm-walking-friction", ARM, MOVES, 30, "friction that walks at random", friction=walk(0.09)),
    unlisted(155, "servo-clipped-current", SERVO, PointToPoint(speed=6), 30, "a current sensor that clips",
             sensors=Sensors(torque_clip=0.30)),
    unlisted(156, "motor-rope", MOTOR, MOVES, 20, "a rope that pulls on one side of a place",
             hidden={"rope_torque": 4e-3, "rope_place": 20}),
    unlisted(157, "belt-tooth", BELT, Steps(travel=100), 30, "a torque at one place, of a damaged tooth",
             hidden={"bump_torque": 0.05, "bump_place": 12, "bump_width": 1.5}),
    unlisted(158, "hydraulic-pulsation", HYDRAULIC, Jog(), 60, "a force that jumps to and fro, of the pressure",
             disturbance=square(250, 0.21, 1)),
    unlisted(159, "direct-cable", DIRECT, Fourier(0.2), 20, "a cable that catches at random moments",
             disturbance=catches(0.12, 14)),
    unlisted(168, "robot-gravity-friction-bump", COBOT, MOVES, 40, "more friction at one place", "gravity",
             hidden={"gravity_sine": 12, "friction_bump": 6, "bump_place": 0.7, "bump_width": 0.12}),
    unlisted(182, "servo-rope-stribeck", SERVO, MOVES, 40, "a rope that pulls on one side of a place", "stribeck",
             hidden={"rope_torque": 0.1, "rope_place": 0.3, "stribeck_rise": 0.08, "stribeck_speed": 0.4},
             sensors=Sensors(torque_low_pass=60)),
    unlisted(183, "robot-gravity-coupling", COBOT, Fourier(), 30, "a joint that is not recorded", "gravity",
             hidden={"gravity_sine": 10}, disturbance=waves((2.5, 0.31, 0))),
    unlisted(185, "motor-clipped-current", MOTOR, Jog(), 20, "a current sensor that clips",
             sensors=Sensors(torque_clip=0.025)),
)
