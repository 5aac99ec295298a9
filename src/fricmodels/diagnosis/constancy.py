r"""Whether an effect of a model is the same throughout the motion: one that is there is; one that stands in is not.

An effect that is there has one size, whatever the drive does. One that imitates another cause has the size that this
cause needs where it acts: a spring that is taken for a resonance wants another one where the torque is large. Let
:math:`\tau_E(t)` be the torque of the effect as it was fitted and g(t) be 1 in one half of the motion, that with the
larger speed, torque or acceleration, say, and 0 in the other. Beside the whole model

.. math:: c \int \varphi\, g\, \tau_E\,dt

is tested in the weak form: c is what the effect has more in that half, in units of itself, and 0 if it is the same.

Source: G. C. Chow, "Tests of equality between sets of coefficients in two linear regressions", Econometrica 28 (1960),
with a variance that holds for autocorrelated rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.term import Effect

_MANY = 3.0
"""Times of itself from which a change is no number."""
_OWN = 0.1
"""Share (RMS) of a column that lies outside of what the model can do, from which its coefficient means something."""


@dataclass(frozen=True)
class Change:
    """How an effect differs between the halves of a motion.

    Attributes:
        effect: its name.
        half: that in which it is larger or smaller, in words.
        change: by how much, in units of the effect as it was fitted; positive where it is larger there.
        standard_error: of that.
        p_value: that it does not change, corrected for all halves and effects tested.
    """

    effect: str
    half: str
    change: float
    standard_error: float
    p_value: float

    @property
    def text(self) -> str:
        """How it differs, in words."""
        more, size = "larger" if self.change > 0 else "smaller", abs(self.change)
        by = f"{100 * size:.0f} % of itself" if size < _MANY else "many times its size"
        return f"{self.half} it is {more} by {by}"


def changes(comparison: Comparison, policy: Policy = POLICY) -> tuple[Change, ...]:
    """Return for each effect of a fitted model the half of the motion in which it certainly differs most.

    Args:
        comparison: the model against the recording.
        policy: with what is certain (``constancy_significance``), and what is worth a word (``constancy_change``).
    """
    effects = comparison.drive.model.effects
    if not effects or comparison.drive.model.known.fixed:
        return ()
    problem, parameters = comparison.problem, comparison.estimate.parameters
    result = candidate_tests(replace(problem), parameters, only=(), policy=policy)
    halves = dict(_halves(result))
    tested = [(effect, *one) for effect in effects for one in _tested(result, comparison, effect, halves)]
    found: dict[str, Change] = {}
    for effect, half, change, error, p_value in tested:
        p_corrected = min(p_value * len(tested), 1.0)
        if p_corrected > policy.constancy_significance or abs(change) < policy.constancy_change:
            continue
        known = found.get(effect.name)
        if known is None or p_corrected < known.p_value:
            found[effect.name] = Change(effect.name, half, change, error, p_corrected)
    return tuple(found.values())


def _tested(
    result: CandidateTests, comparison: Comparison, effect: Effect, halves: Mapping[str, Mask]
) -> Iterator[tuple[str, float, float, float]]:
    """Yield each half of the motion with the change of an effect in it, its standard error and its p-value."""
    problem = result.problem
    torque = _torque(result, comparison, effect)
    for half, inside in halves.items():
        column = problem.integrals((torque * inside)[None])
        own = result.regression.project_out(column)
        if not np.linalg.norm(own) > _OWN * np.linalg.norm(column):
            continue
        evidence = result.regression.test(column)
        error = float(np.sqrt(evidence.covariance[0, 0]))
        yield half, float(evidence.coefficients[0]), error, evidence.p_once


def _torque(result: CandidateTests, comparison: Comparison, effect: Effect) -> Array:
    """Return the torque of an effect as it was fitted, at the samples of the quadrature."""
    drive, values = result.problem.alone(effect), comparison.estimate.parameters
    columns, rest = result.problem.evaluate(drive, drive.model.nonlinear_of(values))
    return np.asarray(np.array(drive.model.linear_of(values)) @ columns + rest)


def _halves(result: CandidateTests) -> Iterator[tuple[str, Mask]]:
    """Yield halves of the motion in words, and the samples of the quadrature that lie in them."""
    points = result.problem.quadrature.recording
    moving = points.velocity != 0.0
    sizes = {
        "at high speed": np.abs(points.velocity),
        "where the motor torque is large": np.abs(result.problem.motor_torque),
        "where the acceleration is large": np.abs(points["acceleration"]),
        "late in the record": points.time,
    }
    if "position" in points:
        sizes["at high positions"] = points["position"]
    for half, size in sizes.items():
        yield half, size > np.median(size[moving])
    yield "in forward motion", points.velocity > 0.0
