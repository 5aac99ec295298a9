"""Where a fit begins: what is nonlinear in an effect, searched for in what the model without the effect leaves.

A wave number, a delay or an instant must be near the truth for a fit of the whole model to find it. A wave over
position may be too fast for the rows, which then show another one; what is left from sample to sample shows it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.term import Effect
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.ripple import carriers_alone, fast_waves, of_waves
from fricmodels.weakform.search import search
from fricmodels.weakform.shifted import regression_of

_SMOOTH = 64
"""Samples that a test function spans where an effect with memory is searched for a second time: through narrower ones a
contact that closes a sample late is an error of its own, and the search may end where few are late, far from the truth;
through wider ones a gap that is crossed in a few samples shows nothing."""
_A_LINE = 0.05
"""Corrected p-value below which a fast wave is a place to begin from; what the fit leaves decides which place it is."""

Fitted = tuple[WeakFormProblem, Mapping[str, float]]


def starts_of(
    drive: Drive, start: Mapping[str, float], fit: Callable[[Drive, int | None], Fitted]
) -> list[Mapping[str, float]]:
    """Return parameters to begin from, by key: one place, or two where a wave may be slow or fast, or there is memory.

    Args:
        drive: the model, and the inertia if that is given.
        start: what is given.
        fit: fits a smaller drive with test functions that span so many samples; returns its rows and parameters.
    """
    keys = {p.key for p in drive.model_parameters if (not p.linear or p.declared.delay) and p.key not in start}
    for effect in reversed(drive.model.effects):
        if not any(f"{effect.name}.{p.symbol}" in keys for p in effect.parameters):
            continue
        smaller = Drive(drive.model.minus(effect.name), drive.inertia, drive.motion)
        found: list[Mapping[str, float]] = []
        for width in (None, _SMOOTH) if effect.states else (None,):
            try:
                problem, rest = fit(smaller, width)
            except InputError:
                if width is None:
                    raise
                continue  # its strokes have no room for test functions that wide
            ways = (_in_rows, _in_samples) if any(p.periodic for p in effect.parameters) else (_in_rows,)
            places = [way(drive, problem, rest, effect) for way in ways]
            found += [{**rest, **values, **start} for values in places if values]
        return found or [start]
    return [start]


def _in_rows(
    drive: Drive, problem: WeakFormProblem, rest: Mapping[str, float], effect: Effect
) -> Mapping[str, float] | None:
    """Return the nonlinear parameters with which an effect explains most of the rows."""
    found = search(problem, regression_of(problem, rest), effect, problem.alone(effect))
    if found is None:
        return None
    values = dict(zip(_nonlinear(drive, effect), found.nonlinear, strict=True))
    return {**values, **{f"{effect.name}.{p.symbol}": found.delay for p in effect.parameters if p.delay}}


def _in_samples(
    drive: Drive, problem: WeakFormProblem, rest: Mapping[str, float], effect: Effect
) -> Mapping[str, float] | None:
    """Return the wave number of an effect over position that is too fast for the rows, if there is such a wave."""
    keys = _nonlinear(drive, effect)
    if effect.states or len(keys) != 1:
        return None
    waves = fast_waves(problem, rest, _A_LINE, 0.0)
    if waves is None:
        return None
    rows = carriers_alone(problem, waves.carriers)
    found = of_waves(rows, regression_of(rows, rest), effect, rows.alone(effect), waves) if rows.rows else None
    return None if found is None else {keys[0]: found.nonlinear[0]}


def _nonlinear(drive: Drive, effect: Effect) -> list[str]:
    """Return the keys of an effect's nonlinear parameters."""
    linear = {p.key: p.linear for p in drive.model_parameters}
    keys = [f"{effect.name}.{p.symbol}" for p in effect.parameters]
    return [key for key in keys if not linear[key]]
