"""What is said of a channel that predicts a residual: no more than it tells, and from when to when it is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.basis_functions import unsigned, without_sign
from fricmodels.diagnosis.candidate_tests import CandidateTests, beside_inertia
from fricmodels.diagnosis.predictability import ChannelPredictor
from fricmodels.diagnosis.sought_functions import ends_of_stretch, stretch
from fricmodels.dimension import FORCE
from fricmodels.results.words import ALONG, LINE, figures
from fricmodels.weakform.regression import Evidence


def as_told(result: CandidateTests, view: ChannelPredictor | None) -> ChannelPredictor | None:
    """Return what predicts a residual under the name that the recording tells.

    A torque that goes with time alone is also predicted, a little, by as many terms that turn their sign with the
    motion, and on blocks that were kept back these may happen to do better. The sign is said where the terms explain
    clearly more with it.
    """
    if view is None:
        return None
    columns = without_sign(result.problem, result.regression, result.policy, view.channels)
    other = None if columns is None else _evidence(result, columns)
    if other is None or view.evidence.explained > result.policy.said_with_sign * other.explained:
        return view
    return replace(view, channels=unsigned(view.channels))


def from_when_to_when(result: CandidateTests, view: ChannelPredictor | None) -> str:
    """Return in words between which instants one torque is all that a channel in time shows; empty otherwise.

    It must explain as much as the waves of that channel, of which there are more: a torque that wanders has a stretch
    that explains most, too, and more beside it. Instants are known to the distance of the places at which a stretch may
    end. Where the clock starts anew, none is.
    """
    problem, regression = result.problem, result.regression
    time = problem.recording.time
    if view is None or not view.channels.startswith("time") or view.channels.startswith(LINE):
        return ""
    if np.any(np.diff(time) <= 0.0):
        return ""
    found = []
    for along in (True, False):
        columns = stretch(problem, regression, along=along, channel="time")
        evidence = _evidence(result, columns) if len(columns) else None
        if evidence is not None:
            found.append((evidence.explained, along, float(evidence.coefficients[0])))
    explained, along, torque = max(found, default=(0.0, False, 0.0))
    if explained < view.evidence.explained:
        return ""
    low, high = ends_of_stretch(problem, regression, along=along, channel="time")
    begins, ends = low > time[0], high < time[-1]
    if not begins and not ends:
        return ""
    unit = FORCE.unit(problem.drive.motion)
    when = f"until about {figures(high)} s"
    if begins:
        when = f"from about {figures(low)} to about {figures(high)} s" if ends else f"from about {figures(low)} s on"
    return f"{when}, counted from the beginning{f', {ALONG}' if along else ''}: {torque:+.2g} {unit}"


def _evidence(result: CandidateTests, whole: Array) -> Evidence | None:
    """Return what columns explain beside the model, those that it can tell; ``None`` where there are none."""
    columns = beside_inertia(result.problem, result.regression, whole)
    chosen = np.flatnonzero(result.regression.visible(columns))
    return result.regression.test(columns[chosen]) if len(chosen) else None
