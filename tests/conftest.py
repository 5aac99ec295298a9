"""Shared by tests of several rooms: recordings of a drive that follows a given motion, and a headless Chromium."""

from __future__ import annotations

import importlib
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

import numpy as np
import pytest
from hypothesis import settings
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.saved import FittedModel

if TYPE_CHECKING:
    from fricmodels.diagnosis import Ladder

settings.register_profile("any machine", deadline=None)  # how long one example takes says how busy the machine is
settings.load_profile("any machine")

Made = Callable[..., Recording]

INERTIA = 2.0
LAW = {"K_v": 0.5, "K_c": 3.0}
_FINE = 16
_FREQUENCIES = np.array([0.31, 0.77, 1.43, 2.71])
_AMPLITUDES = np.array([4.0, 3.0, 2.0, 1.0])


@pytest.fixture(scope="session")
def from_benchmarks() -> Iterator[Callable[[str], ModuleType]]:
    """``from_benchmarks("kills")`` returns that module of ``benchmarks/``, whose figures a test looks at."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parents[1] / "benchmarks"))
        yield importlib.import_module


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


class Demonstration(NamedTuple):
    """A file of the drive of ``fricmodels demo``, and what `improve` finds in it."""

    data: Path
    inertia: float
    ladder: Ladder


@pytest.fixture(scope="session")
def demonstration(tmp_path_factory: pytest.TempPathFactory) -> Demonstration:
    """Half of the recording of ``fricmodels demo``, improved once for all who look at the result."""
    from fricmodels.diagnosis import improve
    from fricmodels.readers import read
    from fricmodels.rig import write
    from fricmodels.rig.demonstration import hidden

    rig = hidden().model_copy(update={"samples": 7_500})
    data, _ = write(rig.simulate(), tmp_path_factory.mktemp("demonstration") / "joint.csv")
    return Demonstration(data, rig.inertia, improve(read(data), "coulomb-viscous", rig.inertia))


Kept = Callable[..., FittedModel]


@pytest.fixture(scope="session")
def kept() -> Kept:
    """``kept("coulomb-viscous+cogging", {"cogging.a": 0.5})`` returns a fitted model with these numbers, not fitted.

    What is not given is as declared, in the middle of its scan, or a number between its bounds.
    """
    from fricmodels.saved.results import document_of

    def build(
        name: str,
        values: Mapping[str, float] | None = None,
        *,
        inertia: float | None = INERTIA,
        motion: Motion = Motion.ROTARY,
        seed: int = 0,
        not_identified: Mapping[str, str] | None = None,
    ) -> FittedModel:
        rng = np.random.default_rng(seed)
        count = 400
        channels = {c: rng.uniform(-5, 5, count) for c in ("velocity", "position", "acceleration", "torque")}
        channels |= {"load_torque": rng.uniform(-2, 2, count), "temperature": rng.uniform(0, 40, count)}
        channels |= {f"other.j2_{c}": rng.uniform(-3, 3, count) for c in ("position", "velocity", "acceleration")}
        channels["time"] = np.arange(count) * 0.002
        units = {"other.j2_position": "rad", "other.j2_velocity": "rad/s", "other.j2_acceleration": "rad/s^2"}
        run = (np.arange(count) >= count // 2).astype(np.int64)
        recording = Recording("made up", motion, channels, run, units=units)
        drive = Drive(Model.parse(name).on(recording), inertia, motion)
        chosen = {drive.inertia_key: INERTIA}
        for p in reversed(drive.model.parameters):  # a stick torque comes before the slip torque that it is above
            own = p.declared
            low, high = max(own.lower, -1.0), min(own.upper, max(own.lower, -1.0) + 2.0)
            drawn = own.scan[len(own.scan) // 2] if own.scan else own.initial or float(rng.uniform(low, high))
            chosen[p.key] = max(drawn, chosen.get(p.at_least or "", -np.inf))
        for p in drive.model.parameters:
            if p.at_least:
                chosen[p.key] = max(chosen[p.key], 1.3 * chosen[p.at_least])
        chosen |= values or {}
        return FittedModel(
            document_of(drive, chosen, {}, recording, not_identified=not_identified or {}), "the model of a test"
        )

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
def without_browser() -> Callable[[str], NoReturn]:
    """Skip what needs a browser, saying why; or fail, where FRICMODELS_BROWSER=required says that there is one."""
    return pytest.fail if os.environ.get("FRICMODELS_BROWSER") == "required" else pytest.skip


@pytest.fixture(scope="session")
def chromium(without_browser: Callable[[str], NoReturn]) -> Iterator[Any]:
    try:
        from playwright import sync_api as playwright
    except ImportError:
        without_browser("the driver of the browser is not installed")
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        without_browser("there is no Chromium; install it with: apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=FLAGS, headless=True)
        yield browser
        browser.close()
