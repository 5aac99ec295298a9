r"""Whether an effect is there though friction may walk: change with time in no particular way.

Friction of a real drive wanders with what nobody records: grease, temperature, load. So does the zero of its torque. A
line or a jump follows any such walk for a while and explains most of it, and so does the position of a drive that makes
few strokes. So the noise that an effect is tested against has a walk in it, as large as what the effect leaves shows.
In an orthonormal basis Q of waves over the record, freed of the model, residual and effect are

.. math:: y = X\theta + e, \qquad \operatorname{cov} e = \sigma^2 (1 + \lambda\,C), \qquad
    C = \sum_k \frac{1}{k^2}\,w_k w_k^T,

with the waves :math:`w_k = Q^T \cos(\pi k t/T)` times the friction's direction where the friction walks, as a random
walk has the spectrum :math:`1/k^2`, and by themselves where the zero does; its level, a constant, is as unknown as a
walk from 0 has a mean. The larger of the two p-values counts. λ is that of the largest restricted likelihood, 0 where
nothing walks; θ is tested by generalised least squares, F(q, K − q). At a level of 1 % the test finds a line in 2 % of
walks of the friction, a jump at a given instant in 1.2 % of them and in 1.5 % of walks of the zero, and either in 0.8 %
of noise (1 000 of each).

An effect that is no course of time shows with every stroke. It is asked only where the record shows a walk, at 5 %, and
that may come back to where it was, as coloured noise does: :math:`1/(k^2 + c^2)`, with the likeliest c. Of six or ten
strokes it finds a spring in at most 3 % of walks, and an offset in 0.5 % of those of the friction and in 16 to 19 % of
those of the zero (200 of each); the test of the rows finds a spring in 20 to 30 % and an offset in 20 to 80 %. Without
c it is 0.5 % of either, but then coloured noise of the torque hides an offset that the rows show at p = 10⁻¹¹.

Source: H. D. Patterson, R. Thompson, "Recovery of inter-block information when block sizes are unequal", Biometrika 58
(1971); J. H. Stock, M. W. Watson, "Median unbiased estimation of coefficient variance in a time-varying parameter
model", J. Am. Stat. Assoc. 93 (1998).
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression

_WAVES, _ROWS_EACH = 36, 2.0
"""Waves over the record at the most, and independent rows for each: slow ones show a walk, the others the noise."""
_LEAST = 4
"""Waves that are needed beside the unknowns of an effect."""
_LEVEL = np.pi**2 / 6.0
"""Variance of the mean of a walk from 0, T/3, over that of its first cosine, 2T/π²."""
_OWN = 0.05
"""Share of the largest singular value that a direction of the waves must have, beside the model."""
_FADING = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Waves c up to which what walks comes back to where it was: coloured noise that lasts for T/(π c), of the spectrum
1/(k² + c²). The likeliest counts."""
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


def p_beside_a_walk(regression: Regression, waves: Array, columns: Array, *, evidence: float | None = None) -> float:
    """Return the p-value of an effect where friction or zero may walk; 0 where too few waves are seen to say anything.

    Args:
        regression: the model without the effect.
        waves: see :func:`waves_of_walks`, shape (1 + 2 K, rows).
        columns: of the effect, tangents of its nonlinear parameters among them, shape (q, rows).
        evidence: twice the logarithm of how many times likelier a walk must be than none to count, one that may come
            back as coloured noise does; every walk counts, and none comes back, if not given.
    """
    count = len(waves) // 2
    number, still = np.arange(1.0, count + 1.0), np.zeros(count)
    basis, along = _basis(regression, waves)
    effect = _directions(basis.T @ regression.project_out(columns[regression.visible(columns)]).T)
    if effect.size == 0:
        return 1.0
    if len(along) < _LEAST + effect.shape[1]:
        return 0.0
    target = basis.T @ regression.residual
    found = []
    for of_friction in (True, False):
        tried = []
        for fading in _FADING[:1] if evidence is None else _FADING:
            share = 1.0 / (number**2 + fading**2)
            level = 0.5 / fading**2 if fading else _LEVEL
            walks = np.concatenate([[0.0], share, still] if of_friction else [[level], still, share])
            tried.append(_beside(target, effect, along, walks))
        found.append(min(tried, key=lambda one: one[2]))
    return max((p_value for p_value, none, least in found if evidence is None or none - least > evidence), default=0.0)


def _basis(regression: Regression, waves: Array) -> tuple[Array, Array]:
    """Return an orthonormal basis of what the model leaves of the waves, (rows, K), and the waves in it, (K, waves)."""
    left, singular, right = np.linalg.svd(regression.project_out(waves).T, full_matrices=False)
    seen = singular > _OWN * singular[0]
    return np.asarray(left[:, seen]), np.asarray(singular[seen, None] * right[seen])


def _directions(along: Array) -> Array:
    """Return as many orthonormal directions of columns, shape (K, q), as can be told: tangents may be alike."""
    size = np.linalg.norm(along, axis=0)
    along = along[:, size > 0.0] / size[size > 0.0]
    if along.size == 0:
        return along
    left, singular, _ = np.linalg.svd(along, full_matrices=False)
    return np.asarray(left[:, singular > _TOLD * singular[0]], dtype=float)


def _beside(target: Array, effect: Array, along: Array, walks: Array) -> tuple[float, float, float]:
    """Return :func:`_tested` where each wave walks with its share of the variance, shape (waves,)."""
    share, axes = np.linalg.eigh((along * walks) @ along.T)
    share = np.clip(share / max(float(share[-1]), np.finfo(float).tiny), 0.0, None)
    return _tested(axes.T @ target, axes.T @ effect, share)


def _tested(target: Array, effect: Array, share: Array) -> tuple[float, float, float]:
    """Return the p-value of an effect, shape (K, q), at the ratio λ of the largest restricted likelihood.

    And twice the negative logarithm of the likelihood of none and of that λ.
    """
    from scipy.special import fdtrc

    q = effect.shape[1]
    freedom = len(target) - q
    variance = 1.0 + _RATIOS[:, None] * share
    root = np.sqrt(variance)
    orthonormal, upper = np.linalg.qr(effect / root[:, :, None])
    scaled = target / root
    fitted = np.einsum("ikq,ik->iq", orthonormal, scaled)
    explained = np.einsum("iq,iq->i", fitted, fitted)
    rest = np.einsum("ik,ik->i", scaled, scaled) - explained
    if np.min(rest) <= 0.0:
        return 0.0, 0.0, 0.0
    # Twice the negative logarithm of the restricted likelihood, without constants.
    sizes = np.abs(np.einsum("iqq->iq", upper))
    value = freedom * np.log(rest) + np.sum(np.log(variance), axis=1) + 2 * np.sum(np.log(sizes), axis=1)
    most = int(np.argmin(value))
    return float(fdtrc(q, freedom, explained[most] / q / (rest[most] / freedom))), float(value[0]), float(value[most])
