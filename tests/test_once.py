"""What is found once for an object is forgotten with it, and no interrupt is lost meanwhile."""

from __future__ import annotations

import gc
import sys
from types import FrameType
from typing import Any

import numpy as np

from fricmodels.once import once
from fricmodels.signals import noise_of
from fricmodels.weakform.remembered import Remembered


class Subject:
    """Anything that can be referred to weakly."""


def test_it_is_found_once_for_each_object() -> None:
    asked = []

    @once
    def found(subject: Subject, more: int = 0) -> int:
        asked.append(more)
        return len(asked)

    one, other = Subject(), Subject()
    assert [found(one), found(one), found(other), found(one, 3), found(one, 3)] == [1, 1, 2, 3, 3]


def test_no_python_code_runs_where_it_is_forgotten() -> None:
    """An interrupt within such code is printed and lost: the command runs on."""

    @once
    def found(subject: Subject) -> int:
        return 1

    subject = Subject()
    time = 0.01 * np.arange(500.0)
    values = np.sin(time) + 0.01 * np.random.default_rng(0).standard_normal(500)
    kept = Remembered(1000)
    kept("a", lambda: np.ones(3))
    found(subject)
    noise_of(time, values)
    called = []

    def profile(frame: FrameType, event: str, argument: Any) -> None:
        if event == "call":
            called.append(frame.f_code.co_name)

    gc.collect()
    sys.setprofile(profile)
    try:
        del subject, values, kept
    finally:
        sys.setprofile(None)
    assert called == []
