"""What speaks against an effect that comes near to what remains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.contradiction import contradiction
from fricmodels.plugins import load
from fricmodels.recording import Recording

SAID = {"kind": "torque-delay", "severity": "warn", "text": "late", "remedy": "do not shift it before improve has told"}


def near(name: str, *, at_search_bound: bool = False) -> Any:
    found = SimpleNamespace(at_search_bound=at_search_bound)
    return SimpleNamespace(name=name, effect=load().effects[name](), found=found)


@pytest.fixture(scope="module")
def compared(made: Callable[..., Recording]) -> Comparison:
    return compare(made(samples=2000), "coulomb-viscous", 2.0)


@pytest.mark.parametrize(
    ("name", "channel", "speaks"),
    [
        ("torque-ripple", "position, in one stretch, along the motion", True),
        ("cogging", "position, in one stretch", True),
        ("cogging", "position", False),
        ("position-friction", "position, along the motion", False),
        ("torque-offset", "position", True),
        ("torque-gain", "motor torque", False),
        ("load-friction", "motor torque, along the motion", False),
        ("load-friction", "position", True),
        ("presliding", "position", False),
        ("joint-compliance", "its own course shortly before", False),
        ("stribeck", "speed, along the motion", False),
        ("drift", "time", False),
        ("sensor-delay", "rate of the motor torque", False),
        ("gravity", "", False),
    ],
)
def test_an_effect_of_another_channel_or_all_over_the_way(
    compared: Comparison, name: str, channel: str, speaks: bool
) -> None:
    assert bool(contradiction(compared, near(name), channel)) == speaks


def test_an_effect_at_the_end_of_what_is_sought_only_resembles(compared: Comparison) -> None:
    assert "end of what was sought" in contradiction(compared, near("presliding", at_search_bound=True), "position")


def test_what_the_log_check_says_not_to_shift_is_no_delay(compared: Comparison) -> None:
    known = {**compared.train.provenance, "findings": [SAID]}
    warned = replace(compared, train=replace(compared.train, provenance=known))
    assert "not to shift" in contradiction(warned, near("sensor-delay"), "rate of the motor torque")
