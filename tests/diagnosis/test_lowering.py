"""A step of the ladder goes up to the rung with the lowest printed test error, and no further."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from fricmodels.diagnosis import ladder
from fricmodels.diagnosis.ladder import Rung


def fitted(error: float) -> Any:
    return SimpleNamespace(errors=SimpleNamespace(held_out_percent=error))


@pytest.mark.parametrize(
    ("errors", "kept", "left_out"),
    [
        ([5.0], "a", ""),
        ([12.0], "", "a"),
        ([10.0], "", "a"),
        ([12.0, 8.0], "ab", ""),  # two that help together
        ([5.0, 7.0], "a", "b"),
        ([5.0, 7.0, 6.0], "a", "b"),  # lower than the one before, and no better than the first alone
        ([5.0, 7.0, 4.0], "abc", ""),
        ([11.0, 12.0, 10.5], "", "a"),
    ],
)
def test_up_to_the_lowest_error(errors: list[float], kept: str, left_out: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ladder, "from_scratch", lambda comparison: comparison)
    first: Any = SimpleNamespace(comparison=fitted(10.0))
    search = ladder._Search(set(), set(), ladder.POLICY, first)
    step: Any = [(first, Rung(fitted(error), added=name)) for name, error in zip("abc", errors, strict=False)]
    assert "".join(rung.added for _, rung in search._lowering(step)) == kept
    assert "".join(search._superfluous) == left_out
    assert (left_out != "") == ("does not fall" in search.note)
