"""Whatever somebody does to a model file, reading it works or is one line; nothing else comes out."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import fricmodels
from fricmodels.errors import InputError

STRANGE = [None, True, 0, -1, 3.5, 1e308, -1e-308, "", "cogging", "coulomb-viscous", "\x00", "a" * 5000, [], [1], {},
           {"a": 1}, [[]], 10**25, "nan", "../../etc"]  # fmt: skip


def places(value: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield at
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in inner:
        yield from places(item, (*at, key))


def spoilt(content: Any, at: tuple[Any, ...], how: str, value: Any) -> Any:
    if not at:
        return value
    copy = json.loads(json.dumps(content))
    inner = copy
    for key in at[:-1]:
        inner = inner[key]
    if how == "remove":
        del inner[at[-1]]
    else:
        inner[at[-1]] = value
    return copy


@pytest.mark.parametrize("name", ["coulomb-viscous+other-friction(j2_velocity)", "exponential-stick-slip+run-offset"])
def test_a_spoilt_file_is_read_or_refused(kept: Callable[..., Any], tmp_path: Path, name: str) -> None:
    content = json.loads(kept(name).document.to_json())
    everywhere, chance, path = list(places(content)), random.Random(5), tmp_path / "x.model.json"
    refused = []
    for _ in range(250):
        at, how = chance.choice(everywhere), chance.choice(["replace", "replace", "remove"])
        path.write_text(json.dumps(spoilt(content, at, how, chance.choice(STRANGE))), encoding="utf-8")
        try:
            model = fricmodels.load(path)
        except InputError as error:
            refused.append(str(error))
        else:
            repr(model)
            assert json.loads(model.document.to_json())["schema"] == "fricmodels/model/1"
    assert len(refused) > 50
    assert not any("\n" in message for message in refused)


def test_a_cut_file_is_refused(kept: Callable[..., Any], tmp_path: Path) -> None:
    text, path = kept("coulomb-viscous").document.to_json(), tmp_path / "x.model.json"
    for end in range(0, len(text) - 2, 97):
        path.write_text(text[:end], encoding="utf-8")
        with pytest.raises(InputError):
            fricmodels.load(path)
