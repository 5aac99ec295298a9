"""Recordings in which one effect of the list is hidden; several names are those that nobody could tell apart there."""

from __future__ import annotations

from typing import Any

from logs.case import Case, Sensors
from logs.clean import TWO_THOUSAND_COUNTS
from logs.makes import ARM, BELT, COBOT, DIRECT, HYDRAULIC, MOTOR, SCREW, SERVO, Make
from logs.motions import Chirp, Fourier, Jog, Motion, PointToPoint, Sine, Steps, jump, thinning, warming, waves

HANDED = ("asymmetry", "torque-offset")
SCALED = ("inertia-error", "torque-gain")
MOVES = PointToPoint()


def one(number: int, name: str, make: Make, motion: Motion, seconds: float, *there: str, **options: Any) -> Case:
    return Case(number, name, make, motion, seconds, "one", (there,), **options)


# fmt: off
SINGLE = (
    one(115, "robot-gravity", COBOT, Fourier(), 30, "gravity",
        hidden={"gravity_cosine": 6, "gravity_sine": 14}),
    one(116, "robot-stribeck", COBOT, Steps(shares=(0.01, 0.03, 0.08, 0.2, 0.5, 1), travel=1.5), 40, "stribeck",
        hidden={"stribeck_rise": 7, "stribeck_speed": 0.06}),
    one(117, "robot-gear-wave", COBOT, Fourier(), 30, "cogging",
        hidden={"wave": 3, "wave_number": 202, "wave_phase": 0.4}, inertia_told=None),
    one(118, "robot-square-root", COBOT, MOVES, 30, "nonlinear-viscous",
        hidden={"square_root": 8, "viscous": 2}),
    one(119, "robot-drift", COBOT, Fourier(), 60, "drift", "thermal",
        friction=warming(0.3, 40), viscous=warming(0.45, 40)),
    one(120, "arm-asymmetry", ARM, Fourier(), 20, *HANDED, hidden={"asymmetry_dry": 0.25}),
    one(121, "arm-spring", ARM, MOVES, 20, "stiffness", hidden={"stiffness": 1.1, "neutral": 0.2}),
    one(122, "arm-inertia", ARM, Fourier(0.25), 20, *SCALED, inertia_told=0.65),
    one(123, "arm-delay", ARM, Chirp(0.2, 4, 1.0), 20, "sensor-delay", sensors=Sensors(motion_delay=0.012)),
    one(124, "arm-compliance", ARM, Chirp(0.3, 14, 0.6), 30, "joint-compliance",
        hidden={"link_inertia": 0.35, "link_frequency": 60, "link_damping_ratio": 0.03},
        sensors=Sensors(bandwidth=8)),
    one(125, "servo-presliding", SERVO, Chirp(0.2, 2, 0.5), 30, "presliding", hidden={"presliding_distance": 0.03}),
    one(126, "servo-backlash", SERVO, MOVES, 40, "backlash",
        hidden={"link_inertia": 0.007, "link_frequency": 250, "link_damping_ratio": 0.2, "link_gap": 0.03,
                "link_friction": 0.03},
        sensors=Sensors(torque_low_pass=60)),
    one(127, "servo-gravity", SERVO, MOVES, 40, "gravity",
        hidden={"gravity_sine": 0.35}, inertia_told=None, sensors=Sensors(torque_low_pass=60)),
    one(128, "motor-gain", MOTOR, Jog(), 20, *SCALED, sensors=Sensors(torque_gain=1.25)),
    one(129, "motor-friction-wave", MOTOR, Steps(travel=200), 30, "position-friction",
        hidden={"friction_wave": 2.5e-3, "friction_wave_number": 1, "friction_wave_phase": 0.3}, position_loop=False),
    one(130, "motor-cogging", MOTOR, Steps(shares=(0.02, 0.05, 0.1, 0.2, 0.5, 1), travel=120), 30, "cogging",
        hidden={"wave": 2e-3, "wave_number": 7, "wave_phase": 1}, position_loop=False, inertia_told=None),
    one(131, "screw-stribeck", SCREW, Steps(shares=(0.01, 0.03, 0.1, 0.3, 0.6, 1), travel=0.3), 30, "stribeck",
        hidden={"stribeck_rise": 90, "stribeck_speed": 0.012}),
    one(132, "screw-load", SCREW, MOVES, 20, "load-friction", "directional-efficiency",
        hidden={"load_friction": 0.15}, load=waves((600, 0.23, 0), (300, 0.61, 1))),
    one(133, "screw-jump", SCREW, MOVES, 20, "step-change", friction=jump(0.4, 11.3)),
    one(134, "direct-cogging", DIRECT, Fourier(0.2), 20, "cogging",
        hidden={"wave": 0.12, "wave_number": 22, "wave_phase": 0.2, "second_wave": 0.05, "second_wave_number": 44}),
    one(135, "direct-ripple", DIRECT, Fourier(0.3), 20, "torque-ripple",
        hidden={"ripple": 0.12, "ripple_wave_number": 22}),
    one(136, "direct-lag", DIRECT, Chirp(0.2, 3, 4.0), 20, "frictional-lag",
        hidden={"stribeck_rise": 0.25, "stribeck_speed": 1.5, "lag_time": 0.06}),
    one(137, "belt-inertia", BELT, MOVES, 30, *SCALED, inertia_told=0.6),
    one(138, "hydraulic-warm-oil", HYDRAULIC, Steps(shares=(0.3, 0.7, 1, 0.3, 0.7, 1)), 60, "thermal", "drift",
        viscous=thinning(18, 35, 40), temperature=True),
    one(139, "hydraulic-ageing", HYDRAULIC, PointToPoint(dwell=3), 60, "rising-stiction",
        hidden={"ageing_rise": 900, "ageing_time": 3, "ageing_distance": 0.003}),
    one(165, "belt-teeth-2000-counts", BELT, MOVES, 30, "cogging",
        hidden={"wave": 0.02, "wave_number": 20},
        sensors=Sensors(resolution=TWO_THOUSAND_COUNTS, log_rate=1000, speed_low_pass=100)),
    one(166, "screw-pitch-friction", SCREW, MOVES, 20, "position-friction",
        hidden={"friction_wave": 35, "friction_wave_number": 628.3}),
    one(167, "robot-gravity-sine", COBOT, Sine(0.5, 0.3), 20, "gravity", hidden={"gravity_sine": 14}),
    one(169, "hydraulic-areas", HYDRAULIC, MOVES, 60, "asymmetry",
        hidden={"asymmetry_dry": 120, "asymmetry_viscous": 1200}, inertia_told=None),
    one(170, "belt-weight", BELT, MOVES, 30, *HANDED, hidden={"offset": 0.03}),
    one(171, "belt-backlash", BELT, Jog(), 30, "backlash",
        hidden={"link_inertia": 2.6e-4, "link_frequency": 400, "link_damping_ratio": 0.15, "link_gap": 0.4,
                "link_friction": 0.03},
        sensors=Sensors(log_rate=1000)),
    one(172, "robot-weak-stribeck", COBOT, MOVES, 40, "stribeck",
        hidden={"stribeck_rise": 2.5, "stribeck_speed": 0.15}),
    one(173, "motor-weak-cogging", MOTOR, Jog(), 20, "cogging", hidden={"wave": 6e-4, "wave_number": 11}),
    one(174, "servo-weak-asymmetry", SERVO, MOVES, 40, *HANDED,
        hidden={"asymmetry_dry": 0.015}, sensors=Sensors(torque_low_pass=60)),
    one(175, "arm-square", ARM, MOVES, 30, "nonlinear-viscous", hidden={"square": 0.15}),
    one(176, "direct-compliance", DIRECT, Chirp(0.3, 20, 3.0), 20, "joint-compliance",
        hidden={"link_inertia": 0.009, "link_frequency": 150, "link_damping_ratio": 0.03}),
    one(177, "direct-delay", DIRECT, Fourier(0.3), 20, "sensor-delay", sensors=Sensors(motion_delay=0.005)),
    one(178, "robot-delay", COBOT, Fourier(0.2), 30, "sensor-delay",
        inertia_told=None, sensors=Sensors(motion_delay=0.016)),
    one(179, "screw-presliding-sine", SCREW, Sine(0.002, 1), 20, "presliding", hidden={"presliding_distance": 15e-6}),
    one(180, "screw-presliding-moves", SCREW, MOVES, 20, "presliding", hidden={"presliding_distance": 2e-3}),
    one(181, "motor-ageing", MOTOR, Jog(), 20, "rising-stiction",
        hidden={"ageing_rise": 5e-3, "ageing_time": 0.3, "ageing_distance": 2}),
    one(188, "robot-lag", COBOT, Fourier(), 40, "frictional-lag",
        hidden={"stribeck_rise": 6, "stribeck_speed": 0.15, "lag_time": 0.15}),
    one(189, "belt-warming", BELT, Jog(), 60, "drift", viscous=thinning(15, 40, 30), friction=warming(0.1, 40)),
)
