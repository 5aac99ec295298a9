"""Signals: derivatives, filters, noise, rest, resampling."""

from __future__ import annotations

from fricmodels.signals.butterworth import butterworth, central_difference
from fricmodels.signals.lanczos import lanczos_derivative, lanczos_smooth, lanczos_window
from fricmodels.signals.noise_colour import Noise
from fricmodels.signals.noise_level import best_half_width, noise, noise_of, quantum
from fricmodels.signals.preparation import Preparation, prepare, with_derived_velocity
from fricmodels.signals.resample import resample
from fricmodels.signals.rest import (
    motion_noise,
    resting,
    smoothed_velocity,
    smoothing_half_width,
    standstill,
    velocity_noise,
)
from fricmodels.signals.segments import gap_lengths, is_even, stretches

__all__ = [
    "Noise",
    "Preparation",
    "best_half_width",
    "butterworth",
    "central_difference",
    "gap_lengths",
    "is_even",
    "lanczos_derivative",
    "lanczos_smooth",
    "lanczos_window",
    "motion_noise",
    "noise",
    "noise_of",
    "prepare",
    "quantum",
    "resample",
    "resting",
    "smoothed_velocity",
    "smoothing_half_width",
    "standstill",
    "stretches",
    "velocity_noise",
    "with_derived_velocity",
]
