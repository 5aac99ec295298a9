"""What a recording could have shown: the smallest effect that would have been found, or what is missing for it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from fricmodels import plugins
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests


@dataclass(frozen=True)
class Visibility:
    """Whether an effect that was not found would have been seen.

    Attributes:
        smallest_percent: RMS torque of the smallest such effect that would have been found, in % of the RMS motor
            torque; not a number where the recording cannot show the effect at all.
        smallest_torque: the same in N m or N.
        missing: what the recording lacks; empty where the effect could have been seen.
    """

    smallest_percent: float
    smallest_torque: float
    missing: str


def visibility(result: CandidateTests, found: Iterable[str]) -> dict[str, Visibility]:
    """Return, for every effect that was not found, what the recording could have shown of it."""
    effects = plugins.load().effects
    names = set(found)
    rows: dict[str, Visibility] = {}
    for tested in result.tested:
        if tested.name not in names:
            rows[tested.name] = _smallest(result, tested)
    for name, reason in result.untested.items():
        needed = effects[name].needs_motion
        text = reason + (f"; to see it, record {needed}" if needed else "")
        rows[name] = Visibility(float("nan"), float("nan"), text)
    return dict(sorted(rows.items()))


def _smallest(result: CandidateTests, tested: CandidateTest) -> Visibility:
    """Return the RMS torque at which both gates would be passed in half of all recordings like this one.

    First gate: the Wald statistic reaches its critical value. Second gate: the residual falls by the least gain,
    which takes a part of it of relative size √(1 − (1 − g)²) beyond what noise leaves.
    """
    from scipy.stats import f as fisher

    problem, regression, policy = result.problem, result.regression, result.policy
    reference = float(np.sqrt(np.mean(problem.driving**2)))
    residual = float(np.sqrt(np.mean(regression.residual**2)))
    columns = tested.found.columns
    gain_needed = residual * float(np.sqrt(max(1 / (1 - policy.least_gain) ** 2 - 1, 0.0)))
    if not len(columns):
        needed = gain_needed
    else:
        q = len(columns)
        freedom = max(regression.terms - q + 1, 1)
        candidates = max(len(result.tested), 1)
        harmonic = float(np.sum(1 / np.arange(1, candidates + 1)))
        level = policy.significance / (tested.found.trials * candidates * harmonic)
        critical = float(fisher.isf(max(level, 1e-300), q, freedom)) * regression.terms * q / freedom
        free = regression.project_out(columns)
        # A coefficient vector of Wald statistic equal to the critical one, along its least certain direction.
        spread, directions = np.linalg.eigh(tested.evidence.covariance)
        theta = directions[:, -1] * np.sqrt(critical * max(spread[-1], 0.0))
        needed = max(gain_needed, float(np.sqrt(np.mean((theta @ free) ** 2))))
    share = max(needed / reference, policy.least_torque) if reference > 0 else float("nan")
    torque = share * float(np.sqrt(np.mean(problem.recording.torque**2)))
    return Visibility(100 * share, torque, "")
