r"""How far an estimate may be off that is not least squares: by its distance to a fit that is.

A filter that has not converged, or that is biased, cannot know it: its own covariance says how much noise moves its
answer, not how far that answer is from the truth. The weak form of the same equation
(:mod:`fricmodels.weakform.estimate`) gives an unbiased value :math:`\hat\theta \pm s` from the same recording. At the
distance :math:`d = \tilde\theta - \hat\theta` the interval about the filter's :math:`\tilde\theta` that holds the
truth with 95 % has the half width w with

.. math:: \Phi\!\left(\frac{w-d}{s}\right) - \Phi\!\left(\frac{-w-d}{s}\right) = 0.95,

which is 1.96 s where the two agree and \|d\| + 1.645 s where the distance is large. The standard error is w/1.96, so
that it includes what is left to converge and the bias.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording

_LEVEL = 0.95
_FAR, _WORTH_A_WORD = 8.0, 0.1
"""Standard errors of the weak form, and share of its value, beyond which an estimate is said not to have come near."""


@dataclass(frozen=True)
class About:
    """What an unbiased fit of the same equation says about an estimate.

    Attributes:
        covariance: by the distance to it; NaN in the rows and columns of parameters without an interval.
        reasons: of these, by key.
        far: of what is certainly far from it, by key: it has not converged, or is biased.
    """

    covariance: Array
    reasons: Mapping[str, str]
    far: Mapping[str, str] = field(default_factory=dict)


def about(drive: Drive, recording: Recording, parameters: Mapping[str, float], keys: Sequence[str]) -> About:
    """Compare an estimate with the weak-form fit of the same model.

    Args:
        drive: the model, and its inertia or ``None``.
        recording: with velocity, every sample finite.
        parameters: the estimate, in SI, by key. keys: those that were estimated, in the order of the covariance.
    """
    from fricmodels.weakform.estimate import estimate
    from fricmodels.weakform.inference import NORMAL_95
    from fricmodels.weakform.prepared import prepared

    nothing = np.full((len(keys), len(keys)), np.nan)
    try:
        _, reference = estimate(drive, prepared(recording))
    except FricmodelsError as error:
        return About(nothing, dict.fromkeys(keys, f"nothing to check it against: {error}"))
    known = [
        key for key in keys if math.isfinite(parameters[key]) and 0 < reference.standard_errors.get(key, 0.0) < math.inf
    ]
    reasons = {
        key: "nothing to check it against: the weak form of the equation does not determine it"
        for key in keys
        if key not in known
    }
    order = list(reference.standard_errors)
    rows = [order.index(key) for key in known]
    spread = np.array([reference.standard_errors[key] for key in known])
    distance = np.array([parameters[key] - reference.parameters[key] for key in known])
    square = np.outer(distance, distance)
    square += np.diag(spread**2) if reference.covariance is None else reference.covariance[np.ix_(rows, rows)]
    width = np.array([half_width(d, s) for d, s in zip(distance, spread, strict=True)])
    scale = width / NORMAL_95 / np.sqrt(np.diag(square))
    places = np.array([list(keys).index(key) for key in known], dtype=np.int64)
    nothing[np.ix_(places, places)] = square * np.outer(scale, scale)
    far = {
        key: f"not converged, or biased: least squares of the same equation give {reference.parameters[key]:.4g}"
        for key, d, s in zip(known, distance, spread, strict=True)
        if abs(d) > max(_FAR * s, _WORTH_A_WORD * abs(reference.parameters[key]))
    }
    return About(nothing, reasons, far)


def half_width(distance: float, spread: float) -> float:
    """Return w, for which the normal distribution of mean d and deviation s has 95 % within −w and w."""
    from scipy.optimize import brentq
    from scipy.special import ndtr

    away = abs(distance) / spread
    if away > _FAR:  # the far side is beyond rounding
        return abs(distance) + 1.6448536269514722 * spread
    return spread * float(brentq(lambda w: ndtr(w - away) - ndtr(-w - away) - _LEVEL, 0.0, away + 2.0))
