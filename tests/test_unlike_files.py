"""Runs with noise of their own: told as such, drawn as such, and each counts by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis.comparison import compare
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score.noise import noise_like
from fricmodels.signals import motion_noise, velocity_noise
from fricmodels.signals.switched import torque_noise
from fricmodels.signals.unlike_files import NoiseOfFiles
from fricmodels.simulation import simulate

INERTIA, TRUE = 0.05, {"K_v": 0.2, "K_c": 1.0}


def run(seed: int, velocity_noise: float, torque_noise: float, samples: int = 8000) -> Recording:
    """Return a drive at 1 kHz; noise in rad/s and N m."""
    rng, time = np.random.default_rng(seed), 1e-3 * np.arange(samples)
    waves = 2.0 * np.pi * np.outer([0.31, 0.73, 1.17, 2.3], time) + rng.uniform(0.0, 6.0, (4, 1))
    found = simulate(
        Drive(Model.parse("coulomb-viscous"), INERTIA), TRUE, time, 2.0 * np.sin(waves).sum(axis=0), substeps=2
    )
    return found.with_channels(
        derived=False,
        velocity=found.velocity + velocity_noise * rng.standard_normal(samples),
        torque=found.torque + torque_noise * rng.standard_normal(samples),
    )


def together(*runs: Recording) -> Recording:
    """Return runs that were read from files of their own."""
    channels = {name: np.concatenate([one[name] for one in runs]) for name in ("time", "torque", "velocity")}
    run = np.repeat(np.arange(len(runs)), [len(one) for one in runs])
    known = {"file_of_run": {number: f"day{number}.csv" for number in range(len(runs))}}
    return replace(runs[0], channels=channels, run=run, origin=None, provenance=known)


QUIET, NOISY = (0.02, 0.03), (0.6, 1.5)


def test_alike_runs_have_one_noise() -> None:
    recording = together(run(1, *QUIET), run(2, 0.025, 0.04))
    assert not isinstance(motion_noise(recording), NoiseOfFiles)
    assert not isinstance(torque_noise(recording), NoiseOfFiles)


def test_runs_of_one_file_are_of_one_logger() -> None:
    """What looks like noise is torque: that of a stiff controller, or of a fast motion."""
    apart = together(run(1, *QUIET), run(2, *NOISY))
    one = replace(apart, provenance={"file_of_run": {0: "log.csv", 1: "log.csv"}})
    for recording in (one, replace(apart, provenance={})):
        assert not isinstance(motion_noise(recording), NoiseOfFiles)
        assert not isinstance(torque_noise(recording), NoiseOfFiles)


@pytest.mark.parametrize("kept", [slice(None), slice(3000, 12_000), slice(9000, 16_000)], ids=["all", "both", "one"])
def test_unlike_files_have_their_own(kept: slice) -> None:
    recording = together(run(1, *QUIET), run(2, *NOISY)).remembering().select(kept)
    second = recording.run == 1
    drawn = {name: noise_like(recording, name, np.random.default_rng(0)) for name in ("velocity", "torque")}
    for name, quiet, noisy in zip(drawn, QUIET, NOISY, strict=True):
        assert np.std(drawn[name][second]) == pytest.approx(noisy, rel=0.1)
        if not second.all():
            assert np.std(drawn[name][~second]) == pytest.approx(quiet, rel=0.15)
    share = np.mean(second)
    assert velocity_noise(recording).deviation == pytest.approx(
        np.sqrt(share * NOISY[0] ** 2 + (1 - share) * QUIET[0] ** 2), rel=0.1
    )


def test_what_is_cut_from_some_of_three_runs_has_their_noises() -> None:
    """The steps of a sensor are errors of their own samples; of a run that is not there, there are none."""
    coarse = run(3, 0.0, 0.0)
    coarse = coarse.with_channels(derived=False, velocity=np.round(coarse.velocity / 3.0) * 3.0)
    whole = together(run(1, *QUIET), run(2, *NOISY), coarse).remembering()
    assert velocity_noise(whole).of_files[3].course is not None  # type: ignore[attr-defined]
    for numbers in ([0, 1], [1, 2], [0, 2]):
        part = velocity_noise(whole.select(np.isin(whole.run, numbers)))
        squares = [velocity_noise(whole.select(whole.run == number)).covariance(3)[0] for number in numbers]
        assert part.covariance(3)[0] == pytest.approx(np.mean(squares), rel=1e-6)


def test_runs_of_few_samples_have_the_noise_of_all() -> None:
    recording = together(run(1, *QUIET), run(2, *NOISY), run(3, *QUIET, samples=300))
    assert np.bincount(motion_noise(recording).which).tolist() == [300, 8000, 8000]  # type: ignore[attr-defined]


@pytest.mark.parametrize("noisy", [(0.6, 0.03), (0.02, 1.5), NOISY], ids=["velocity", "torque", "both"])
@pytest.mark.parametrize("inertia", [INERTIA, None])
def test_a_noisy_run_that_is_added_makes_a_fit_hardly_less_certain(
    noisy: tuple[float, float], inertia: float | None
) -> None:
    """It made errors five to thirty times as large."""
    alone = run(1, *QUIET)
    before, after = (
        compare(one, "coulomb-viscous", inertia).estimate for one in (alone, together(alone, run(2, *noisy)))
    )
    for key, true in TRUE.items():
        assert after.standard_errors[key] < 2.0 * before.standard_errors[key]
        assert abs(after.parameters[key] - true) < 3.0 * after.standard_errors[key]


def test_what_is_left_of_a_noisy_run_is_noise() -> None:
    found = compare(together(run(1, *QUIET), run(2, *NOISY)), "coulomb-viscous", INERTIA)
    assert found.errors.held_out_percent == pytest.approx(found.noise_floor_percent, rel=0.25)


def test_rows_of_both_files_count_alike_as_long_as_the_model_lacks_most() -> None:
    """Then the noise of either is nothing beside what is in both; with the effect in the model the quiet one counts."""
    both = together(run(1, 0.002, 0.003), run(2, *NOISY))
    pushed = both.with_channels(derived=False, torque=both.torque + 3.0)
    spread = {}
    for model in ("coulomb-viscous", "coulomb-viscous+torque-offset"):
        counts = compare(pushed, model, INERTIA).problem.test_functions.counts
        assert counts is not None
        spread[model] = counts.max() / counts.min()
    assert spread["coulomb-viscous"] < 1.5
    assert spread["coulomb-viscous+torque-offset"] > 4.0
