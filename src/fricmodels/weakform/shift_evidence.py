r"""What the rows of a fit say of a shift in time, of torque against motion and of reversals.

Instants may be exact, true to a twentieth of a sample, or shifted by anything up to a sample. A shift is then equally
probable anywhere within a sample either way; with none, it is normal about zero with a standard deviation s, of nothing
or a twentieth of a sample, and of a hundredth about half a sample where the torque is held: the samples of a controller
need no other clock. With an estimate n in units of what is possible before anything was measured, its variance V from
ν cosines, and :math:`S = V + s^2`,

.. math:: \ln\frac{P(\text{shift})}{P(s)} = \tfrac{\nu + 1}2 \ln\Bigl(1 + \frac{n^2}{\nu S}\Bigr)
          + \tfrac12 \ln(2\pi S)

summed over the nuisances, along the axes of their covariance.

Source: R. E. Kass, A. E. Raftery, "Bayes factors", J. Amer. Statist. Assoc. 90 (1995), with Student's t for a variance
that is estimated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.weakform.known_delay import TRUE_TO
from fricmodels.weakform.long_run import cosine_terms
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.solve import WITHIN, Solved, solve

STRONG = 3.0
"""Logarithm of 20 to 1: strong evidence on the scale of Kass and Raftery (1995)."""
_NO_FRICTION = 1e-9
"""A Coulomb torque of less than this share of the largest torque is none."""
_TRUE_TO, _HELD_TO = TRUE_TO / 2.0, 0.005
"""How true instants are if there is no shift, and if the torque is held: to a hundredth of a sample. In units of two
samples."""


def log_odds_of_held(found: Solved, *, reversals: bool = True) -> float:
    """Return the logarithm of how much more probable a torque that is held between samples is than another."""
    whole = log_odds_of_a_shift(found, reversals=reversals)
    of_held = log_odds_of_a_shift(found, reversals=reversals, than=0.5)
    return whole - of_held if math.isfinite(whole) and math.isfinite(of_held) else 0.0


def log_odds_of_a_shift(found: Solved, *, reversals: bool = True, than: float = 0.0) -> float:
    """Return the logarithm of how much more probable a shift is than instants that are true to a twentieth of a sample.

    Args:
        found: a fit with a small shift in time.
        reversals: whether their instants count as well, or only that of the torque against the motion. A smoothed
            velocity turns at another instant, whatever the recording.
        than: the shift of the torque against which it is judged [samples]; half a one is that of a held torque.
    """
    return _known(found, (reversals, than), lambda: _log_odds(found, reversals, than))


def log_odds_of_exact(found: Solved) -> float:
    """Return the logarithm of how much more probable exact instants are than some true to a twentieth of a sample."""

    def compute() -> float:
        along, variance, total = _axes(found, reversals=True, than=0.0)
        freedom = _freedom(found)
        known = variance > 0.0
        return float(np.sum(_odds(along[known], total[known], freedom) - _odds(along[known], variance[known], freedom)))

    return _known(found, "exact", compute)


def could_be_shifted(found: Solved) -> bool:
    """Whether there could be strong evidence for a shift of the torque against the motion, were only that known.

    The odds are greatest where the shift has no variance, or as much as leaves it known at all: no covariance is
    needed to say that there is none.
    """
    if not len(found.nuisances) or "motor_torque_rate" in found.problem.drive.model.needs:
        return False
    size = float(found.solution.theta[found.nuisances[-1]]) / (2 * found.problem.recording.interval)
    return bool(np.any(_odds(size, np.array([_TRUE_TO**2, 1.0 / (2 * math.pi)]), _freedom(found)) > STRONG))


def nearly_unshifted(found: Solved, plan: Plan) -> Solved:
    r"""Return the fit whose instants are true to a twentieth of a sample.

    With an estimate n of the nuisances with covariance V, and S of those of such instants, they are
    :math:`n^* = S(S + V)^{-1} n`, and :math:`S(S + V)^{-1}V` is left of their covariance: nothing is a shift that is
    known far worse than a twentieth of a sample, and one that is known far better is what it is. The other parameters
    move with them by least squares, :math:`G = -(X^TX)^{-1}X^TN`.

    Args:
        found: the fit with a small shift in time.
        plan: of the fit that is wanted.
    """
    some, held, left = _true_shifts(found)
    if not np.any(some):
        return found.once_more(plan, timing=False)
    fit = solve(found.problem, replace(plan, shifts=tuple(held.tolist())))
    moved = fit.moved_by(fit.solution.jacobian[found.nuisances[some]])
    return fit.changed(of_shifts=moved @ left @ moved.T)


def nearly_exact(found: Solved, exact: Solved) -> Solved:
    """Return :func:`nearly_unshifted` to first order, from the fit with exact instants: enough for standard errors."""
    some, held, left = _true_shifts(found)
    if not np.any(some):
        return exact
    moved = exact.moved_by(found.solution.jacobian[found.nuisances[some]])
    other = exact.changed(of_shifts=moved @ left @ moved.T)
    other.__dict__["values"] = exact.values - moved @ held[some]
    return other


def _true_shifts(found: Solved) -> tuple[Mask, Array, Array]:
    """Return which nuisances can be told, all of them at instants true to a twentieth of a sample, and what covariance
    is left of those that can.
    """
    sizes, some = _sizes(found)
    own = found.spread[np.ix_(found.nuisances, found.nuisances)]
    some, held = some & (np.diag(own) > 0.0), np.zeros(len(sizes))
    own = own[np.ix_(some, some)]
    true = np.diag((_TRUE_TO * sizes[some]) ** 2)
    gain = true @ np.linalg.inv(true + own)
    held[some] = gain @ found.solution.theta[found.nuisances[some]]
    return some, held, gain @ own


def _known(found: Solved, asked: Hashable, compute: Callable[[], float]) -> float:
    if asked not in found.known_odds:
        found.known_odds[asked] = compute()
    return found.known_odds[asked]


def _log_odds(found: Solved, reversals: bool, than: float) -> float:
    along, _, total = _axes(found, reversals, than)
    return float(np.sum(_odds(along, total, _freedom(found)))) if len(along) else -math.inf


def _axes(found: Solved, reversals: bool, than: float) -> tuple[Array, Array, Array]:
    """Return n along each axis of its covariance, there V, and V + s², of those that say anything."""
    (sizes, some), nuisances = _sizes(found), found.nuisances
    centre, true_to = np.zeros(len(nuisances)), np.full(len(nuisances), _TRUE_TO)
    if than and "motor_torque_rate" not in found.problem.drive.model.needs:
        centre[-1:], true_to[-1:] = than * found.problem.recording.interval, _HELD_TO
    some[:1] &= reversals
    nuisances, sizes, centre, true_to = nuisances[some], sizes[some], centre[some], true_to[some]
    own = found.spread[np.ix_(nuisances, nuisances)] / np.outer(sizes, sizes)
    estimate = (found.solution.theta[nuisances] - centre) / sizes
    seen = (np.diag(own) > 0.0) & np.any(found.solution.jacobian[nuisances] != 0.0, axis=1)
    own, true = own[np.ix_(seen, seen)], np.diag(true_to[seen] ** 2)
    total, axes = np.linalg.eigh(own + true)
    known = 2 * math.pi * total < 1.0  # what is known worse than all that is possible says nothing
    variance = np.einsum("ij,ij->j", axes, own @ axes)
    return (axes.T @ estimate[seen])[known], variance[known], total[known]


def _sizes(found: Solved) -> tuple[Array, Mask]:
    """Return the size of each nuisance that shifts by two samples, and whether it can be told at all."""
    sizes = np.full(len(found.nuisances), 2 * found.problem.recording.interval)
    if not len(sizes):
        return sizes, np.zeros(0, dtype=bool)
    sizes[0] = 2 * found.problem.friction_limits[1]  # in samples, times the Coulomb torque
    some = np.append(sizes[:1] > _NO_FRICTION * _largest_torque(found.problem.recording), np.ones(len(sizes) - 1, bool))
    # At its bound a shift is of unknown size, and speaks for none.
    some[-1] &= abs(found.shift) < WITHIN * found.problem.recording.interval
    return sizes, some


@once
def _largest_torque(recording: Recording) -> float:
    """Return the largest motor torque [N m or N]; of a drive that coasts what errors are told by."""
    return float(np.max(np.abs(recording.torque))) or recording.reference_torque


def _freedom(found: Solved) -> int:
    return cosine_terms(found.problem.independent, found.problem.rows)


def _odds(estimate: Array | float, variance: Array, freedom: int) -> Array:
    """Return the logarithm of how much more probable a shift anywhere is than one of a given variance."""
    squares = np.log1p(np.square(estimate) / (freedom * variance))
    return np.asarray(0.5 * (freedom + 1) * squares + 0.5 * np.log(2 * math.pi * variance))
