"""The spectrum over position: known wave numbers, its limits, invariance to the origin and unit of position."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.signals.order_spectrum import LEAST_PERIODS, wave_numbers


def path(count: int = 4000) -> np.ndarray:
    """A motion that goes forth and back over 12 rad, at changing speed."""
    time = np.linspace(0.0, 1.0, count)
    return 6.0 * np.sin(2 * np.pi * 3.1 * time) + 0.5 * np.sin(2 * np.pi * 11.3 * time)


@settings(max_examples=30, deadline=None)
@given(k=st.floats(2.0, 60.0), phase=st.floats(0.0, 6.28), origin=st.floats(-1e3, 1e3), unit=st.floats(1e-3, 1e3))
def test_a_wave_is_found_within_the_resolution(k: float, phase: float, origin: float, unit: float) -> None:
    position = path()
    weights = np.cos(k * position + phase) * np.abs(np.gradient(position))
    found = wave_numbers((position + origin) * unit, weights, 80.0 / unit)
    assert found.resolution == pytest.approx(np.pi / np.ptp(position) / unit)
    assert abs(found.strongest[0] * unit - k) < found.resolution * unit


def test_two_waves_are_both_among_the_strongest() -> None:
    position = path()
    weights = (np.cos(7.3 * position) + 0.5 * np.sin(31.7 * position)) * np.abs(np.gradient(position))
    found = np.array(wave_numbers(position, weights, 60.0).strongest)
    assert min(abs(found - 7.3)) < 0.1
    assert min(abs(found - 31.7)) < 0.1


def test_nothing_slower_than_the_range_shows_is_returned() -> None:
    position = path()
    found = wave_numbers(position, np.cos(0.3 * position), 20.0)
    assert min(found.strongest) >= LEAST_PERIODS * 2 * np.pi / np.ptp(position)
    assert found.independent == pytest.approx((20.0 - 2 * np.pi * LEAST_PERIODS / np.ptp(position)) / found.resolution)


def test_faster_ones_that_were_looked_at_besides_come_first() -> None:
    """What is higher beyond the end of a range is no skirt of what lies within; both are kept."""
    position = path()
    weights = (0.3 * np.cos(7.3 * position) + np.sin(31.7 * position)) * np.abs(np.gradient(position))
    slower, faster = wave_numbers(position, weights, 20.0), wave_numbers(position, weights, 40.0, 20.0)
    assert faster.height > slower.height
    both = slower.and_faster(faster)
    assert both.strongest == (*faster.strongest, *slower.strongest)
    assert abs(both.strongest[0] - 31.7) < 0.1
    assert both.height == faster.height
    assert both.independent == pytest.approx(wave_numbers(position, weights, 40.0).independent)


def test_no_range_of_position_gives_no_wave_number() -> None:
    assert wave_numbers(np.zeros(100), np.ones(100), 10.0).strongest == ()
    assert wave_numbers(path(), np.ones(4000), 0.1).strongest == ()
