"""How wide test functions are for the noise of the velocity."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.recording import Recording
from fricmodels.weakform import test_functions
from fricmodels.weakform.row_noise import bump_width, momentum_noise

Made = Callable[..., Recording]


def noise_in_rows(recording: Recording, width: int) -> float:
    """Return the RMS torque that noise of the velocity adds to a row, over the RMS torque; J = 2 kg m²."""
    bumps = test_functions.TestFunctions(recording, width, np.zeros(len(recording), dtype=bool))
    noise = momentum_noise(bumps, recording)
    return float(2.0 * np.sqrt(np.mean(noise**2) / np.mean(recording.torque**2)) / recording.interval)


@pytest.mark.parametrize("noise", [0.01, 0.1])
def test_a_bump_leaves_many_of_its_width_where_noise_allows_it(made: Made, noise: float) -> None:
    recording = made(noise=noise, samples=1600, rate=1000.0)
    width = bump_width(recording, 2.0)
    assert width <= len(recording) // 40
    assert noise_in_rows(recording, width) < 0.02


def test_where_noise_is_loud_few_wide_bumps_say_more_than_many_narrow_ones(made: Made) -> None:
    recording = made(noise=2.0, samples=1600, rate=1000.0)
    width = bump_width(recording, 2.0)
    assert width > len(recording) // 40
    assert noise_in_rows(recording, width) <= 0.02 < noise_in_rows(recording, width - 8)
    assert len(recording) // bump_width(made(noise=50.0, samples=1600, rate=1000.0), 2.0) >= 8
