"""Adds what is missing, refits, and repeats."""

from __future__ import annotations

from collections.abc import Iterable

from fricmodels.diagnosis.comparison import compare
from fricmodels.diagnosis.diagnose import examine, known_effects
from fricmodels.diagnosis.ladder import Ladder
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.diagnosis.search import Search
from fricmodels.model import Model
from fricmodels.progress import Cancelled, Token, Watcher, stage, watched
from fricmodels.recording import Recording
from fricmodels.split import Split


def improve(
    recording: Recording,
    model: Model | str,
    inertia: float | None = None,
    *,
    leave_out: Iterable[str] = (),
    progress: Watcher | None = None,
    token: Token | None = None,
    policy: Policy = POLICY,
    how: Split | None = None,
) -> Ladder:
    """Add the missing effect, refit everything, repeat until nothing is missing; then try to remove or exchange each.

    An effect stays only if it lowers the test error, on data that took no part in finding it.

    Args:
        recording: as read.
        model: law plus effects to begin from, or its name.
        inertia: J [kg m²] or M [kg]; estimated if not given.
        leave_out: effects that are not considered.
        progress: called with a :class:`~fricmodels.progress.Progress` at every part of the work.
        token: stops the work.
        policy: the constants that decide.
        how: what is kept back; blocks or runs spread over the record if not given.

    Raises:
        InputError: as :func:`fricmodels.diagnosis.diagnose`.
        Cancelled: when it was stopped; with the ladder so far, or the fitted model before there is one.
    """
    leave_out, model, comparison, search = known_effects(leave_out), Model.of(model), None, None
    with watched(progress, token):
        try:
            stage(f"fitting {model.name}")
            comparison = compare(recording, model, inertia, how=how)
            first = examine(comparison, leave_out=leave_out, policy=policy)
            search = Search({e.name for e in model.effects}, set(leave_out), policy, first)
            search.to_the_end()
        except KeyboardInterrupt:
            raise Cancelled(comparison if search is None else search.ladder(partial=True)) from None
    return search.ladder()
