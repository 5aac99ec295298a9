"""Signals: derivatives, filters, noise, rest, resampling."""

from __future__ import annotations

from fricmodels.signals.butterworth import butterworth, central_difference
from fricmodels.signals.lanczos import lanczos_derivative, lanczos_smooth, lanczos_window
from fricmodels.signals.noise_level import best_half_width, noise, quantum
from fricmodels.signals.preparation import Preparation, prepare, with_derived_velocity
from fricmodels.signals.resample import resample
from fricmodels.signals.rest import resting, smoothed_velocity, standstill
from fricmodels.signals.segments import gap_length, is_even, stretches

__all__ = [
    "Preparation",
    "best_half_width",
    "butterworth",
    "central_difference",
    "gap_length",
    "is_even",
    "lanczos_derivative",
    "lanczos_smooth",
    "lanczos_window",
    "noise",
    "prepare",
    "quantum",
    "resample",
    "resting",
    "smoothed_velocity",
    "standstill",
    "stretches",
    "with_derived_velocity",
]
