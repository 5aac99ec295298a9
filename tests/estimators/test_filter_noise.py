"""A Kalman filter counts noise that lasts as the white noise that says as little."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from estimators.ekf import ExtendedKalman
from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.filtering.preparation import velocity_noise
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate

INERTIA, VISCOUS, COULOMB = 1.8, 6.0, 9.0
DRIVE = Drive(Model.parse("coulomb-viscous"), INERTIA)
STEP = 0.03
"""Of a rounded velocity, and deviation of coloured noise times √12, as a share of the RMS velocity."""


def driven(seed: int) -> Recording:
    """Return a drive under a multisine at 1 kHz, without noise."""
    rng, time = np.random.default_rng(seed), 1e-3 * np.arange(8000)
    torque = sum(7.0 * np.sin(2 * np.pi * f * time + rng.uniform(0, 6)) for f in (0.3, 0.7, 1.3))
    return simulate(DRIVE, {"K_v": VISCOUS, "K_c": COULOMB}, time, torque, substeps=4)


def with_noise(kind: str, seed: int) -> Recording:
    """Return the drive with a velocity that was rounded, or that has white or coloured noise (AR 0.98)."""
    clean, rng = driven(seed), np.random.default_rng(seed + 100)
    size = STEP * float(np.sqrt(np.mean(clean.velocity**2)))
    white = rng.standard_normal(len(clean)) * size / math.sqrt(12.0)
    noise: dict[str, Array] = {
        "rounded": np.round(clean.velocity / size) * size - clean.velocity,
        "coloured": lfilter([math.sqrt(1.0 - 0.98**2)], [1.0, -0.98], white),
        "white": white,
    }
    channels = {**clean.channels, "velocity": clean.velocity + noise[kind]}
    return Recording(kind, Motion.ROTARY, channels, clean.run)


@pytest.mark.parametrize(("kind", "within"), [("white", 0.005), ("coloured", 0.01), ("rounded", 0.004)])
def test_friction_is_found_whatever_the_colour_of_the_noise(kind: str, within: float) -> None:
    for seed in range(3):
        fit = ExtendedKalman().fit(DRIVE, with_noise(kind, seed))
        assert fit.parameters["K_v"] == pytest.approx(VISCOUS, rel=within)
        assert fit.parameters["K_c"] == pytest.approx(COULOMB, rel=within)


def test_white_noise_counts_as_it_is_and_noise_that_lasts_for_more() -> None:
    """AR noise with coefficient a has a variance of means that is (1 + a)/(1 − a) times that of white noise."""
    size = STEP / math.sqrt(12.0) * float(np.sqrt(np.mean(driven(0).velocity ** 2)))
    counted = {kind: velocity_noise(with_noise(kind, 0)) / size for kind in ("white", "coloured")}
    assert counted["white"] == pytest.approx(1.0, rel=0.1)
    assert counted["coloured"] == pytest.approx(math.sqrt(1.98 / 0.02), rel=0.4)
