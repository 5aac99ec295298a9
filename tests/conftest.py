"""Shared by tests of several rooms: recordings of a drive that follows a given motion, and a headless Chromium."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording

Made = Callable[..., Recording]

INERTIA = 2.0
LAW = {"K_v": 0.5, "K_c": 3.0}
_FINE = 16
_FREQUENCIES = np.array([0.31, 0.77, 1.43, 2.71])
_AMPLITUDES = np.array([4.0, 3.0, 2.0, 1.0])


@pytest.fixture(scope="session")
def made() -> Made:
    """``made("coulomb-viscous+cogging", {"cogging.a": 0.5, "cogging.k": 7.3})`` returns a recording of such a drive.

    The motion is a multisine over several turns and many reversals; ``noise`` is that of the velocity in percent of
    its RMS value. Each sample of the torque is its mean over the sampling interval, as a current sensor gives it.
    """

    def build(
        name: str = "coulomb-viscous",
        values: Mapping[str, float] | None = None,
        *,
        noise: float = 0.05,
        seed: int = 0,
        samples: int = 8000,
        rate: float = 500.0,
        motion: Motion = Motion.ROTARY,
    ) -> Recording:
        rng = np.random.default_rng(seed)
        phases = rng.uniform(0, 2 * np.pi, len(_FREQUENCIES))

        def moving(time: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
            omega = 2 * np.pi * _FREQUENCIES
            angles = omega[:, None] * time + phases[:, None]
            return {
                "time": time,
                "velocity": _AMPLITUDES @ np.sin(angles),
                "position": -(_AMPLITUDES / omega) @ np.cos(angles),
                "acceleration": (_AMPLITUDES * omega) @ np.cos(angles),
            }

        time = np.arange(samples) / rate
        between = (np.arange(_FINE) + 0.5) / _FINE - 0.5
        exact = moving((time[:, None] + between / rate).ravel())
        torque = exact["torque"] = INERTIA * exact["acceleration"]
        fine = Recording("exact", motion, exact, np.zeros(samples * _FINE, dtype=np.int64))
        drive = Drive(Model.parse(name), INERTIA, motion)
        chosen = {**{p.key: p.declared.initial for p in drive.model.parameters}, **LAW, **(values or {})}
        for _ in range(8 if "motor_torque" in drive.model.needs else 1):  # a ripple of the torque makes more ripple
            fine = fine.with_channels(torque=torque)
            torque = INERTIA * exact["acceleration"] + drive.friction(fine, chosen)
        measured = moving(time)
        del measured["acceleration"]
        size = noise / 100 * float(np.sqrt(np.mean(measured["velocity"] ** 2)))
        measured["velocity"] = measured["velocity"] + size * rng.standard_normal(samples)
        measured["position"] = measured["position"] + 0.01 * size * rng.standard_normal(samples)
        measured["torque"] = torque.reshape(samples, _FINE).mean(axis=1)
        return Recording("made", motion, measured, np.zeros(samples, dtype=np.int64))

    return build


FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api", reason="the driver of the browser is not installed")
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        pytest.skip("there is no Chromium; install it with: apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=FLAGS, headless=True)
        yield browser
        browser.close()
