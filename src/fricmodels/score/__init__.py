"""How well a fitted drive explains a recording."""

from __future__ import annotations

from fricmodels.score.bands import Band, Errors, headline_window, torque_error_over, torque_errors, windows
from fricmodels.score.criteria import information_criteria
from fricmodels.score.cycles import last_cycles, torque_amplitude
from fricmodels.score.scoring import Measure, Score, score
from fricmodels.score.torque import filtered_torque_error, sliding_half_width, torque_error

__all__ = [
    "Band",
    "Errors",
    "Measure",
    "Score",
    "filtered_torque_error",
    "headline_window",
    "information_criteria",
    "last_cycles",
    "score",
    "sliding_half_width",
    "torque_amplitude",
    "torque_error",
    "torque_error_over",
    "torque_errors",
    "windows",
]
