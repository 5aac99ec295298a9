"""What is compiled because NumPy has no call for it."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.kernels.small import sine_and_cosine


@pytest.mark.parametrize("largest", [1.0, 1e3, 9.9e5, 1e7])
def test_sine_and_cosine_are_right_to_two_units_of_the_last_digit(largest: float) -> None:
    """Against 19 digits, quarter and eighth turns and their neighbours among the angles."""
    rng = np.random.default_rng(1)
    turns = np.round(np.linspace(-largest, largest, 4001) / (np.pi / 4)) * (np.pi / 4)
    angle = np.concatenate([rng.uniform(-largest, largest, 4000), turns, np.nextafter(turns, 0.0), [0.0, 1e-300]])
    both = np.empty((2, len(angle)))
    sine_and_cosine(angle, both)
    exact = np.array([np.sin(angle.astype(np.longdouble)), np.cos(angle.astype(np.longdouble))])
    assert np.finfo(np.longdouble).nmant > 60
    assert np.max(np.abs(both - exact) / np.spacing(np.abs(exact.astype(float)))) < 2.5


def test_the_sine_of_what_is_no_number_is_none() -> None:
    angle, both = np.array([0.5, np.nan, np.inf, -np.inf]), np.empty((2, 4))
    sine_and_cosine(angle, both)
    np.testing.assert_array_equal(both, [[np.sin(0.5), *[np.nan] * 3], [np.cos(0.5), *[np.nan] * 3]])
