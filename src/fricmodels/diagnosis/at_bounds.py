r"""A parameter of a law that ends at its bound, and would lie beyond it.

Effects are tested beside all that the model can do by itself, and there its linear parameters are free to both sides,
though a law has bounds as :math:`K_v \ge 0`. That is on purpose: where several causes are missing, what is unphysical
in the model takes up the others while one is tested. But it hides a friction that falls with the speed all along: a
negative :math:`K_v` is that fall, and the fit may not have it.
"""

from __future__ import annotations

from dataclasses import replace

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.policy import Policy
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.shifted import regression_of


def beyond_bounds(comparison: Comparison, policy: Policy) -> WeakFormProblem | None:
    """Return the rows of a model whose parameters are kept at the bounds that the data would have passed.

    A parameter is kept if its column, given back to a model without it, has a coefficient with a p-value below that of
    a name. Such a coefficient lies beyond the bound; or it lies within, and another parameter would have to pass its
    own bound: else the fit would have it. ``None`` if there is none.
    """
    problem, parameters = comparison.problem, comparison.estimate.parameters
    model, kept = problem.drive.model, set[str]()
    columns, _ = problem.columns(problem.drive, model.nonlinear_of(parameters))
    for column, parameter in zip(columns, model.linear_parameters, strict=True):
        bounds = parameter.declared.lower, parameter.declared.upper
        if parameters[parameter.key] not in bounds or bounds[0] == bounds[1]:
            continue
        without = regression_of(replace(problem, kept=frozenset([parameter.key])), parameters)
        if not without.visible(column[None]).all():
            continue
        if without.test(column[None]).p_value < policy.significance:
            kept.add(parameter.key)
    return replace(problem, kept=frozenset(kept)) if kept else None
