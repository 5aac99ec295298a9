"""Arrays that are computed once, while there is room."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.weakform import remembered as module
from fricmodels.weakform.remembered import Remembered


def test_an_array_is_computed_once_while_there_is_room() -> None:
    calls: list[str] = []

    def compute(key: str, size: int) -> np.ndarray:
        def array() -> np.ndarray:
            calls.append(key)
            return np.full(size, float(len(key)))

        return remembered(key, array)

    remembered = Remembered(room=8 * 10)
    for _ in range(2):
        np.testing.assert_array_equal(compute("a", 6), np.ones(6))
        np.testing.assert_array_equal(compute("too large", 11), np.full(11, 9.0))
        np.testing.assert_array_equal(compute("bb", 4), np.full(4, 2.0))
    assert calls == ["a", "too large", "bb", "too large"]


def test_what_was_not_asked_for_longest_makes_room() -> None:
    calls: list[str] = []

    def array(key: str) -> np.ndarray:
        calls.append(key)
        return np.ones(4)

    remembered = Remembered(room=8 * 10)
    for key in ("a", "b", "a", "c", "a", "b"):
        remembered(key, lambda key=key: array(key))
    assert calls == ["a", "b", "c", "b"]


def test_what_is_remembered_cannot_be_changed() -> None:
    array = Remembered(room=100)("a", lambda: np.zeros(3))
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1


def test_all_together_hold_no_more_than_there_is_room_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that were given nothing new for longest forget; who is gone holds nothing."""
    monkeypatch.setattr(module, "_asked", type(module._asked)())
    monkeypatch.setattr(module, "TOGETHER", 8 * 10)
    monkeypatch.setattr(module, "STEP", 0)
    first, second, third = (Remembered(room=8 * 10) for _ in range(3))
    first("a", lambda: np.ones(4))
    second("a", lambda: np.ones(4))
    first("b", lambda: np.ones(1))
    third("a", lambda: np.ones(3))
    assert [each.held for each in (first, second, third)] == [40, 0, 24]
    third("b", lambda: np.ones(3))
    assert [each.held for each in (first, second, third)] == [0, 0, 48]
    del first, second
    third("c", lambda: np.ones(4))
    assert third.held == 80
    assert len(module._asked) == 1
