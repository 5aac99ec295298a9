"""What ties has one order: last digits, which differ between processors, decide nothing that is printed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.document import document
from fricmodels.recording import Recording


def test_candidates_that_tie_but_for_rounding_have_one_order(made: Callable[..., Recording]) -> None:
    diagnosis = diagnose(made(samples=4000, noise=0.5), "coulomb-viscous", 2.0)
    result = diagnosis.result
    assert result is not None
    first, second, *others = result.tested
    orders = set()
    for digit in (-1e-15, 1e-15):
        gain = first.evidence.gain + digit
        tied = replace(second, evidence=replace(second.evidence, gain=gain))
        changed = replace(diagnosis, result=replace(result, tested=(first, tied, *others)))
        orders.add(tuple(one.name for one in document(changed).candidates))
    assert len(orders) == 1
