r"""Whether an effect of the time itself is there though friction may walk: change with time in no particular way.

Friction of a real drive wanders with what nobody records: grease, temperature, load. So does the zero of its torque. A
line or a jump follows any such walk for a while and explains most of it, and no later repetition says otherwise. So the
noise that the effect is tested against has a walk in it, as large as what the effect leaves shows. Along waves over the
record, the friction's direction and one, each times :math:`\cos(\pi k t/T)`, freed of the model and orthonormal,
residual and effect are

.. math:: y_k = X_k\theta + e_k, \qquad \operatorname{var} e_k = \sigma^2 (1 + \lambda / k^2),

as a random walk has the spectrum :math:`1/k^2`, where the friction walks. Where the zero does there are both kinds of
waves, and those along the friction have σ² alone. The larger of the two p-values counts. λ is that of the largest
restricted likelihood, 0 where nothing walks; θ is tested by generalised least squares, F(q, K − q). That λ is estimated
makes the test find, at a level of 1 %, a line in 3 % of walks of the friction, a jump at a given instant in 2 % of them
and in 4 % of walks of the zero, and either in less than 1 % of noise (1 000 of each). (The mean p-value over all λ
finds a line in 1.3 % of walks, and only half of the lines that have nearly ten standard errors.)

Source: H. D. Patterson, R. Thompson, "Recovery of inter-block information when block sizes are unequal", Biometrika 58
(1971); J. H. Stock, M. W. Watson, "Median unbiased estimation of coefficient variance in a time-varying parameter
model", J. Am. Stat. Assoc. 93 (1998).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression

Array = NDArray[np.float64]

_WAVES, _ROWS_EACH = 36, 2.0
"""Waves over the record at the most, and independent rows for each: slow ones show a walk, the others the noise."""
_LEAST = 4
"""Waves that are needed beside the unknowns of an effect."""
_OWN = 0.05
"""Share of its length that a wave must have outside of the model and of the waves before it."""
_TOLD = 1e-6
"""Share of the largest singular value that a direction of an effect must have."""
_RATIOS = np.concatenate([[0.0], np.exp(np.linspace(-6.0, 14.0, 81))])
"""λ that are tried. The likelihood is flat: between two of them it changes by less than a tenth."""


def waves_of_walks(problem: WeakFormProblem) -> Array:
    """Return a constant, and waves over the record, the slowest first, shape (1 + 2 K, rows).

    The first K waves are along the friction, the others stand by themselves.
    """

    def built() -> Array:
        points = problem.quadrature.recording
        begin, end = float(np.min(points.time)), float(np.max(points.time))
        phase = np.pi * (points.time - begin) / max(end - begin, np.finfo(float).tiny)
        count = max(int(min(_WAVES, problem.independent / _ROWS_EACH)), 1)
        waves = np.cos(np.arange(1, count + 1)[:, None] * phase)
        return problem.integrals(np.vstack([np.ones_like(phase), np.sign(points.velocity) * waves, waves]))

    return problem.integrated("waves of walks", built)


def p_beside_a_walk(regression: Regression, waves: Array, columns: Array) -> float:
    """Return the p-value of an effect where friction or zero may walk; 0 where too few waves are seen to say anything.

    Args:
        regression: the model without the effect.
        waves: see :func:`waves_of_walks`, shape (1 + 2 K, rows).
        columns: of the effect, tangents of its nonlinear parameters among them, shape (q, rows).
    """
    count = len(waves) // 2
    number = np.arange(1.0, count + 1.0)
    of_friction = _beside(regression, waves[:0], waves[1 : count + 1], number, columns)
    # What is no change, a constant zero, is no walk. Waves along the friction show what the effect is besides.
    still = np.full(count, np.inf)
    of_zero = _beside(regression, waves[:1], waves[1:], np.concatenate([still, number]), columns)
    return max(of_friction, of_zero)


def _beside(regression: Regression, freed: Array, waves: Array, number: Array, columns: Array) -> float:
    """Return the p-value of an effect where waves walk that have a finite number, beside what it is freed of first."""
    columns = columns[regression.visible(columns)]
    order = np.argsort(np.where(np.isinf(number), np.arange(1.0, len(number) + 1.0), number), kind="stable")
    number, waves = number[order], np.vstack([freed, waves[order]])
    basis, upper = np.linalg.qr(regression.project_out(waves).T)
    seen = np.abs(np.diag(upper)) > _OWN * np.linalg.norm(waves, axis=1)
    seen[: len(freed)] = False
    basis, number = np.asarray(basis[:, seen], dtype=float), number[seen[len(freed) :]]
    along = basis.T @ regression.project_out(columns).T
    size = np.linalg.norm(along, axis=0)
    along = along[:, size > 0.0] / size[size > 0.0]
    if along.size == 0:
        return 1.0
    # Tangents may be alike: as many directions as can be told.
    left, singular, _ = np.linalg.svd(along, full_matrices=False)
    effect: Array = np.asarray(left[:, singular > _TOLD * singular[0]], dtype=float)
    if len(number) < _LEAST + effect.shape[1]:
        return 0.0
    return _tested(basis.T @ regression.residual, effect, number)


def _tested(target: Array, effect: Array, number: Array) -> float:
    """Return the p-value of an effect, shape (K, q), at the ratio λ of the largest restricted likelihood."""
    from scipy.special import fdtrc

    q = effect.shape[1]
    freedom = len(target) - q
    variance = 1.0 + _RATIOS[:, None] / number**2
    root = np.sqrt(variance)
    orthonormal, upper = np.linalg.qr(effect / root[:, :, None])
    scaled = target / root
    fitted = np.einsum("ikq,ik->iq", orthonormal, scaled)
    explained = np.einsum("iq,iq->i", fitted, fitted)
    rest = np.einsum("ik,ik->i", scaled, scaled) - explained
    if np.min(rest) <= 0.0:
        return 0.0
    # Twice the negative logarithm of the restricted likelihood, without constants.
    sizes = np.abs(np.einsum("iqq->iq", upper))
    value = freedom * np.log(rest) + np.sum(np.log(variance), axis=1) + 2 * np.sum(np.log(sizes), axis=1)
    most = int(np.argmin(value))
    return float(fdtrc(q, freedom, explained[most] / q / (rest[most] / freedom)))
