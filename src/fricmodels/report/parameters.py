"""The parameters of a model in a report: a table, and which of them mean nothing by themselves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fricmodels.diagnosis.remarks import AT_BOUND, AT_END, MAY_BE_ZERO, NOT_IDENTIFIED, remarks
from fricmodels.dimension import Motion
from fricmodels.parameter import Parameter
from fricmodels.report.page import Table, table
from fricmodels.report.wording import declared, interval, listed, meaning_of, number, unit_of
from fricmodels.results.words import of_motion

if TYPE_CHECKING:
    from fricmodels.results.comparison import Step


def parameters(
    model: str,
    values: Mapping[str, float | None],
    errors: Mapping[str, float | None],
    motion: Motion,
    caption: str,
    truth: Mapping[str, float] | None = None,
    said: Mapping[str, str] | None = None,
) -> Table:
    """Return parameters with 95 % intervals, units and meaning; beside them the truth, where it is known.

    What is ``said`` of them is found here where a document does not have it.
    """
    known = declared(model)
    said = said or remarks(known, values, errors)
    rows = []
    effects = len({key.rpartition(".")[0] for key in values})
    for key, value in values.items():
        middle, half = interval(value, errors.get(key))
        if key in said:
            half = ", ".join(filter(None, (half, said[key])))
        elif not half:
            half = "given" if errors.get(key) is None and key in ("J", "M") else "not determined"
        own = (number(truth[key], 4) if key in truth else "–",) if truth else ()
        meaning = of_motion(_meaning(key, known, effects > 1), motion)
        rows.append((key, middle, half, *own, unit_of(key, known, motion), meaning))
    titles = {"parameter": False, "value": True, "95 % interval": True} | ({"truth": True} if truth else {})
    return table(caption, titles | {"unit": False, "meaning": False}, rows, symbols=True)


def _meaning(key: str, known: Mapping[str, Parameter], named: bool) -> str:
    effect = key.rpartition(".")[0]
    return f"{meaning_of(key, known)} ({effect})" if effect and named else meaning_of(key, known)


def fitted(step: Step, motion: Motion) -> Table:
    """Return the table of a model's parameters."""
    return parameters(step.model, step.parameters, step.standard_errors, motion, step.model, said=step.remarks)


def undetermined(last: Step) -> list[str]:
    """Say which parameters of a model mean nothing by themselves, and why; empty where there are none."""
    errors, reasons = last.standard_errors, last.not_identified
    said = last.remarks or remarks(declared(last.model), last.parameters, errors)
    held, ends, weak = ([key for key, text in said.items() if text == kind] for kind in (AT_BOUND, AT_END, MAY_BE_ZERO))
    loose = {key: reasons.get(key, "") for key, text in said.items() if text.startswith(NOT_IDENTIFIED)}
    loose |= {key: "" for key, error in errors.items() if not error and key not in said}
    points = [f"{key} is not determined: {reason}." for key, reason in loose.items() if reason]
    if silent := [key for key, reason in loose.items() if not reason]:
        points.append(f"Not determined by this recording: {listed(silent)}.")
    if held:
        points.append(f"At the end of what is physical: {listed(held)}; the data alone would go beyond it.")
    if ends:
        points.append(
            f"At the end of what was sought: {listed(ends)}. This recording does not tell what lies beyond, and the "
            "other parameters may be off with it; sample faster, or move farther."
        )
    if weak:
        points.append(f"{listed(weak)} cannot be distinguished from zero: the 95 % interval includes it.")
    return points
