"""What is computed block by block, so that memory stays bounded, is what it was in one piece."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import balance, torque
from fricmodels.score.bands import torque_errors
from fricmodels.split import split
from fricmodels.weakform.prepared import ready

MODEL = "exponential-stick-slip"


def test_blocks_change_no_torque_error(made: Callable[..., Recording], monkeypatch: pytest.MonkeyPatch) -> None:
    train, test = split(ready(made(samples=3000)).remembering())
    drive = Drive(Model.parse(MODEL), 2.0)
    values = {"J": 2.0} | {p.key: max(p.declared.initial, 0.5) for p in drive.model_parameters}
    whole, errors = torque_errors(drive, values, train, test)
    filtered = torque.filtered_torque_error(drive, values, train, 7)
    monkeypatch.setattr(balance, "_BLOCK", 101)
    monkeypatch.setattr(torque, "_INTERVALS", 97)
    blocks, other = torque_errors(drive, values, train, test)
    for own, its in zip(blocks.bands, whole.bands, strict=True):
        np.testing.assert_allclose(dataclasses.astuple(own), dataclasses.astuple(its), rtol=1e-10)
    np.testing.assert_allclose(errors, other, rtol=1e-9, atol=1e-11 * float(np.max(np.abs(errors))))
    np.testing.assert_array_equal(torque.filtered_torque_error(drive, values, train, 7), filtered)


@pytest.mark.parametrize("of", ["velocity", "position"])
def test_moments_in_blocks_enter_a_balance_alike(of: balance.Source) -> None:
    rng = np.random.default_rng(1)
    first, second, step = rng.standard_normal((2, 20)), rng.standard_normal((2, 20)), rng.uniform(1.0, 2.0, 20)
    expected = []
    for one in (first, second):
        weighed = one * step
        expected.append(weighed[1, :-1] + weighed[0, 1:] if of == "position" else weighed.sum(axis=0))
    for size in (1, 3, 20):
        cut = [slice(start, min(start + size, 20)) for start in range(0, 20, size)]
        found = balance._in_balance(((part, first[:, part].copy(), second[:, part].copy()) for part in cut), step, of)
        np.testing.assert_array_equal(found, expected)
