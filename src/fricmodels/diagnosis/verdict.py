"""From evidence to an answer: an effect with its look-alikes, or none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.floor import LEAST_TORQUE
from fricmodels.diagnosis.look_alikes import same_in_part
from fricmodels.weakform.all_motion import residual_rms
from fricmodels.weakform.regression import Evidence, compare

SIGNIFICANCE = 0.01
"""Chance, over all candidates of one survey, to accept an effect where there is none."""
LEAST_GAIN = 0.05
"""An effect must lower the held-out residual by a twentieth to be worth its place in a model."""
LEAST_OVER_ALL = 0.04
"""Or to this share over all motion, the stretches about standstill included that the rows leave out. There sampling and
differentiation leave more: on 250 simulated drives with nothing hidden an effect takes away up to 3.4 %."""
_HELD_OUT, _PREDICTED = 0.1, 0.05
"""Significance of the second gate, the gain on held-out blocks, of an effect and of what a channel predicts. It is the
first gate that holds the chance of a false name."""
_ALIKE = 0.05
"""Two effects whose held-out residuals differ by less than a twentieth are not told apart by that difference."""
_NEAR = 0.02
"""Nor are two that differ by a fiftieth of what the base model leaves."""
_FAR_WORSE = 1.5
"""No effect that leaves half as much again as the best one explains the data as well, whatever the test says."""
_WORSE = 0.05
"""Significance at which one effect explains the data worse than another."""
_SPOILT = 2.0
"""An effect that leaves so many times the torque over all motion, the stretches about standstill included, is none."""
_PRICE = 0.025
"""Relative reduction of the residual that each further parameter must bring (Occam)."""


@dataclass(frozen=True)
class LookAlikes:
    """The effect that explains a residual best, and those that explain it as well."""

    first: CandidateTest
    members: tuple[CandidateTest, ...]

    @property
    def names(self) -> list[str]:
        """Names of the class, best first."""
        return [t.name for t in self.members]


def passing_all_gates(survey: CandidateTests) -> list[CandidateTest]:
    """Return the candidates that pass both gates, and are large enough in the rows or over all motion.

    Over all motion none counts that does not come near the best one in the rows.
    """
    passing = passing_significance(survey)
    best = min((_rms(t) for t in passing if not t.found.at_search_bound), default=np.inf)
    return [
        t
        for t in passing
        if torque_share(survey, t.evidence) > LEAST_TORQUE
        or (_rms(t) < _FAR_WORSE * best and _is_large_over_all(survey, t))
    ]


def passing_significance(survey: CandidateTests) -> list[CandidateTest]:
    """Return the candidates that pass both gates, however small they are."""
    return [t for t in survey.tested if _is_sure(t.evidence, t.adjusted, _HELD_OUT)]


def predicts(survey: CandidateTests, evidence: Evidence, adjusted: float) -> bool:
    """Whether a channel predicts a residual: significantly, better on held-out blocks, and enough to matter."""
    return _is_sure(evidence, adjusted, _PREDICTED) and torque_share(survey, evidence) > LEAST_TORQUE


def _is_sure(evidence: Evidence, adjusted: float, level: float) -> bool:
    return adjusted < SIGNIFICANCE and evidence.gain > LEAST_GAIN and evidence.gain_p_value < level


def _is_large_over_all(survey: CandidateTests, tested: CandidateTest) -> bool:
    if not _is_judged(survey, tested):
        return False
    problem = survey.problem
    power = float(np.mean(problem.recording.torque[~problem.resting] ** 2))
    return residual_rms(problem) ** 2 - _left_with(survey, tested) ** 2 > LEAST_OVER_ALL**2 * power


def torque_share(survey: CandidateTests, evidence: Evidence) -> float:
    """Return the RMS torque that columns explain beyond the base model, over the RMS torque."""
    explained = evidence.explained * float(np.mean(survey.regression.residual**2))
    return float(np.sqrt(max(explained, 0.0) / np.mean(survey.problem.driving**2)))


def select_effect(survey: CandidateTests) -> LookAlikes | None:
    """Return the best effect with its look-alike class, or ``None`` where no candidate passes."""
    passing = passing_all_gates(survey)
    if not passing:
        return None
    # At the end of what a recording can tell an effect only resembles another; any other that passes is more likely.
    passing.sort(key=lambda t: (t.found.at_search_bound, _cost(t)))
    before = residual_rms(survey.problem)
    first = next((t for t in passing if not _spoils(survey, t, before)), None)
    if first is None:
        return None
    members = [first]
    best = _rms(first)
    for other in passing[passing.index(first) + 1 :]:
        _, p_worse = compare(other.evidence.loss, first.evidence.loss, survey.regression.terms)
        near = max(_ALIKE * best, _NEAR * float(np.sqrt(np.mean(survey.regression.loss))))
        alike = _rms(other) - best < near or (p_worse > _WORSE and _rms(other) < _FAR_WORSE * best)
        if not alike:
            continue
        if _contains(survey, other, first) and not same_in_part(first.name, other.name):
            continue
        if not _spoils(survey, other, before):
            members.append(other)
    return LookAlikes(first, tuple(members))


def _spoils(survey: CandidateTests, tested: CandidateTest, before: float) -> bool:
    """Whether an effect makes far worse what the rows leave out."""
    return _is_judged(survey, tested) and _left_with(survey, tested) > _SPOILT * before


def _is_judged(survey: CandidateTests, tested: CandidateTest) -> bool:
    """Whether what an effect leaves sample by sample says anything: of a torque's rate samples are no measure."""
    return "motor_torque_rate" not in survey.problem.alone(tested.effect).model.needs


def _left_with(survey: CandidateTests, tested: CandidateTest) -> float:
    """Return the RMS torque that an effect leaves over all motion."""
    alone = survey.problem.alone(tested.effect)
    return residual_rms(survey.problem, alone, tested.found.nonlinear, tested.found.kept)


def _rms(tested: CandidateTest) -> float:
    return float(np.sqrt(np.mean(tested.evidence.loss)))


def _cost(tested: CandidateTest) -> float:
    return float(np.log(_rms(tested))) + _PRICE * len(tested.effect.parameters)


def _contains(survey: CandidateTests, larger: CandidateTest, smaller: CandidateTest) -> bool:
    """Whether everything that the smaller effect adds lies within what the larger one can add."""
    if len(larger.effect.parameters) <= len(smaller.effect.parameters):
        return False
    free = survey.regression.project_out(smaller.found.columns)
    span = survey.regression.project_out(larger.found.columns)
    basis = np.linalg.svd(span, full_matrices=False)[2]
    left = free - (free @ basis.T) @ basis
    return bool(np.sum(left**2) < 0.01 * np.sum(free**2))
