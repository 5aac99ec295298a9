r"""Statistics that hold for autocorrelated rows.

A candidate's columns Z are freed of everything that the base model could itself take up: :math:`\tilde Z = Z - X
X^+Z`. Its coefficients are then :math:`\hat\theta = (\tilde Z'\tilde Z)^{-1}\tilde Z'y`, and their covariance is the
sandwich around the long-run variance of the scores :math:`\tilde z_t e_t`, estimated by ν equal-weighted cosines; the
Wald statistic follows :math:`F(q, \nu-q+1)`.

Source: E. Lazarus, D. J. Lewis, J. H. Stock, M. W. Watson, "HAR inference: recommendations for practice", J. Bus. Econ.
Stat. 36 (2018), with ν = 0.4 T^(2/3).
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.weakform.long_run import FEWEST_TERMS, cosine_terms, long_run_sum

FOLDS = 8
_SEEN = 1e-5
"""A column of which less than this share (squared) is left outside the base directions cannot be told from them."""

LEAST_P = 1e-20
"""The least p-value that is given. The distribution of a statistic is not known farther out, and what stood there would
change with the last digits of a sample."""

unwarned = np.errstate(invalid="ignore", over="ignore")
"""A column that is not finite is not visible; its products need no warning."""


def to_order_by(value: float) -> float:
    """Return a number to eight digits: what differs by rounding alone keeps its order on any processor."""
    return float(f"{value:.8g}")


@dataclass(frozen=True)
class Evidence:
    """What speaks for a set of columns.

    Attributes:
        coefficients, covariance: of the columns.
        p_value: of the Wald test that all coefficients are zero.
        p_once: the same with what repeats counted once, see :mod:`.repeats`; never less. An effect is judged by it.
        explained: share of the base model's squared residual that the columns explain.
        gain: share by which they lower the RMS of the residual on blocks that were not used for fitting them.
        gain_p_value: that the gain is zero or less, one-sided.
        loss: squared held-out residual of each row with the columns, shape (M,).
    """

    coefficients: Array
    covariance: Array
    p_value: float
    p_once: float
    explained: float
    gain: float
    gain_p_value: float
    loss: Array

    @property
    def left(self) -> float:
        """Sum of the loss, to order by."""
        return to_order_by(float(np.sum(self.loss)))


@dataclass(frozen=True)
class ProjectedGram:
    """Inner products of columns freed of base directions: what their least squares need.

    Attributes:
        gram: of the columns with each other, shape (q, q).
        power: of each column with itself before it was freed, shape (q,).
    """

    gram: Array
    power: Array

    @cached_property
    def kept(self) -> list[int]:
        """The columns of which enough is left, beside the base directions and the columns before them."""
        from fricmodels.kernels.small import visible

        count = len(self.power)
        kept = np.empty(count, dtype=np.int64)
        there = visible(self.gram, self.power, _SEEN, np.ones(count, np.bool_), np.empty((count, count)), kept)
        return kept[:there].tolist()  # type: ignore[no-any-return]

    def explained(self, right: Array, lower: Array, upper: Array) -> tuple[float, Array]:
        """Return the explained sum of squares and the coefficients, as far as these may go.

        Args:
            right: products of the columns with the base model's residual, shape (q,).
            lower, upper: bounds of the coefficients, shape (q,).
        """
        from fricmodels.kernels.small import explained_within

        theta, asked = np.zeros(len(right)), np.ones(len(right), np.bool_)
        gained = explained_within(self.gram, self.power, _SEEN, right, lower, upper, asked, theta)
        return gained, theta


SAME = 1e-9
"""A direction of which less than this share is left outside the base directions is one of them."""


class Regression:
    """The base model's regression, against which candidates are tested.

    Args:
        base: base directions, shape (k, M).
        target: shape (M,).
        independent: about how many of the M rows are independent.
        parts: in which part of what repeats each row lies, shape (M,); ``None`` where nothing repeats.
        rounding: what the steps of the torque's sensor may have made of the target, shape (places, M).
    """

    def __init__(
        self,
        base: Array,
        target: Array,
        independent: float,
        parts: Index | None = None,
        rounding: Array | None = None,
    ) -> None:
        size = np.linalg.norm(base, axis=1)
        self.base = base[size > 0] / size[size > 0, None]
        self.target = target
        left, singular, _ = np.linalg.svd(self.base.T, full_matrices=False)
        self._basis = left[:, singular > SAME * singular[0]] if len(singular) else left
        self._independent = independent
        self._rounding = np.zeros((0, len(target))) if rounding is None else rounding
        # Rows that the base directions leave free are all there is to learn a variance from.
        self.terms = self._terms(independent, len(target))
        self._once = self._counted_once(parts)
        self.terms_once = self._once[2] if self._once is not None else self.terms
        self.residual = self.project_out(target[None])[0]
        self._edges = np.linspace(0, len(target), FOLDS + 1).astype(int)
        self.loss = self.residual**2

    def _terms(self, independent: float, rows: int) -> int:
        """Return how many cosines a variance is estimated by, of so many independent rows."""
        free = max(int(independent) - int(self._basis.shape[1]), 1)
        return min(cosine_terms(independent, rows), free)

    def _counted_once(self, parts: Index | None) -> tuple[Index, float, int] | None:
        """Return the parts, about how many of them are independent, and the cosines; ``None`` where these are few."""
        if parts is None or not len(parts):
            return None
        count = int(parts.max()) + 1
        independent = self._independent * count / len(parts)
        few = count == len(parts) or int(independent) - self._basis.shape[1] < FEWEST_TERMS
        return None if few else (parts, independent, self._terms(independent, count))

    @property
    def unshifted(self) -> Regression:
        """The regression for what is itself a shift in time, and has no other one beside it: this one."""
        return self

    def project_out(self, columns: Array) -> Array:
        """Project the base directions out of columns, shape (q, M)."""
        once = columns - (columns @ self._basis) @ self._basis.T
        return np.asarray(once - (once @ self._basis) @ self._basis.T)

    def beside(self, direction: Array) -> Regression:
        """Return the regression with one base direction more, shape (M,)."""
        size, own = float(np.linalg.norm(direction)), self.project_out(direction[None])[0]
        left = float(np.linalg.norm(own))
        other = copy(self)
        if left > SAME * size:
            other.base = np.vstack([self.base, direction / size])
            other._basis = np.column_stack([self._basis, own / left])
            other.residual = other.project_out(self.target[None])[0]
            other.loss = other.residual**2
        return other

    def less(self, part: Array) -> Regression:
        """Return the regression of what is left of the target without a part that is known, shape (M,)."""
        other = copy(self)
        other.target = self.target - part
        other.residual = self.residual - self.project_out(part[None])[0]
        other.loss = other.residual**2
        return other

    def visible(self, columns: Array) -> Mask:
        """Mark the columns that differ from what the base model, and the columns before them, can do, shape (q,)."""
        mask = np.zeros(len(columns), dtype=bool)
        mask[self.projected_gram(columns).kept] = True
        return mask

    @unwarned
    def explained(self, columns: Array, lower: Array, upper: Array) -> tuple[float, Array]:
        """Return the explained sum of squares and the coefficients, as far as these may go.

        A coefficient that would pass its bounds is left out, as is a column that cannot be told from the others.
        """
        return self.projected_gram(columns).explained(columns @ self.residual, lower, upper)

    @unwarned
    def projected_gram(self, columns: Array) -> ProjectedGram:
        """Return the products of columns, shape (q, M), that remain without the base directions."""
        inside, whole = columns @ self._basis, columns @ columns.T
        return ProjectedGram(whole - inside @ inside.T, np.diag(whole))

    def held_out(self, free: Array) -> Array:
        """Return, for every row, the residual with coefficients that did not use the row's block, shape (M,).

        The base model is fitted to all rows with and without the columns alike. Were it refitted to each rest, a block
        into which it has to extrapolate would hide what the columns do.

        Args:
            free: columns freed of the base directions, shape (q, M).
        """
        size = np.linalg.norm(free, axis=1)
        scaled = free / np.where(size > 0, size, 1.0)[:, None]
        blocks = [slice(a, b) for a, b in zip(self._edges, self._edges[1:], strict=False)]
        grams = [scaled[:, block] @ scaled[:, block].T for block in blocks]
        rights = [scaled[:, block] @ self.residual[block] for block in blocks]
        gram, right = np.sum(grams, axis=0), np.sum(rights, axis=0)
        residual: Array = np.empty_like(self.residual)
        for block, own_gram, own_right in zip(blocks, grams, rights, strict=True):
            theta = np.linalg.lstsq(gram - own_gram, right - own_right, rcond=1e-10)[0]
            residual[block] = self.residual[block] - theta @ scaled[:, block]
        return residual

    @unwarned
    def test(self, columns: Array, against: Regression | None = None) -> Evidence:
        """Test whether columns, all of them visible, belong to the model.

        Of a column next to nothing the coefficient may be any number, and its variance infinite.

        Args:
            columns: shape (q, M).
            against: the regression without them, to which residual and loss are compared; this one by default.
        """
        without = against or self
        free = self.project_out(columns)
        scale = np.linalg.norm(free, axis=1)
        unit = free / scale[:, None]
        # Along orthonormal directions, as many as can be told: there the variance is well conditioned, and the p-value
        # does not hang on rounding, however alike the columns are.
        values, vectors = np.linalg.eigh(unit @ unit.T)
        kept = values > 1e-10 * values[-1]
        turn = vectors[:, kept] / np.sqrt(values[kept])
        directions = turn.T @ unit
        along = directions @ self.residual
        left = self.residual - along @ directions
        scores = directions * left
        rounded = self._rounding @ directions.T / math.sqrt(max(len(self._rounding), 1))
        by_steps = rounded.T @ rounded
        variance, p_value = self._wald(along, scores, by_steps, len(columns), self._independent, self.terms)
        p_once = p_value
        if self._once is not None:
            parts, independent, terms = self._once
            folded = np.array([np.bincount(parts, weights=row) for row in scores], dtype=float)
            other, p_of_parts = self._wald(along, folded, by_steps, len(columns), independent, terms)
            if p_of_parts > p_value:
                variance, p_once = other, p_of_parts
        theta = turn @ along
        loss = self.held_out(free) ** 2
        gain, gain_p = compare(without.loss, loss, self.terms)
        # Where few events decide, the mean difference has no variance to be told by.
        gain_p = min(gain_p, by_chance(np.add.reduceat(without.loss, self._edges[:-1]), 1.0 - gain))
        gain_p = min(gain_p, self._p_beside_the_largest(without.loss, loss))
        total = float(without.residual @ without.residual)
        return Evidence(
            theta / scale,
            turn @ variance @ turn.T / np.outer(scale, scale),
            p_value,
            p_once,
            1 - float(left @ left) / total if total > 0 else 0.0,
            gain,
            gain_p,
            loss,
        )

    def _p_beside_the_largest(self, loss: Array, other: Array) -> float:
        """Return the p-value of the gain, were it none in the block of the largest loss; 1 where it is none there.

        What is predicted best may be what speaks least: one large event, however well it is predicted, has all of the
        mean difference and of its variance, and hides what is gained all over the record.
        """
        largest = int(np.argmax(np.add.reduceat(loss, self._edges[:-1])))
        block = slice(self._edges[largest], self._edges[largest + 1])
        if not np.sum(other[block]) < np.sum(loss[block]):
            return 1.0
        without = other.copy()
        without[block] = loss[block]
        return compare(loss, without, self.terms)[1]

    def _wald(
        self, along: Array, scores: Array, by_steps: Array, q: int, independent: float, terms: int
    ) -> tuple[Array, float]:
        """Return the covariance of coefficients along orthonormal directions, and how probable they are by chance.

        Args:
            along: the coefficients, shape (k,).
            scores: directions times residual in independent order, shape (k, n).
            by_steps: covariance of the coefficients that the steps of a sensor make, which repeats with the motion.
            q: number of columns that the directions are of.
            independent, terms: about how many of the n are independent; cosines.
        """
        from scipy.special import fdtrc  # the upper tail of F

        # What was fitted took its share of the residual: as many degrees of freedom of the independent rows.
        gone = min(self._basis.shape[1] + q, 0.75 * independent)
        variance = long_run_sum(scores, terms) * (independent / (independent - gone)) + by_steps
        freedom = terms - q + 1
        if freedom <= 0:  # more columns than that prove nothing, whatever they explain
            return variance, 1.0
        statistic = float(along @ np.linalg.pinv(variance, rcond=1e-12, hermitian=True) @ along)
        return variance, float(fdtrc(q, freedom, max(statistic * freedom / (terms * q), 0.0)))


def by_chance(events: Array, left: float) -> float:
    r"""Return how probable it is at most that predictions of a few events leave no more than a share of their RMS.

    Each event, of size :math:`\sqrt{b_k}`, is predicted from the others. Were its prediction any from nothing to twice
    the event, independently, it would leave :math:`u_k \sqrt{b_k}` with u uniform between −1 and 1. That all together
    leave the share r has, for any m of them, at most the probability of these m, the volume of an ellipsoid in a cube:

    .. math:: P\Bigl(\sum_k w_k u_k^2 \le r^2\Bigr) \le \frac{\pi^{m/2}}{\Gamma(m/2 + 1)}
              \prod_{k \le m} \frac{r}{2\sqrt{w_k}}, \qquad w_k = b_k / \sum_j b_j

    The least over m, the largest first, is returned; for one event alone it is r.

    Args:
        events: sum of squares b of each.
        left: r.
    """
    sizes = np.sort(events)[::-1]
    total, least, product = float(np.sum(sizes)), 1.0, 1.0
    for m, size in enumerate(sizes[sizes > 0.0].tolist(), 1):
        product *= 0.5 * max(left, 0.0) / math.sqrt(size / total)
        least = min(least, math.pi ** (m / 2) / math.gamma(m / 2 + 1) * product)
    return least


def compare(loss: Array, other: Array, terms: int) -> tuple[float, float]:
    """Compare two series of squared held-out residuals.

    Returns:
        The share by which ``other`` has the lower RMS, and the one-sided p-value that it has not, by Student's t with
        ν degrees of freedom on the mean difference (Diebold and Mariano 1995).
    """
    from scipy.special import stdtr  # the lower tail of Student's t

    before, after = float(np.sum(loss)), float(np.sum(other))
    gain = 1 - np.sqrt(after / before) if before > 0 else 0.0
    difference = loss - other
    spread = float(np.sqrt(long_run_sum((difference - difference.mean())[None], terms)[0, 0]))
    if spread == 0:
        return float(gain), 1.0
    return float(gain), float(stdtr(terms, -float(np.sum(difference)) / spread))
