r"""Statistics that hold for autocorrelated rows.

A candidate's columns Z are freed of everything that the base model could itself take up: :math:`\tilde Z = Z - X
X^+Z`. Its coefficients are then :math:`\hat\theta = (\tilde Z'\tilde Z)^{-1}\tilde Z'y`, and their covariance is the
sandwich around the long-run variance of the scores :math:`\tilde z_t e_t`, estimated by ν equal-weighted cosines; the
Wald statistic follows :math:`F(q, \nu-q+1)`.

Source: E. Lazarus, D. J. Lewis, J. H. Stock, M. W. Watson, "HAR inference: recommendations for practice", J. Bus. Econ.
Stat. 36 (2018), with ν = 0.4 T^(2/3).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOLDS = 8
_SEEN = 1e-5
"""A column of which less than this share (squared) is left outside the base directions cannot be told from them."""


@dataclass(frozen=True)
class Evidence:
    """What speaks for a set of columns.

    Attributes:
        coefficients, covariance: of the columns.
        p_value: of the Wald test that all coefficients are zero.
        explained: share of the base model's squared residual that the columns explain.
        gain: share by which they lower the RMS of the residual on blocks that were not used for fitting.
        gain_p_value: that the gain is zero or less, one-sided.
        loss: squared held-out residual of each row with the columns, shape (M,).
        residual: residual of all rows with the columns, shape (M,).
    """

    coefficients: Array
    covariance: Array
    p_value: float
    explained: float
    gain: float
    gain_p_value: float
    loss: Array
    residual: Array


class Regression:
    """The base model's regression, against which candidates are tested.

    Args:
        base: base directions, shape (k, M).
        target: shape (M,).
        independent: about how many of the M rows are independent.
    """

    def __init__(self, base: Array, target: Array, independent: float) -> None:
        size = np.linalg.norm(base, axis=1)
        self.base = base[size > 0] / size[size > 0, None]
        self.target = target
        self.terms = cosine_terms(independent, len(target))
        left, singular, _ = np.linalg.svd(self.base.T, full_matrices=False)
        self._basis = left[:, singular > 1e-9 * singular[0]] if len(singular) else left
        self.residual = self.free(target[None])[0]
        self._edges = np.linspace(0, len(target), FOLDS + 1).astype(int)
        self.loss = self.held_out(self.base) ** 2

    @property
    def unshifted(self) -> Regression:
        """The regression for what is itself a shift in time, and has no other one beside it: this one."""
        return self

    def free(self, columns: Array) -> Array:
        """Project the base directions out of columns, shape (q, M)."""
        once = columns - (columns @ self._basis) @ self._basis.T
        return np.asarray(once - (once @ self._basis) @ self._basis.T)

    def less(self, part: Array) -> Regression:
        """Return the regression of what is left of the target without a part that is known, shape (M,)."""
        other = copy(self)
        other.target = self.target - part
        other.residual = self.residual - self.free(part[None])[0]
        other.loss = other.held_out(self.base) ** 2
        return other

    def visible(self, columns: Array) -> NDArray[np.bool_]:
        """Mark the columns that differ from what the base model, and the columns before them, can do, shape (q,)."""
        size = np.linalg.norm(columns, axis=1)
        mask = np.isfinite(size) & (size > 0)
        kept: list[Array] = []
        for i in np.flatnonzero(mask):
            rest = self.free((columns[i] / size[i])[None])[0]
            for other in kept:
                rest = rest - other * (other @ rest)
            length = float(np.linalg.norm(rest))
            if length**2 > _SEEN:
                kept.append(rest / length)
            else:
                mask[i] = False
        return np.asarray(mask, dtype=bool)

    def explained(self, columns: Array, lower: Array, upper: Array) -> tuple[float, Array]:
        """Return the explained sum of squares and the coefficients, as far as these may go.

        A coefficient that would pass its bounds is left out, as is a column that cannot be told from the others.
        """
        theta = np.zeros(len(columns))
        mask = self.visible(columns)
        while np.any(mask):
            free = self.free(columns[mask])
            scale = np.linalg.norm(free, axis=1)
            unit = free / scale[:, None]
            right = unit @ self.residual
            found = np.linalg.lstsq(unit @ unit.T, right, rcond=1e-10)[0]
            value = found / scale
            beyond = (value < lower[mask]) | (value > upper[mask])
            if not np.any(beyond):
                theta[mask] = value
                return float(found @ right), theta
            mask[np.flatnonzero(mask)[beyond]] = False
        return 0.0, theta

    def held_out(self, columns: Array) -> Array:
        """Return, for every row, the residual of a fit that did not use the row's block, shape (M,)."""
        size = np.linalg.norm(columns, axis=1)
        scaled = columns / np.where(size > 0, size, 1.0)[:, None]
        blocks = [slice(a, b) for a, b in zip(self._edges, self._edges[1:], strict=False)]
        grams = [scaled[:, block] @ scaled[:, block].T for block in blocks]
        rights = [scaled[:, block] @ self.target[block] for block in blocks]
        gram, right = np.sum(grams, axis=0), np.sum(rights, axis=0)
        residual = np.empty_like(self.target)
        for block, own_gram, own_right in zip(blocks, grams, rights, strict=True):
            theta = np.linalg.lstsq(gram - own_gram, right - own_right, rcond=1e-10)[0]
            residual[block] = self.target[block] - theta @ scaled[:, block]
        return residual

    def test(self, columns: Array, against: Regression | None = None) -> Evidence:
        """Test whether columns, all of them visible, belong to the model.

        Args:
            columns: shape (q, M).
            against: the regression without them, to which residual and loss are compared; this one by default.
        """
        without = against or self
        free = self.free(columns)
        scale = np.linalg.norm(free, axis=1)
        unit = free / scale[:, None]
        gram = unit @ unit.T
        inverse = np.linalg.pinv(gram, rcond=1e-10, hermitian=True)
        theta = inverse @ (unit @ self.residual)
        left = self.residual - theta @ unit
        q = len(columns)
        variance = inverse @ long_run_sum(unit * left, self.terms) @ inverse
        from scipy.stats import f as fisher

        freedom = max(self.terms - q + 1, 1)
        statistic = float(theta @ np.linalg.pinv(variance, rcond=1e-12, hermitian=True) @ theta)
        p_value = float(fisher.sf(statistic * freedom / (self.terms * q), q, freedom))
        loss = self.held_out(np.vstack([self.base, columns])) ** 2
        gain, gain_p = compare(without.loss, loss, self.terms)
        total = float(without.residual @ without.residual)
        return Evidence(
            theta / scale,
            variance / np.outer(scale, scale),
            p_value,
            1 - float(left @ left) / total if total > 0 else 0.0,
            gain,
            gain_p,
            loss,
            left,
        )


