"""What the authors identified for the Dynamixel XL-330, and the error that they found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Identified:
    """One model of the servo.

    Attributes:
        values: motor and friction parameters by key, see :class:`fricmodels_bam.bench.Bench`.
        error: mean absolute error of the simulated position over the authors' recordings [rad].
    """

    values: Mapping[str, float]
    error: float


XL330: Mapping[str, Identified] = {
    "bam-m1": Identified(
        {
            "k_t": 0.384293,
            "R": 3.588951,
            "armature": 0.001950945,
            "q_offset": 0.01955971,
            "K_v": 0.004035457,
            "K_c": 0.01893813,
        },
        0.03172557,
    ),
    "bam-m2": Identified(
        {
            "k_t": 0.3828036,
            "R": 3.597787,
            "armature": 0.001944795,
            "q_offset": 0.01851313,
            "K_v": 0.004518093,
            "K_c": 0.01786249,
            "K_cs": 0.001219077,
            "omega_s": 0.2349846,
            "alpha": 4.0,
        },
        0.03168425,
    ),
    "bam-m3": Identified(
        {
            "k_t": 0.3571398,
            "R": 2.711092,
            "armature": 0.002224303,
            "q_offset": 0.008134336,
            "K_v": 0.006994844,
            "K_c": 0.009348788,
            "K_l": 0.1936411,
        },
        0.02344131,
    ),
    "bam-m4": Identified(
        {
            "k_t": 0.3561922,
            "R": 2.683343,
            "armature": 0.002206392,
            "q_offset": 0.009345745,
            "K_v": 0.00889065,
            "K_c": 0.005553429,
            "K_cs": 0.008243104,
            "K_l": 0.200760136,
            "K_ls": 0.03043859,
            "omega_s": 0.1000231,
            "alpha": 2.752561,
        },
        0.02247481,
    ),
    "bam-m5": Identified(
        {
            "k_t": 0.3387881,
            "R": 2.337135,
            "armature": 0.002107333,
            "q_offset": 0.008956295,
            "K_v": 0.009696819,
            "K_c": 0.006063038,
            "K_cs": 0.007250881,
            "K_m": 0.3233873,
            "K_e": 0.1014713,
            "K_ms": 2.871882e-09,
            "K_es": 0.1899496,
            "omega_s": 0.1,
            "alpha": 4.0,
        },
        0.02167559,
    ),
    "bam-m6": Identified(
        {
            "k_t": 0.3378911,
            "R": 2.298787,
            "armature": 0.002117312,
            "q_offset": 0.00805873,
            "K_v": 0.009476979,
            "K_c": 0.006576901,
            "K_cs": 0.007681869,
            "K_m": 0.3363971,
            "K_e": 0.09177792,
            "K_ms": 3.946841e-06,
            "K_es": 0.1273408,
            "K_mq": 0.006249693,
            "K_eq": 0.003186139,
            "omega_s": 0.1000614,
            "alpha": 3.264463,
        },
        0.02184132,
    ),
}
"""By law. Source: github.com/Rhoban/bam, bam/params/xl330/m1_sensitivity.json to m6_sensitivity.json, ``base_mae``."""
