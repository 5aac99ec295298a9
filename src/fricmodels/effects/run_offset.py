"""A constant torque in each run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmodels.expressions import Expression, where
from fricmodels.parameter import Parameter
from fricmodels.recording import RUN, Recording
from fricmodels.term import Effect, Parameters, Signals


class RunOffset(Effect):
    r"""A constant torque in each run, another one in every run: a torque sensor that was zeroed anew.

    .. math:: \tau = \tau_r \text{ in run } r, \qquad \sum_r \tau_r = 0

    What all runs have in common is a `torque-offset`; this is by how much each differs from the mean of all, so that
    the two are told from one another. The last is minus the sum of the others. Of a run that it was not fitted to
    nothing is known beforehand; see :func:`fricmodels.score.zeroed.zeroed` for how such a run is scored.

    Args:
        runs: numbers of the runs.

    Source: Elementary; the fixed effects of an analysis of variance, in contrasts to the mean.
    """

    name = "run-offset"
    formula = "τ = τ_r in run r, their sum 0"
    signature = "a constant that is another one in every run"
    needs_motion = "several runs, each with motion in both directions"
    separated_from = {"drift": "more runs, in another order", "step-change": "more runs, in another order"}
    absent = "the recording is a single run"
    symmetry = "even"
    channels = (RUN,)

    def __init__(self, runs: Sequence[int] = (0, 1)) -> None:
        self.runs = tuple(runs)
        self.parameters = tuple(
            Parameter(f"tau_{run}", unit="N m", meaning=f"offset of run {run} less the mean of all runs")
            for run in self.runs[:-1]
        )

    @classmethod
    def candidates(cls, recording: Recording) -> Sequence[RunOffset]:
        """Return the effect of the runs of a recording, if there are several."""
        found = cls().on(recording)
        return [found] if len(found.runs) > 1 else []

    def on(self, recording: Recording) -> RunOffset:
        """Return the effect of the runs that a recording was made in."""
        return RunOffset(np.unique(recording.signal(RUN)).astype(int).tolist())

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the offset of the run that a sample lies in."""
        run = s[RUN]
        torque: Expression = 0
        for number, parameter in zip(self.runs[:-1], self.parameters, strict=True):
            is_last = where(run == self.runs[-1], 1, 0)
            torque += getattr(p, parameter.symbol) * (where(run == number, 1, 0) - is_last)
        return torque
