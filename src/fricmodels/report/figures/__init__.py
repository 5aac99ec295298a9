"""Figures for notebook, report and documentation: interactive, one family a file, a unit on every axis.

Every function takes a result of this package and returns a ``plotly.graph_objects.Figure`` with at most 2000 points a
trace, however long the recording. Plotly is imported when the first figure is drawn.
"""

from __future__ import annotations

from fricmodels.report.figures.against import SINCE_REVERSAL, error_against, stribeck
from fricmodels.report.figures.coverage import correlation, coverage
from fricmodels.report.figures.downsample import extremes, line, together
from fricmodels.report.figures.friction import friction_curve
from fricmodels.report.figures.history import parameter_history
from fricmodels.report.figures.hysteresis import hysteresis
from fricmodels.report.figures.motion import simulated_motion, simulated_velocity
from fricmodels.report.figures.ranking import MOST, candidates
from fricmodels.report.figures.residuals import residual_map
from fricmodels.report.figures.shares import error_shares
from fricmodels.report.figures.spectrum import residual_spectrum
from fricmodels.report.figures.steps import ladder
from fricmodels.report.figures.style import DARK, LIGHT
from fricmodels.report.figures.time_course import beyond_axes, drawn_samples, overlay, worst_stretch
from fricmodels.report.figures.tournament import leaderboard

__all__ = [
    "DARK",
    "LIGHT",
    "MOST",
    "SINCE_REVERSAL",
    "beyond_axes",
    "candidates",
    "correlation",
    "coverage",
    "drawn_samples",
    "error_against",
    "error_shares",
    "extremes",
    "friction_curve",
    "hysteresis",
    "ladder",
    "leaderboard",
    "line",
    "overlay",
    "parameter_history",
    "residual_map",
    "residual_spectrum",
    "simulated_motion",
    "simulated_velocity",
    "stribeck",
    "together",
    "worst_stretch",
]
