"""A constant torque in each run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmodels.drive import Drive
from fricmodels.expressions import Expression, where
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.recording import RUN, Recording, channel_of
from fricmodels.results.experiments import MORE_RUNS
from fricmodels.signals.switched import one_value_in_each
from fricmodels.term import Effect, Law, Parameters, Signals, Term

_WITHIN = 1e-9
"""A constant of which less than this share (squared) lies outside of what other terms can do is one of theirs."""


class RunOffset(Effect):
    r"""A constant torque in each run, another one in every run: a torque sensor that was zeroed anew.

    .. math:: \tau = \tau_r \text{ in run } r

    Where the other terms of a model can make a constant by themselves, as an offset or an asymmetric law does, the
    offsets are counted from that of the last run. Of a run that it was not fitted to nothing is known beforehand; see
    :func:`fricmodels.score.zeroed.zeroed` for how such a run is scored.

    Args:
        runs: numbers of the runs that the parameters are of.
        reference: number of the run from which the offsets are counted; none if each is counted from zero.

    Source: Elementary; the fixed effects of an analysis of variance.
    """

    name = "run-offset"
    formula = "τ = τ_r in run r"
    signature = "a constant that is another one in every run"
    needs_motion = "several runs, each with motion in both directions"
    separated_from = {"drift": MORE_RUNS, "step-change": MORE_RUNS, "torque-offset": MORE_RUNS}
    absent = "the recording is a single run, or each run has one torque, of its own"
    symmetry = "even"
    channels = (RUN,)

    def __init__(self, runs: Sequence[int] = (0, 1), reference: int | None = None) -> None:
        self.runs = tuple(runs)
        self.reference = reference
        self.fitted_runs = frozenset(self.runs) | ({reference} if reference is not None else set())
        counted = "" if reference is None else f" less that of run {reference}"
        self.parameters = tuple(
            Parameter(f"tau_{run}", unit="N m", meaning=f"offset of run {run}{counted}") for run in self.runs
        )

    @classmethod
    def candidates(cls, recording: Recording) -> Sequence[RunOffset]:
        """Return the effect of the runs of a recording, if there are several.

        None of step responses, each a run with a command of its own, which is a constant of that run as its offset is.
        """
        runs = _runs(recording)
        return [cls(runs)] if len(runs) > 1 and not _is_constant_of_run(recording) else []

    def on(self, recording: Recording, beside: Sequence[Term] = ()) -> RunOffset:
        """Return the effect of the runs that a recording was made in, beside other terms of the model."""
        runs = _runs(recording)
        return RunOffset(runs[:-1], runs[-1]) if _make_a_constant(beside, recording) else RunOffset(runs)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the offset of the run that a sample lies in."""
        return sum(getattr(p, f"tau_{run}") * where(s[RUN] == run, 1, 0) for run in self.runs)


def _is_constant_of_run(recording: Recording) -> bool:
    """Whether the torque has one value in each run, and not one in all: of drives that coast it is 0 throughout."""
    torque, run = recording.torque, recording.run
    return one_value_in_each(torque, run) and not one_value_in_each(torque, np.zeros_like(run))


def _runs(recording: Recording) -> list[int]:
    found: list[int] = np.unique(recording.signal(RUN)).astype(int).tolist()
    return found


def _make_a_constant(terms: Sequence[Term], recording: Recording) -> bool:
    """Whether terms of a model, the law among them, can together make a constant torque in a recording."""
    known = [t for t in terms if not t.states]
    laws = [t for t in known if isinstance(t, Law)]
    model = Model(laws[0], [t for t in known if isinstance(t, Effect)]) if laws else None
    if model is None or not all(s == "motor_torque_rate" or channel_of(s) in recording for s in model.required):
        return False
    columns, _ = Drive(model).regressors(recording, [p.declared.initial for p in model.nonlinear_parameters])
    ones = np.ones(len(recording))
    left = ones - np.linalg.lstsq(columns.T, ones, rcond=None)[0] @ columns
    return bool(left @ left < _WITHIN * len(ones))
