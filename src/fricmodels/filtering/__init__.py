"""For filters of a drive: its normalised equations, a step with sticking, and the running of a filter over a recording.

A plugin derives from :class:`KalmanEstimator` and writes ``run``: either with a compiled step
(:meth:`FilterProblem.run`) or with an object that takes one sample at a time (:class:`SampleFilter` and
:meth:`FilterProblem.run_stepwise`). :func:`transition` is the drive's step as CasADi expressions.
"""

from __future__ import annotations

from fricmodels.filtering.kalman import KalmanEstimator, KalmanSettings
from fricmodels.filtering.online import ProblemOnline
from fricmodels.filtering.problem import FilterProblem, SampleFilter, Trajectory
from fricmodels.filtering.transition import transition

__all__ = [
    "FilterProblem",
    "KalmanEstimator",
    "KalmanSettings",
    "ProblemOnline",
    "SampleFilter",
    "Trajectory",
    "transition",
]
