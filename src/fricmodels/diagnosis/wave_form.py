"""Whether a wave over position has the form of an effect: what it goes with, beside where it is."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.policy import Policy
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression, compare


def any_form(problem: WeakFormProblem, k: float) -> Array:
    r"""Return the columns of a wave that goes with anything, shape (12, rows).

    Cosine and sine of :math:`kq` and :math:`2kq`: each as it is, with the direction, and with the motor torque.
    """
    points = problem.quadrature.recording
    waves = [wave(m * k * points["position"]) for m in (1.0, 2.0) for wave in (np.cos, np.sin)]
    factors = np.ones(len(points)), np.sign(points.velocity), problem.motor_torque
    return problem.integrals(np.stack([wave * factor for factor in factors for wave in waves]))


def has_another_form(without: Regression, loss: Array, columns: Array, policy: Policy) -> bool:
    """Whether a wave that goes with anything predicts clearly more than an effect that is a wave, of the same number.

    A cause that is not on the list is imitated by the others. So the effect is not named if it is less than half of
    what any wave explains; nor if it is clearly less, and the wave in its other forms is most of what the effect
    leaves. A real wave goes a little with all of them: EMPS's has 0.88 of what any wave explains, and of what it leaves
    that is a quarter. A wave in the place of one of another form has 0.6 to 0.94, and of what it leaves that is all.

    Args:
        without: the regression without the effect.
        loss: squared residuals with the effect, shape (rows,).
        columns: of a wave that goes with anything, shape (k, rows).
        policy: decides how much is clearly more.
    """
    seen = without.visible(columns)
    if not np.any(seen):
        return False
    before, any_wave = float(np.sum(without.loss)), without.test(columns[seen])
    theirs, own = (before - float(np.sum(left)) for left in (any_wave.loss, loss))
    is_less = own < policy.of_channel * theirs and theirs - own >= policy.own_share * (before - own)
    if theirs <= 0.0 or not (own < policy.own_share * theirs or is_less):
        return False
    return compare(loss, any_wave.loss, without.terms)[1] <= policy.outpredicted_significance
