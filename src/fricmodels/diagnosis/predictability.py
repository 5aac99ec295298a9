"""Whether a residual could be predicted at all, from which channel, whatever the physics.

A *channel predictor* is a flexible set of basis functions in one channel: hats over speed, waves over position, … . If
it predicts the residual on held-out blocks, something is missing; where no known effect does as well, that is unknown.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import partial

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.diagnosis.basis_functions import TORQUE_PAST, TORQUE_RATE, basis_functions, chances, terms
from fricmodels.diagnosis.candidate_tests import CandidateTests, beside_inertia, is_noise
from fricmodels.diagnosis.verdict import predicts
from fricmodels.progress import each
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import LEAST_P, Evidence
from fricmodels.weakform.shifted import noise_within

OWN_PAST = "its own course shortly before"
AUTOREGRESSIVE = frozenset({OWN_PAST, TORQUE_PAST})
"""Predictors that say nothing of a cause: all that lasts or rings shows in them."""
_PAST = 12


@dataclass(frozen=True)
class ChannelPredictor:
    """What one channel predicts of the residual.

    Attributes:
        channels: in words.
        evidence: of its basis functions, all together.
        p_value: corrected for the number of predictors.
        columns: its basis functions, shape (k, rows).
        tried: number of predictors among which it was found.
    """

    channels: str
    evidence: Evidence
    p_value: float
    columns: Array
    tried: int = 1

    @property
    def terms(self) -> int:
        """Number of coefficients, and of instants or wave numbers that were sought beside them."""
        return terms(self.channels, self.columns)


def passing_predictors(
    result: CandidateTests, *, as_rivals: bool = False, planned: Collection[str] = ()
) -> list[ChannelPredictor]:
    """Return every channel predictor of the residual that passes all gates, the best first.

    Args:
        result: the residual.
        as_rivals: whether they stand against an effect, see :func:`~.verdict.predicts`.
        planned: those that were chosen before any was tried, so that they are not corrected for how many there are.
    """
    problem, regression = result.problem, result.regression
    every = dict(basis_functions(problem, regression, result.policy))
    lasting = frozenset(every) - {TORQUE_PAST}
    every[OWN_PAST] = partial(own_past, problem, regression.residual)
    most = max(1, regression.terms // 2)
    shift = result.policy.within_sampling * problem.recording.interval
    found = []
    for channels in each(f"looking for what predicts the error of {problem.drive.model.name}", list(every)):
        whole = every[channels]()
        columns = beside_inertia(problem, regression, whole)
        chosen = np.flatnonzero(regression.visible(columns))[:most]
        if not len(chosen):
            continue
        evidence = regression.test(columns[chosen])
        if channels == TORQUE_RATE and np.all(np.abs(evidence.coefficients) <= shift):  # these are times
            continue
        tried = 1 if channels in planned else len(every) * chances(channels, problem)
        p_value = float(np.clip(evidence.p_value * tried, LEAST_P, 1.0))
        if not predicts(result, evidence, p_value, as_rival=as_rivals):
            continue
        if channels in lasting and _is_only_noise(result, channels, whole[chosen], chosen, evidence):
            continue
        found.append(ChannelPredictor(channels, evidence, p_value, columns[chosen], tried))
    return sorted(found, key=lambda predictor: predictor.evidence.left)


def _is_only_noise(result: CandidateTests, channels: str, columns: Array, chosen: Index, evidence: Evidence) -> bool:
    """Whether what a channel explains may be noise of the velocity, which is in the channel and in the rows alike.

    Its columns are given whole: the acceleration that :func:`beside_inertia` takes out of them has noise of its own.
    """
    problem, regression, policy = result.problem, result.regression, result.policy
    perturbed = basis_functions(problem.perturbed, regression, policy, channels, like=problem).get(channels)
    if perturbed is None:
        return False
    weights = evidence.coefficients[None]
    noise = noise_within(problem, regression, weights @ columns, weights @ perturbed()[chosen])
    signal = regression.project_out(weights @ beside_inertia(problem, regression, columns))
    return is_noise(float(np.sum(noise**2) / np.sum(signal**2)), evidence.explained, policy)


def own_past(problem: WeakFormProblem, residual: Array) -> Array:
    """Return the residual of earlier rows, far enough before to share no sample and no noise, shape (12, rows).

    Whatever lasts or rings shows in it, in whichever channel its cause may be.
    """
    centre, hop = problem.centre, problem.test_functions.hop
    apart = problem.test_functions.width + 2 * problem.half_width
    columns = []
    for lag in apart + hop * np.arange(_PAST):
        at = np.minimum(np.searchsorted(centre, centre - lag), len(centre) - 1)
        there = np.abs(centre[at] - (centre - lag)) <= hop // 2
        columns.append(np.where(there, residual[at], 0.0))
    return np.vstack(columns)
