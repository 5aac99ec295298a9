"""Whether the effect that explains a residual best is what is missing, or only resembles it.

Where the true effect is not among the candidates, some other still explains part of the residual, significantly. It
gives itself away: one channel alone, by shapes of no particular physics, predicts more than it does. Then it is named
only if it and further effects together explain more than any channel and leave nothing that could be predicted, since
several effects may be missing at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.basis_functions import FINELY, FINELY_ALONG, FINELY_TORQUE
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests
from fricmodels.diagnosis.floor import LEAST_TORQUE, floor, share_explained
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor, each, views
from fricmodels.diagnosis.verdict import passing_all_gates, predicts, select_effect
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of

Array = NDArray[np.float64]

_WORSE = 0.1
"""Significance at which a channel predicts more than an effect: a wrong name is worse than none."""
_BEATEN = 0.02
"""A channel that predicts this share of the squared residual more than an effect shows that the effect is not it."""
_OUTSIDE = 0.2
"""An effect lies within the shapes of a view if less than this share (squared) of it is outside."""
_LEFT_OVER = 0.05
"""Effects together are enough when no channel predicts this share of the squared residual beyond them."""
_SIMPLER = 0.5
"""Effects together must leave less than this share of what the best channel leaves, and the less the more terms they
have, or as little with less than this share of its shapes; or else the channel is the simpler cause."""
_LEAST, _MOST = 1 / 3, (0.7, 0.85, 0.95)
"""Of what a model should not have left an effect must explain a third, as the largest of three does at least. One that
remembers must explain most of it, and so must several together, the more so the more they are."""


def predictable(result: CandidateTests) -> list[ChannelPredictor]:
    """Return the views that predict the residual of a survey beyond all gates, best first."""
    return [v for v in views(result.problem, result.regression) if predicts(result, v.evidence, v.p_value)]


def is_sufficient(
    result: CandidateTests,
    parameters: Mapping[str, float],
    leave_out: Iterable[str],
    first: CandidateTest,
    seen: Sequence[ChannelPredictor],
) -> bool:
    """Whether an effect is what is missing, by itself or with further ones, and not only resembles it.

    Args:
        result: the survey that it comes from.
        parameters: the model's estimated parameters.
        leave_out: effects that are not considered.
        first: the effect.
        seen: what predicts the residual, best first.
    """
    if first.found.at_search_bound:
        return False
    shapes = [*seen, *(shape_of(result, t) for t in passing_all_gates(result) if t.found.at_search_bound)]
    shapes.sort(key=lambda view: float(np.sum(view.evidence.loss)))
    asked = outpredicted_by_channel(result, first, shapes) or explains_too_little(result, parameters, first, seen)
    return not asked or combination_suffices(result, parameters, leave_out, shapes)


def shape_of(result: CandidateTests, tested: CandidateTest) -> ChannelPredictor:
    """Return what an effect explains that is not what is missing: it goes with that on which the effect depends."""
    needs = " and ".join(sorted(result.problem.alone(tested.effect).model.needs)).replace("_", " ")
    of = "the course of the motion before" if tested.effect.states else needs or "a constant torque"
    return ChannelPredictor(
        f"{of}, as in '{tested.name}'", tested.evidence, tested.adjusted, directions(result, tested)
    )


def outpredicted_by_channel(result: CandidateTests, first: CandidateTest, seen: Sequence[ChannelPredictor]) -> bool:
    """Whether some channel predicts significantly and much more than an effect.

    What went shortly before stands for all that lasts, whatever the number of its causes: of that an effect need only
    explain half, unless it is such a cause itself. Nor is an effect refused by more of its own kind: poles, slots and
    teeth have each their own wave over position.
    """
    total = float(np.sum(result.regression.loss))
    least = max(LEAST_TORQUE**2 * float(np.sum(result.problem.driving**2)), _BEATEN * total)
    own = float(np.sum(first.evidence.loss))
    for view in seen:
        if _own_kind(result, first, view):
            continue
        _, p_value = compare(first.evidence.loss, view.evidence.loss, result.regression.terms)
        predicted = float(np.sum(view.evidence.loss))
        more = own - predicted
        half = own - 0.5 * (total + predicted)
        lasting = view.channels in AUTOREGRESSIVE and not first.effect.states
        if p_value < _WORSE and (half > 0 if lasting else more > least):
            return True
    return False


def explains_too_little(
    result: CandidateTests, parameters: Mapping[str, float], first: CandidateTest, seen: Sequence[ChannelPredictor]
) -> bool:
    """Whether an effect leaves too much to be by itself what is missing.

    Where the true one is not among the candidates, others explain part of what it does. Effects that remember the
    motion are the most pliant of them, and no channel of the moment predicts more; but one may predict what they leave.
    """
    left = float(first.evidence.residual @ first.evidence.residual)
    share = share_explained(result.problem, result.regression, left)
    if not first.effect.states:
        return share < _LEAST
    columns = directions(result, first)
    return share < _MOST[0] or not _complete(
        result, regression_of(result.problem, parameters, columns, first.name), seen
    )


def _own_kind(result: CandidateTests, tested: CandidateTest, view: ChannelPredictor) -> bool:
    """Whether a view shows what an effect is by its nature, and most of the effect lies within its shapes."""
    needs = result.problem.alone(tested.effect).model.needs
    along = FINELY_ALONG if tested.effect.symmetry == "odd" else FINELY
    kind = FINELY_TORQUE if "motor_torque" in needs else along
    if view.channels != kind or not any(p.periodic for p in tested.effect.parameters):
        return False
    own = result.regression.project_out(tested.evidence.coefficients[None] @ tested.found.columns)[0]
    shapes = result.regression.project_out(view.columns)
    basis = np.linalg.svd(shapes, full_matrices=False)[2]
    left = own - (own @ basis.T) @ basis
    return bool(left @ left < _OUTSIDE * (own @ own))


def combination_suffices(
    result: CandidateTests, parameters: Mapping[str, float], leave_out: Iterable[str], seen: Sequence[ChannelPredictor]
) -> bool:
    """Whether the effects found one after the other explain more than any channel, and leave nothing to predict.

    Where one channel alone explains nearly as much as all of them together, one cause is the simpler explanation. What
    merely lasts is such a channel only where one of the effects remembers.
    """
    problem = result.problem
    out, remembers = set(leave_out), False
    columns, first = np.zeros((0, problem.rows)), result
    for effects, most in enumerate(_MOST):
        if effects:
            result = candidate_tests(problem, parameters, leave_out=out, also=columns)
        best = select_effect(result)
        if best is None or best.first.found.at_search_bound:
            return False
        columns = np.vstack([columns, directions(result, best.first)])
        out |= {best.first.name}
        remembers |= bool(best.first.effect.states)
        regression = regression_of(problem, parameters, columns, best.first.name)
        together = regression.loss
        if share_explained(problem, first.regression, float(np.sum(together))) < most:
            continue
        if _complete(first, regression, seen):
            single = next((view for view in seen if remembers or view.channels not in AUTOREGRESSIVE), None)
            return single is None or _simpler(first, columns, together, single)
    return False


def _complete(result: CandidateTests, regression: Regression, seen: Sequence[ChannelPredictor]) -> bool:
    """Whether no channel predicts much of what is left of a residual with the effects that a regression has beyond it.

    What merely lasts does not count: on a real drive something always does. Nor is there much where hardly more is left
    than noise and sampling leave.
    """
    if share_explained(result.problem, result.regression, float(np.sum(regression.loss))) > 1 - _LEFT_OVER:
        return True
    after = CandidateTests(result.problem, regression, (), {})
    most = float(np.sum(regression.loss)) - _LEFT_OVER * float(np.sum(result.regression.loss))
    return not any(
        predicts(after, v.evidence, v.p_value) and np.sum(v.evidence.loss) < most
        for v in each(result.problem, regression, [v.channels for v in seen])
        if v.channels not in AUTOREGRESSIVE
    )


def _simpler(result: CandidateTests, columns: Array, together: Array, single: ChannelPredictor) -> bool:
    """Whether effects together are simpler than one channel: they leave far less, or as little with far fewer terms.

    Whatever is less than noise and sampling leave is as little.

    Args:
        columns: of all effects together, shape (k, rows).
        together: squared held-out residual that they leave, shape (rows,).
        single: the channel that predicts best.
    """
    alone, terms = single.evidence.loss, result.regression.terms
    shapes = len(single.columns) / len(columns)
    if np.sum(together) < _SIMPLER * min(1.0, shapes) * np.sum(alone) and compare(alone, together, terms)[1] < _WORSE:
        return True
    no_worse = float(np.sum(together)) <= floor(result.problem) or compare(together, alone, terms)[1] >= _WORSE
    return _SIMPLER * shapes > 1 and no_worse


def directions(result: CandidateTests, tested: CandidateTest) -> Array:
    """Return an effect's columns and the tangents of its nonlinear parameters, shape (k, rows)."""
    problem, found = result.problem, tested.found
    alone = problem.alone(tested.effect)
    stacked = [found.columns]
    for i, value in enumerate(found.nonlinear):
        step = 1e-4 * abs(value) or 1e-6
        ends = []
        for moved in (value - step, value + step):
            columns, _ = problem.columns(alone, (*found.nonlinear[:i], moved, *found.nonlinear[i + 1 :]))
            ends.append(tested.evidence.coefficients @ columns[found.kept])
        stacked.append(((ends[1] - ends[0]) / (2 * step))[None])
    return np.vstack(stacked)
