"""Parameters from windows of several lengths at once, each weighed by what it leaves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from fricmodels import Recording
from fricmodels.drive import Drive
from fricmodels.motion import Simulator
from fricmodels.motion.fit import Problem
from fricmodels.motion.search import searched

_ROUNDS, _SETTLED = 3, 0.03


def in_several_lengths(
    drive: Drive, recording: Recording, start: Mapping[str, float], halvings: Iterable[int]
) -> dict[str, float]:
    r"""Return what makes :math:`\sum_l \log \sum_k e_{l,k}^2` small, e the error in windows of the l-th length.

    Each length counts by the ratio of its error, as in the likelihood of independent bands of a coloured force.

    Args:
        drive: the model. recording: prepared, of one run. start: parameters to begin from.
        halvings: how often the record is halved for each length; 0 is the record in one piece.
    """
    lengths = [None if number == 0 else len(recording) // 2**number for number in halvings]
    problems = [Problem.of(Simulator(drive, recording, horizon=length)) for length in lengths]
    first, at = problems[0], problems[0].at(start)

    def left(x: np.ndarray) -> np.ndarray:
        return np.array([float(np.sqrt(np.mean(problem.residual(x) ** 2))) for problem in problems])

    size = left(at)
    for _ in range(_ROUNDS):
        given = size

        def residual(x: np.ndarray, given: np.ndarray = given) -> np.ndarray:
            return np.concatenate([p.residual(x) / own for p, own in zip(problems, given, strict=True)])

        at = searched(residual, [at], first.size, first.bounds, most=30, kinks=False).at
        size = left(at)
        if np.allclose(size, given, rtol=_SETTLED):
            break
    return first.values(at)
