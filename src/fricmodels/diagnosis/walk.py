r"""Whether an effect of the time itself is there though friction may walk: change with time in no particular way.

Friction of a real drive wanders with what nobody records: grease, temperature, load. A line or a jump follows any such
walk for a while and explains most of it, and no later repetition says otherwise. So the noise that the effect is tested
against has a walk in it, as large as what the effect leaves shows. Along K waves over the record, the friction's
direction times :math:`\cos(\pi k t/T)`, freed of the model and orthonormal, residual and effect are

.. math:: y_k = X_k\theta + e_k, \qquad \operatorname{var} e_k = \sigma^2 (1 + \lambda / k^2),

as a random walk has the spectrum :math:`1/k^2`. λ is that of the largest restricted likelihood, 0 where nothing walks;
θ is tested by generalised least squares, F(q, K − q). That λ is estimated makes the test find, at a level of
1 %, a line in 3 % of walks and in 0.5 % of noise, a jump at a given instant in 1 % of walks (2 000 of each). (The mean
p-value over all λ finds a line in 1.3 % of walks, and only half of the lines that have nearly ten standard errors.)

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


def waves_of_friction(problem: WeakFormProblem) -> Array:
    """Return the direction of friction times waves over the record, the slowest first, shape (K, rows)."""

    def built() -> Array:
        points = problem.quadrature.recording
        begin, end = float(np.min(points.time)), float(np.max(points.time))
        phase = np.pi * (points.time - begin) / max(end - begin, np.finfo(float).tiny)
        count = max(int(min(_WAVES, problem.independent / _ROWS_EACH)), 1)
        return problem.integrals(np.sign(points.velocity) * np.cos(np.arange(1, count + 1)[:, None] * phase))

    return problem.integrated("waves of friction", built)


def p_beside_a_walk(regression: Regression, waves: Array, columns: Array) -> float:
    """Return the p-value of an effect where friction may walk; 0 where too few waves are seen to say anything.

    Args:
        regression: the model without the effect.
        waves: see :func:`waves_of_friction`, the slowest first, shape (K, rows).
        columns: of the effect, tangents of its nonlinear parameters among them, shape (q, rows).
    """
    columns = columns[regression.visible(columns)]
    basis, upper = np.linalg.qr(regression.project_out(waves).T)
    seen = np.abs(np.diag(upper)) > _OWN * np.linalg.norm(waves, axis=1)
    number = 1.0 + np.flatnonzero(seen).astype(np.float64)
    basis = np.asarray(basis[:, seen], dtype=float)
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
