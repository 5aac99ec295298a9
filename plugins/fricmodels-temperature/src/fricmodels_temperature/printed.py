"""Printed parameters of the law, and what is printed of it for one load and temperature.

They are second-hand. Q. Yan, R. Li and X. Meng ("Tribo-dynamic analysis and motion control of a rotating manipulator
based on the load and temperature dependent friction model", Proc. IMechE Part J: Journal of Engineering Tribology,
2020, doi 10.1177/1350650120954943) print them in the code of their paper: GitHub ``qiyan98/Manipulator-dynamics``,
commit 2485eacf114534ff0347551924d9ab1e9d0e1eb4, ``FunFriction.m`` (parameters) and ``FunFric0.m`` (closed form).
That these are the values which Bittencourt and Gunnarsson identified rests on the same equation, on the units ("motor
side", load "dimensionless") and on the abstract ("recently-proposed extended static friction model"); the files name
no source for the numbers, and we have not seen the table of 2012.
"""

from __future__ import annotations

from collections.abc import Mapping

MOTOR_SIDE: Mapping[str, float] = {
    "F_c0": 3.11e-2, "F_cl": 2.34e-2, "F_sl": 0.126, "phi_sl": 9.22, "F_s0": -2.5e-2, "F_sT": 1.6e-3,
    "phi_s0": -24.81, "phi_sT": 0.98, "F_v0": 1.3e-4, "F_vT": 1.32e-3, "T_v": 20.71,
}  # fmt: skip
"""Called the original values there: torques over the largest torque, speeds at the motor [rad/s], °C."""
JOINT_SIDE: Mapping[str, float] = {
    "F_c0": 196.27, "F_cl": 2.34e-2, "F_sl": 0.126, "phi_sl": 0.038, "F_s0": -157.77, "F_sT": 10.1,
    "phi_s0": -0.1022, "phi_sT": 0.004, "F_v0": 199.14, "F_vT": 2022.06, "T_v": 20.71,
}  # fmt: skip
"""The same at the joint, as printed: N m, rad/s, °C."""
EXPONENT = 1.36
"""α, the same on both sides."""
GEAR_RATIO = 242.73
LARGEST_MOTOR_TORQUE = 26.0
"""[N m]; times the gear ratio the largest torque of the joint."""
CASE_LOAD, CASE_TEMPERATURE = 1000.0, 35.0
"""Load torque [N m] and temperature [°C] of the printed closed form."""
COULOMB, STRIBECK, STRIBECK_SPEED, VISCOUS = 219.67, 321.0, 0.038, 572.25
"""Coefficients of the printed closed form: N m, N m, rad/s, N m s/rad."""
