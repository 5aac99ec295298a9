"""Whether a torque is missing that is periodic in position and too fast for the rows of the weak form."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from fricmodels import plugins
from fricmodels.diagnosis.candidate_tests import CandidateTest, not_yet, tested_at
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.verdict import LookAlikes
from fricmodels.diagnosis.wave_form import any_form, has_another_form
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import LEAST_P, Regression, compare
from fricmodels.weakform.ripple import Waves, carriers_alone, fast_waves, of_waves
from fricmodels.weakform.shifted import regression_of


@dataclass(frozen=True)
class FastRipple:
    """Fast waves over position, and the effect that they are.

    Attributes:
        waves: all that stand out of the spectrum over position.
        found: the effect that explains the largest of them best, with its look-alikes; ``None`` where none does.
        others: effects with no more parameters that explain less of the rows that carry it, the least residual first.
    """

    waves: Waves
    found: LookAlikes | None
    others: tuple[CandidateTest, ...] = ()

    @property
    def torque(self) -> float:
        """RMS torque of the largest wave [N m or N]."""
        return self.waves.lines[0].torque


def fast_ripple(
    problem: WeakFormProblem, parameters: Mapping[str, float], leave_out: Iterable[str], policy: Policy
) -> FastRipple | None:
    """Look for waves over position that the rows average away.

    They are sought in what the model leaves from sample to sample, and the periodic effects compared on rows that carry
    the largest wave. These effects differ in what it goes with: nothing, the direction, the motor torque.

    Args:
        problem: the rows of a fitted model.
        parameters: its parameters.
        leave_out: effects that are not considered.
        policy: decides what is significant, and large enough.
    """
    least = policy.least_torque * problem.recording.rms_torque
    waves = fast_waves(problem, parameters, policy.significance, least)
    if waves is None:
        return None
    rows = carriers_alone(problem, waves.carriers)
    if not rows.rows:
        return FastRipple(waves, None)
    regression = regression_of(rows, parameters)
    tested = _tested(rows, regression, waves, set(leave_out))
    if not tested:
        return FastRipple(waves, None)
    best = tested[0]
    k = best.found.nonlinear[0] if best.found.nonlinear else waves.k
    if has_another_form(regression, best.evidence.loss, any_form(rows, k), policy):
        return FastRipple(waves, None)

    def is_alike(other: CandidateTest) -> bool:
        return compare(other.evidence.loss, best.evidence.loss, regression.terms)[1] > policy.alike_significance

    alike = [best, *filter(is_alike, tested[1:])]
    first = min(alike, key=lambda test: test.size)  # the simplest
    others = tuple(t for t in tested if t not in alike and t.size <= first.size)
    return FastRipple(waves, LookAlikes(first, (first, *(t for t in alike if t is not first))), others)


def _tested(rows: WeakFormProblem, regression: Regression, waves: Waves, leave_out: set[str]) -> list[CandidateTest]:
    """Return the tests of all effects whose one nonlinear parameter is a wave number, the least residual first.

    Beside them stand those in the angle itself, whose wave number is 1, where the wave may be theirs.
    """
    tested = []
    registered, there = plugins.load().effects, {effect.name for effect in rows.drive.model.effects}
    for name in registered:
        for effect in not_yet(registered[name].candidates(rows.recording), there):
            alone = rows.alone(effect)
            nonlinear = [p.declared for p in alone.model.nonlinear_parameters]
            is_wave = [p.periodic for p in nonlinear] == [True] or (effect.angular and not nonlinear)
            if effect.name in leave_out or not is_wave or alone.model.states:
                continue
            found = of_waves(rows, regression, effect, alone, waves)
            if found is not None:
                tested.append(tested_at(regression, effect, found))
    # That there is a wave was tested once for all of them, on the samples, against all other waves; the rows tell
    # what it goes with.
    p_value = max(waves.lines[0].p_value, LEAST_P)
    tested = [replace(t, p_value=p_value, adjusted=p_value, once=p_value) for t in tested]
    return sorted(tested, key=lambda t: t.evidence.left)
