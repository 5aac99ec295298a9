r"""How far a parameter may be off by what is left of the rows, where a derivative does not say it.

What a contact does jumps with its parameters, as it opens and closes at samples. The squared error is a stair of many
small steps, and its slope within one of them says nothing of how far the parameter may go. So the likely values are
those that leave hardly more than the estimate,

.. math:: \frac{\nu}{f} \Bigl(\frac{S(p)}{S(\hat p)} - 1\Bigr) \le 1.96^2,

with all other nonlinear parameters as they are and the best linear ones; ν and f as in :mod:`.instants`. Where the
error is smooth they reach no further than 1.96 standard errors.

Source: likelihood ratios, as D. M. Bates, D. G. Watts, Nonlinear Regression Analysis (1988), §6.1.
"""

from __future__ import annotations

from collections.abc import Callable

from fricmodels.weakform.inference import NORMAL_95

_DOUBLINGS, _MISSES, _HALVINGS = 30, 3, 5
"""Steps that double, how many may be unlikely one after the other, and by how many halvings the last one is refined."""
_FURTHEST = 10.0
"""Times the value beyond which nothing is tried."""
_LEAST = 1e-6
"""First step, as a share of the value, where there is no standard error."""


def likely_error(
    cost: Callable[[float], float], value: float, error: float, bounds: tuple[float, float], certain: float
) -> float:
    """Return the distance to the furthest likely value either way, over 1.96.

    Args:
        cost: squared error with another value.
        value, error: the estimate and its standard error.
        bounds: of the parameter.
        certain: ν / f.
    """
    most = cost(value) * (1.0 + NORMAL_95**2 / certain)

    def is_likely(step: float) -> bool:
        return bounds[0] <= value + step <= bounds[1] and cost(value + step) <= most

    first = error or _LEAST * abs(value)
    furthest = (_furthest(is_likely, side * first, _FURTHEST * abs(value)) for side in (-1.0, 1.0))
    return max(furthest) / NORMAL_95


def _furthest(is_likely: Callable[[float], bool], first: float, end: float) -> float:
    """Return the size of the furthest likely step in one direction; 0 where there is none."""
    far, step, missed = 0.0, first, 0
    for _ in range(_DOUBLINGS):
        if abs(step) > end or missed == _MISSES:
            break
        far, missed = (step, 0) if is_likely(step) else (far, missed + 1)
        step *= 2.0
    beyond = 2.0 * far
    for _ in range(_HALVINGS if far else 0):
        middle = 0.5 * (far + beyond)
        far, beyond = (middle, beyond) if is_likely(middle) else (far, middle)
    return abs(far)
