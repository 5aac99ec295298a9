"""What the numbers of an answer do not say by themselves: what they hold for."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fricmodels.results.comparison import ComparisonDocument


def reservations(data: ComparisonDocument) -> str:
    """Return sentences, each with a space before it; empty where there are none."""
    return _of_other_runs(data) + _of_position(data)


def _of_other_runs(data: ComparisonDocument) -> str:
    if not data.offsets_of_runs:
        return ""
    several = data.offsets_of_runs > 1
    runs, they = (f"each of {data.offsets_of_runs} runs", "they were") if several else ("the run", "it was")
    return f" The offset of {runs} is taken from the run itself: as far as the model's file tells, {they} not fitted."


def _of_position(data: ComparisonDocument) -> str:
    if not data.integrated_position:
        return ""
    return (
        " No position was measured: what goes with it here goes with the integral of the velocity, from where each run "
        "begins, and is the same in another log only if that begins at the same place."
    )
