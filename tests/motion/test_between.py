"""Whether the torque is held between samples is found from the recording, and simulated so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.motion import Rung, Simulator, judged, motion_errors, torque_between_samples
from fricmodels.recording import Recording
from fricmodels.rig.draw import random_rig
from fricmodels.rig.rig import Rig
from fricmodels.simulation import simulate
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready

TRUE = {"J": 0.01, "K_v": 0.05, "K_c": 0.03}


def _recorded(between: Any, noise: float = 1e-5, count: int = 6000, step: float = 1e-3) -> Recording:
    """Return a drive that starts and stops under a torque that changes from sample to sample."""
    rng = np.random.default_rng(3)
    time = np.arange(count) * step
    torque = 0.15 * np.sin(3.0 * time) + 0.08 * np.sin(7.1 * time + 1.0)
    made = simulate(
        Drive(Model.parse("coulomb-viscous")), TRUE, time, torque, between_samples=between, with_position=True
    )
    measured = made["position"] + noise * rng.standard_normal(count)
    return ready(made.with_channels(derived=False, position=measured))


@pytest.mark.parametrize("between", ["linear", "held"])
def test_it_is_found_and_the_motion_is_nearer(between: Any) -> None:
    recording, drive = _recorded(between), Drive(Model.parse("coulomb-viscous"))
    assert torque_between_samples(drive, TRUE, recording) == between
    errors = {
        way: motion_errors(Simulator(drive, recording, between_samples=way), TRUE).position
        for way in ("linear", "held")
    }  # type: ignore[arg-type]
    assert errors[between] < 0.1 * max(errors.values())


def test_nothing_is_said_where_nothing_can_be_told() -> None:
    """Too few windows, and a noise that hides half a sample."""
    drive = Drive(Model.parse("coulomb-viscous"))
    assert torque_between_samples(drive, TRUE, _recorded("held", count=600)) == "linear"
    assert torque_between_samples(drive, TRUE, _recorded("held", noise=0.1)) == "linear"


def _drawn(seed: int, hold: bool) -> tuple[Drive, Recording]:
    rng = np.random.default_rng(seed)
    rig: Rig = random_rig(rng, ["cogging"], samples=8000, excitation="multisine", noise_percent=1.0)
    rig = rig.model_copy(update={"hold": hold})
    recording = ready(rig.simulate())
    return Drive(Model.parse(rig.true_model), rig.inertia, recording.motion), recording


@pytest.mark.long
@pytest.mark.parametrize("hold", [True, False])
def test_on_drawn_drives_it_is_right(hold: bool) -> None:
    """With parameters that were fitted to the torque; what is not clear stays as it was taken before."""
    said = []
    for seed in range(6):
        drive, recording = _drawn(seed, hold)
        said.append(torque_between_samples(drive, estimate(drive, recording)[1].parameters, recording))
    assert said.count("held") >= 5 if hold else said.count("held") == 0


def test_fits_scores_and_files_take_it() -> None:
    recording, drive = _recorded("held"), Drive(Model.parse("coulomb-viscous"))
    pieces = np.arange(len(recording)) // 1500
    parts = [recording.select(pieces % 2 == i) for i in (0, 1)]
    cut = [Recording(p.name, p.motion, p.channels, pieces[pieces % 2 == i]) for i, p in enumerate(parts)]
    (found,) = judged([Rung(drive, TRUE)], *cut)
    assert found.kept.between_samples == "held"
    assert found.fit is not None
    assert found.fit.parameters["K_c"] == pytest.approx(TRUE["K_c"], rel=1e-3)
