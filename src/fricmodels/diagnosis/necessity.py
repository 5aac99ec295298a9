"""Whether a model needs one of its effects, given all the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.diagnosis.candidate_tests import no_evidence
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.drive import Drive
from fricmodels.weakform.directions import base_directions
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Evidence, Regression
from fricmodels.weakform.ripple import carriers_alone, carriers_of
from fricmodels.weakform.staircase import scatter_of_torque


def necessity(comparison: Comparison, effect: str) -> Evidence:
    """Return the evidence for an effect of a fitted model, given all the rest of the model."""
    problem, parameters = comparison.problem, comparison.estimate.parameters
    drive = comparison.drive
    smaller = Drive(drive.model.minus(effect), drive.inertia, drive.motion)
    own = next(e for e in drive.model.effects if e.name == effect)
    alone = problem.alone(own)
    delay = 0.0
    if alone.model.delay:  # its own problem has the record without the delay
        problem, delay = WeakFormProblem.of(smaller, comparison.train, parameters), problem.delay
    carriers = carriers_of(problem, parameters, [effect])
    if carriers:
        problem = carriers_alone(problem, carriers)
    rest = base_directions(replace(problem, drive=smaller), parameters)
    nonlinear = [parameters[f"{effect}.{p.declared.symbol}"] for p in alone.model.nonlinear_parameters]
    columns, _ = problem.columns(alone, nonlinear, delay)
    nuisances = np.vstack([problem.sign_change, problem.torque_rate])
    base = np.vstack([rest, nuisances[:1] if delay else nuisances])
    regression = Regression(base, problem.target, problem.independent, problem.repeats, scatter_of_torque(problem))
    visible = regression.visible(columns)
    return regression.test(columns[visible]) if np.any(visible) else no_evidence(regression)
