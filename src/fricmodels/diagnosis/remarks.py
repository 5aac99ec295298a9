"""What is said of a parameter beside its value: the same words in a terminal, in a report and in a document."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.parameter import Parameter, at_bound
from fricmodels.results.words import CONTAINS_ZERO, HELD, NORMAL_95
from fricmodels.weakform.candidate import within_recording
from fricmodels.weakform.search import is_at_end

AT_BOUND, MAY_BE_ZERO, NOT_IDENTIFIED = "at its bound", "may be 0", "not identified"
AT_END = "at the end of what was sought"
_BY_KEPT_BACK = "by what was kept back"


def remarks(
    known: Mapping[str, Parameter],
    values: Mapping[str, float | None],
    errors: Mapping[str, float | None],
    reasons: Mapping[str, str] | None = None,
    kept_back: Collection[str] = (),
    beyond: Mapping[str, float] | None = None,
) -> dict[str, str]:
    """Return the remark on each parameter that needs one, by key.

    The reason why it is not identified comes before its value: what is held at nothing is not said to be that.

    Args:
        known: how the parameters are declared.
        values, errors: estimates and standard errors.
        reasons: why parameters are not identified.
        kept_back: keys of what only the data kept back tell.
        beyond: what those at a bound would be without bounds, where that is certain.
    """
    held = at_bound(known, values)
    found = {}
    for key, value in values.items():
        if key in held:
            found[key] = AT_BOUND + (f"; about {beyond[key]:.2g} without bounds" if beyond and key in beyond else "")
        elif key in kept_back:
            found[key] = _BY_KEPT_BACK
        else:
            declared = known.get(key)
            never_zero = declared is not None and declared.lower > 0.0
            found[key] = _remark(value, errors.get(key) or 0.0, (reasons or {}).get(key, ""), never_zero=never_zero)
    return {key: text for key, text in found.items() if text}


def remarks_on(comparison: Comparison) -> dict[str, str]:
    """Return the remark on each parameter of a fitted model that needs one, by key.

    A time, a length or a speed that was sought may end where the recording tells no more, as at two samples. It has the
    least error there, and no interval about it holds; what the other parameters are hangs on it.
    """
    known, found = {p.key: p.declared for p in comparison.drive.parameters}, comparison.estimate
    said = remarks(
        known, found.parameters, found.own_errors, found.not_identified, found.told_by_kept_back, found.beyond
    )
    if comparison.drive.model.known.fixed:
        return said
    every = [p for p in comparison.drive.model.nonlinear_parameters if p.key not in said]
    sought = [p for p in every if p.declared.scan and not p.declared.constant]
    ends = {p.key: within_recording(comparison.problem, p.declared) for p in sought}
    return said | {key: AT_END for key, sizes in ends.items() if is_at_end(sizes, found.parameters[key])}


def _remark(value: float | None, error: float, reason: str, *, never_zero: bool) -> str:
    if reason and CONTAINS_ZERO not in reason:
        _, held, at = reason.partition(HELD)
        return f"{NOT_IDENTIFIED}, held at {at}" if held else NOT_IDENTIFIED
    if reason or (value is not None and abs(value) < NORMAL_95 * error):
        return NOT_IDENTIFIED if never_zero else MAY_BE_ZERO
    return ""
