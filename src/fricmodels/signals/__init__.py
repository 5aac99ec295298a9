"""Signals: derivatives, filters, rest, resampling and the weak form."""

from __future__ import annotations

from fricmodels.signals.butterworth import butterworth, central_difference
from fricmodels.signals.lanczos import (
    best_half_width,
    lanczos_derivative,
    lanczos_smooth,
    lanczos_window,
    noise,
)
from fricmodels.signals.preparation import Preparation, prepare
from fricmodels.signals.segments import gap_length, stretches

__all__ = [
    "Preparation",
    "best_half_width",
    "butterworth",
    "central_difference",
    "gap_length",
    "lanczos_derivative",
    "lanczos_smooth",
    "lanczos_window",
    "noise",
    "prepare",
    "stretches",
]
