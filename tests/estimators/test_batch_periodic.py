"""Wave numbers are found by the batch estimator itself, wherever they lie, rotary and linear, on the rig too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from estimators.batch import Batch
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.tournament import run
from fricmodels.tournament.config import Config

TIME = 5e-4 * np.arange(8000)
TURNING = (4.87e-6, {"K_v": 1e-4, "K_c": 8e-3}, 0.02 * np.sin(12 * TIME) + 0.012 * np.sin(4.1 * TIME))
SLIDING = (2.0, {"K_v": 30.0, "K_c": 8.0}, 20 * np.sin(6 * TIME) + 12 * np.sin(2.3 * TIME))


def made(effects: dict[str, float], motion: Motion, noise: float = 0.0) -> tuple[Drive, Recording, dict[str, float]]:
    """Simulate a drive with periodic effects of 15 % of the Coulomb torque, by name and wave number."""
    inertia, truth, torque = TURNING if motion is Motion.ROTARY else SLIDING
    truth = dict(truth)
    for name, k in effects.items():
        size = 0.05 if name == "torque-ripple" else 0.15 * truth["K_c"]
        sizes = {"a": size, "b": -0.6 * size, "a_2": 0.3 * size, "b_2": 0.2 * size, "k": k}
        truth |= {f"{name}.{symbol}": value for symbol, value in sizes.items()}
    drive = Drive(Model.parse("+".join(["coulomb-viscous", *effects])), inertia, motion)
    return drive, simulate(drive, truth, TIME, torque, substeps=4, noise=noise, with_position=True), truth


@pytest.mark.parametrize("noise", [0.0, 0.5])
@pytest.mark.parametrize(("motion", "k"), [(Motion.ROTARY, 7.3), (Motion.ROTARY, 2.37), (Motion.LINEAR, 49.6)])
@pytest.mark.parametrize("effect", ["cogging", "position-friction", "torque-ripple"])
def test_wave_number_that_does_not_divide_a_turn(effect: str, motion: Motion, k: float, noise: float) -> None:
    drive, recording, truth = made({effect: k}, motion, noise)
    fit = Batch().fit(drive, recording)
    assert fit.identified
    assert fit.parameters[f"{effect}.k"] == pytest.approx(k, rel=1e-3)
    first = abs(truth[f"{effect}.a"])
    for key in truth:
        size = first if key[-2:] in {".a", ".b", "_2"} else abs(truth[key])
        assert fit.standard_errors[key] < (0.4 * noise + 0.01) * size, key
        assert abs(fit.parameters[key] - truth[key]) < 4 * fit.standard_errors[key] + 0.01 * size, key


def test_two_periodic_effects_at_once() -> None:
    drive, recording, truth = made({"cogging": 11.9, "position-friction": 3.4}, Motion.ROTARY)
    fit = Batch().fit(drive, recording)
    for effect in ("cogging", "position-friction"):
        assert fit.parameters[f"{effect}.k"] == pytest.approx(truth[f"{effect}.k"], rel=1e-3)


def test_derivative_form_finds_it_too() -> None:
    drive, recording, _ = made({"cogging": 2.37}, Motion.ROTARY)
    preparation = {"method": "butterworth", "cutoff": 500.0, "decimate": 2}
    fit = Batch({"form": "derivative", "preparation": preparation}).fit(drive, recording)
    assert fit.parameters["cogging.k"] == pytest.approx(2.37, rel=1e-3)


def test_effect_that_is_not_there_stays_in_the_noise() -> None:
    """The wave number is then the best of many: its amplitude is what the noise happens to have there."""
    _, recording, _ = made({}, Motion.ROTARY, noise=1.0)
    fit = Batch().fit(Drive(Model.parse("coulomb-viscous+cogging"), TURNING[0]), recording)
    assert fit.parameters["K_c"] == pytest.approx(8e-3, rel=0.02)
    assert np.hypot(fit.parameters["cogging.a"], fit.parameters["cogging.b"]) < 0.03 * 8e-3


def test_on_the_rig_in_a_tournament(tmp_path: Path) -> None:
    (tmp_path / "rig.yaml").write_text(
        "inertia: 4.87e-6\nfriction: {viscous: 1.0e-4, coulomb: 1.0e-2}\n"
        "effects: [{name: cogging, harmonics: [{order: 7.31, amplitude: 1.5e-3}]}]\n"
        "excitation: {kind: multisine, amplitude: 0.025, frequency: 2.0, lines: 6}\n"
        "sensors: {velocity_noise_percent: 0.2}\nrate: 1250\nsamples: 8000\nhold: false\n"
    )
    config = {
        "datasets": [{"rig": "rig.yaml", "inertia": 4.87e-6}],
        "models": ["coulomb-viscous", "coulomb-viscous+cogging"],
        "estimators": "batch",
        "simulate": False,
    }
    board = run(Config.model_validate(config), tmp_path / "out", directory=tmp_path, executor="serial")
    assert board.rows[0]["model"] == "coulomb-viscous+cogging"
    assert board.rows[0]["parameters"]["cogging.k"] == pytest.approx(7.31, rel=1e-3)
