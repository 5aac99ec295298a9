"""Arrays that are computed once, while there is room."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from fricmodels.weakform.remembered import Remembered, Room


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


def test_owners_share_a_room_and_leave_it() -> None:
    room = Room(8 * 10)
    first, second = Remembered(room), Remembered(room)
    first("a", lambda: np.zeros(6))
    second("a", lambda: np.ones(4))
    assert first("a", lambda: np.ones(6)).sum() == 0
    second("b", lambda: np.zeros(4))  # in the place of what was asked for longest ago, its own
    assert second("a", lambda: np.full(4, 2.0)).sum() == 8  # and this in the place of the other's
    assert first("a", lambda: np.ones(1)).sum() == 1
    del second
    gc.collect()
    for key in range(9):
        first(key, lambda: np.zeros(1))
    assert first("a", lambda: np.zeros(1)).sum() == 1


def test_a_room_is_cleared_for_all() -> None:
    room = Room(8 * 10)
    first, second = Remembered(room), Remembered(room)
    first("a", lambda: np.zeros(5))
    second("a", lambda: np.zeros(5))
    room.clear()
    assert first("a", lambda: np.ones(5)).sum() == 5
    assert second("a", lambda: np.ones(5)).sum() == 5
    assert first("a", lambda: np.zeros(5)).sum() == 5
