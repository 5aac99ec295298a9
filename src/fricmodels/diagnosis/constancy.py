r"""Whether an effect has one size all over the motion.

What is there acts by its equation at any time, in either direction, fast or slow, under much torque or little, and at
any place. What only resembles it does so in a part of the motion: an offset that stands for a torque
:math:`c\,|\dot\omega|` is too large where the drive hardly accelerates. So the torque u of the effect is given a size
of its own in each part g of the motion, beside all else that is in the model,

.. math:: u \to \sum_g \gamma_g\,u\,1_g,

and the effect is not what is missing if that explains much more on blocks that were not used for fitting.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import SAME, compare
from fricmodels.weakform.shifted import regression_of

_PARTS = 3
"""Parts of the motion by each channel, with as many rows each."""


def gain_of_own_sizes(result: CandidateTests, tested: CandidateTest, beside: Array) -> float:
    """Return how much more an effect explains with a size of its own in each part of the motion.

    Args:
        result: the residual.
        tested: the effect.
        beside: columns of all that is named beside it, shape (k, rows).

    Returns:
        The largest share of what it explains with one size, over the channels by which the motion is parted. Zero
        where none is significant. A shift in time is not judged: its size is a time and no torque.
    """
    if any(p.delay for p in tested.effect.parameters):
        return 0.0
    problem, policy = result.problem, result.policy
    regression = regression_of(problem, result.parameters, beside)
    columns = tested.found.columns
    columns = columns[regression.visible(columns)]
    if not len(columns):
        return 0.0
    torque = regression.test(columns).coefficients @ columns
    alone = regression.test(torque[None])
    explained = float(np.sum(regression.loss) - np.sum(alone.loss))
    if explained <= 0.0:
        return 0.0
    gains = []
    channels = list(_parts(problem))
    for part in channels:
        own = np.array([torque * (part == group) for group in range(int(part.max()) + 1)])
        size = np.linalg.norm(own, axis=1)
        own = own[size > SAME * np.max(size)]  # where the effect does nothing it has no size
        if not np.all(regression.visible(own)):
            continue
        apart = regression.test(own)
        _, p_value = compare(alone.loss, apart.loss, regression.terms)
        if p_value * len(channels) < policy.outpredicted_significance:
            gains.append(float(np.sum(alone.loss) - np.sum(apart.loss)) / explained)
    return max(gains, default=0.0)


def _parts(problem: WeakFormProblem) -> Iterator[Array]:
    """Yield to which part of the motion each row belongs, shape (rows,), by one channel after the other."""
    recording = problem.recording
    at = np.clip(problem.centre, 0, len(recording) - 1)
    yield (recording.velocity[at] > 0).astype(float)
    channels = [
        np.arange(len(at), dtype=float),
        np.abs(recording.velocity[at]),
        np.abs(recording["acceleration"][at]),
        np.abs(recording.driving_torque[at]),
    ]
    if "position" in recording:
        channels.append(recording["position"][at])
    for values in channels:
        edges = np.quantile(values, np.linspace(0.0, 1.0, _PARTS + 1)[1:-1])
        yield np.searchsorted(edges, values, side="right").astype(float)