def cosine_terms(independent: float, rows: int) -> int:
    """Return the number ν of cosines for T independent rows: 0.4 T^(2/3), at least 8."""
    return int(np.clip(round(0.4 * independent ** (2 / 3)), min(8, rows - 1), rows - 1))


def long_run_sum(series: Array, terms: int) -> Array:
    """Return the covariance of the sum over time of series, shape (q, M) → (q, q), by ν equal-weighted cosines."""
    from scipy.fft import dct

    projected = dct(series, type=2, axis=1)[:, 1 : terms + 1] / 2
    return np.asarray(2.0 * projected @ projected.T / terms)


def compare(loss: Array, other: Array, terms: int) -> tuple[float, float]:
    """Compare two series of squared held-out residuals.

    Returns:
        The share by which ``other`` has the lower RMS, and the one-sided p-value that it has not, by Student's t with
        ν degrees of freedom on the mean difference (Diebold and Mariano 1995).
    """
    from scipy.stats import t as student

    before, after = float(np.sum(loss)), float(np.sum(other))
    gain = 1 - np.sqrt(after / before) if before > 0 else 0.0
    difference = loss - other
    spread = float(np.sqrt(long_run_sum((difference - difference.mean())[None], terms)[0, 0]))
    if spread == 0:
        return float(gain), 1.0
    return float(gain), float(student.sf(float(np.sum(difference)) / spread, terms))


def benjamini_yekutieli(p_values: Array) -> Array:
    """Adjust p-values for the number of tests under any dependence between them (Benjamini and Yekutieli 2001)."""
    count = len(p_values)
    if count == 0:
        return p_values
    order = np.argsort(p_values)
    harmonic = float(np.sum(1.0 / np.arange(1, count + 1)))
    raised = p_values[order] * count * harmonic / np.arange(1, count + 1)
    adjusted = np.empty(count)
    adjusted[order] = np.minimum(1.0, np.minimum.accumulate(raised[::-1])[::-1])
    return adjusted
