"""Recordings with hidden effects, drawn once for all tests of the challenge."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import pytest

from fricmodels.recording import Recording
from fricmodels.rig import Rig, random_rig

Draw = Callable[..., tuple[Rig, Recording]]


@lru_cache(maxsize=128)
def _drawn(effects: tuple[str, ...], seed: int, options: tuple[tuple[str, object], ...]) -> tuple[Rig, Recording]:
    rig = random_rig(np.random.default_rng([seed, len(effects)]), effects, **dict(options))
    return rig, rig.simulate()


@pytest.fixture(scope="session")
def hidden() -> Draw:
    """``hidden("cogging", seed=3, size=0.2)`` returns the rig and its recording; options are those of random_rig."""

    def draw(*effects: str, seed: int = 0, **options: object) -> tuple[Rig, Recording]:
        return _drawn(effects, seed, tuple(sorted(options.items())))

    return draw
