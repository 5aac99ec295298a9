"""Waves over position that pass faster than a test function is wide: which there are, and which there are not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import ready
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.lines import Whitened, fast_band, smallest_line
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.ripple import Waves, carriers_alone, fast_waves, relations
from fricmodels.weakform.steps import Steps

RATE, INERTIA, COULOMB = 100.0, 2.0, 10.0


def recorded(
    per_wave: float = 5.0,
    *,
    share: float = 0.05,
    harmonics: Mapping[float, float] | None = None,
    kind: str = "cogging",
    noise: float = 0.5,
    step: float = 0.0,
    seed: int = 0,
    samples: int = 6000,
    motion: Motion = Motion.ROTARY,
) -> tuple[Recording, float, float]:
    """Return a drive logged at 100 Hz, its wave number and amplitude.

    The wave passes within so many samples half of the time; ``harmonics`` are multiples of it with relative sizes.
    """
    k = 2 * np.pi * RATE / (0.75 * per_wave)
    amplitude = np.sqrt(2.0) * share * 1.1 * COULOMB
    parts = {1.0: 1.0} if harmonics is None else harmonics
    waves = [{"order": m * k, "amplitude": size * amplitude, "phase": 0.4 + m} for m, size in parts.items()]
    if motion is Motion.LINEAR:
        waves = [
            {**{key: x for key, x in w.items() if key != "order"}, "period": 2 * np.pi / w["order"]} for w in waves
        ]
    effects = [{"name": kind, "harmonics": waves}] if share else []
    rig = Rig.model_validate(
        {
            "motion": motion,
            "inertia": INERTIA,
            "friction": {"viscous": 1.0, "coulomb": COULOMB},
            "effects": effects,
            "excitation": {"kind": "tracking", "velocity": 1.0, "frequency": 0.1, "bandwidth": 2.0},
            "sensors": {"velocity_noise_percent": noise, "encoder_step": step},
            "rate": RATE,
            "samples": samples,
            "seed": seed,
        }
    )
    return ready(rig.simulate()), k, amplitude


def fitted(recording: Recording) -> tuple[WeakFormProblem, Mapping[str, float]]:
    """Return the rows and the parameters of a Coulomb-viscous drive."""
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), INERTIA, recording.motion), recording)
    return problem, found.parameters


def waves_of(recording: Recording) -> Waves | None:
    """Return the waves that the policy lets pass."""
    problem, parameters = fitted(recording)
    least = POLICY.least_torque * float(np.sqrt(np.mean(recording.torque**2)))
    return fast_waves(problem, parameters, POLICY.significance, least)


@pytest.mark.parametrize("motion", list(Motion))
@pytest.mark.parametrize("per_wave", [3.0, 5.0, 8.0, 20.0])
def test_a_wave_is_found_however_fast_it_passes(per_wave: float, motion: Motion) -> None:
    """Its torque is known to a tenth: the rig holds the torque between samples, which the trapezium rule does not."""
    recording, k, amplitude = recorded(per_wave, motion=motion)
    waves = waves_of(recording)
    assert waves is not None
    assert waves.k == pytest.approx(k, abs=waves.resolution)
    assert waves.lines[0].torque == pytest.approx(amplitude / np.sqrt(2), rel=0.1)
    assert waves.lines[0].p_value < 1e-6


@pytest.mark.parametrize("kind", ["cogging", "position-friction"])
@pytest.mark.parametrize("noise", [0.1, 3.0])
def test_a_wave_is_found_whichever_way_it_acts(kind: str, noise: float) -> None:
    recording, k, _ = recorded(4.0, kind=kind, noise=noise)
    waves = waves_of(recording)
    assert waves is not None
    assert waves.k == pytest.approx(k, abs=waves.resolution)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("noise", "step"), [(0.1, 0.0), (1.0, 4e-4), (3.0, 1e-3), (3.0, 2e-3)])
def test_nothing_is_found_where_nothing_is(seed: int, noise: float, step: float) -> None:
    recording, *_ = recorded(share=0.0, seed=seed, noise=noise, step=step, samples=4000)
    assert waves_of(recording) is None


@pytest.mark.parametrize("second", [1.0, 3.0])
def test_the_first_harmonic_gives_the_wave_number(second: float) -> None:
    """However much larger the second is."""
    recording, k, _ = recorded(10.0, harmonics={1.0: 1.0, 2.0: second}, share=0.03)
    waves = waves_of(recording)
    assert waves is not None
    assert waves.k == pytest.approx(k, abs=waves.resolution)


def test_a_wave_alone_is_not_the_second_of_another() -> None:
    for seed in range(4):
        recording, k, _ = recorded(5.0, seed=seed)
        waves = waves_of(recording)
        assert waves is not None
        assert waves.k == pytest.approx(k, abs=waves.resolution)


def test_multiples_and_sums_are_told() -> None:
    recording, k, _ = recorded(12.0, harmonics={1.0: 1.0, 1.37: 1.0, 2.37: 1.0, 3.0: 0.6})
    waves = waves_of(recording)
    assert waves is not None
    told = relations(waves)
    largest = sorted(round(line.k / k, 2) for line in waves.lines[:4])
    assert largest == [1.0, 1.37, 2.37, 3.0]
    words = {round(line / k, 2): text for line, text in told.items()}
    assert "+" in words[2.37]
    assert words[3.0].startswith("3 ×")


def test_the_smallest_wave_is_what_would_be_found() -> None:
    """Twice the size is found, a quarter of it is not, at the fast and at the slow end of the band."""
    step = 2e-4
    recording, *_ = recorded(share=0.0, step=step)
    problem, parameters = fitted(recording)
    band = fast_band(problem)
    assert band is not None
    white = Whitened(Steps.of(problem, parameters))
    level = POLICY.significance * np.pi / ((band[1] - band[0]) * white.steps.span)
    share = smallest_line(white, band, level) / (1.1 * COULOMB)
    for per_wave in (2.5, 20.0):
        large, k, _ = recorded(per_wave, share=2.0 * share, step=step)
        found = waves_of(large)
        assert found is not None
        assert found.k == pytest.approx(k, abs=found.resolution)
    small, *_ = recorded(2.5, share=share / 4, step=step)
    assert waves_of(small) is None


def test_no_position_no_waves() -> None:
    recording, *_ = recorded(share=0.0)
    problem, _ = fitted(recording)
    channels = {name: x for name, x in problem.recording.channels.items() if name != "position"}
    assert fast_band(replace(problem, recording=replace(problem.recording, channels=channels))) is None


# ---- rows that carry a wave ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("per_wave", [3.0, 6.0])
def test_rows_with_a_carrier_show_a_wave_that_the_others_average_away(per_wave: float) -> None:
    recording, k, amplitude = recorded(per_wave, noise=0.05)
    problem, _ = fitted(recording)
    carried = carriers_alone(problem, (k,))
    wave = carried.integrals((amplitude * np.cos(k * carried.quadrature.recording["position"]))[None])[0]
    plain = problem.integrals((amplitude * np.cos(k * problem.quadrature.recording["position"]))[None])[0]
    per_function = np.sqrt(np.mean(np.sum(wave.reshape(-1, 2) ** 2, axis=1))) / recording.interval
    assert per_function > 2 * np.sqrt(np.mean(plain**2)) / recording.interval


def test_rows_of_a_problem_stay_the_same_beside_carriers() -> None:
    """Each test function has its own row first, then cosine and sine."""
    recording, k, _ = recorded(5.0)
    problem, _ = fitted(recording)
    both = problem.carrying((k,))
    assert both.rows == 3 * problem.rows
    assert both.independent == problem.independent
    for name in ("driving", "momentum", "torque_rate", "sign_change"):
        assert getattr(both, name)[::3] == pytest.approx(getattr(problem, name), rel=1e-12, abs=1e-15)
    assert np.array_equal(both.centre[::3], problem.centre)


@pytest.mark.parametrize("per_wave", [3.0, 5.0, 8.0])
def test_a_fit_finds_the_wave(per_wave: float) -> None:
    recording, k, amplitude = recorded(per_wave, noise=0.1)
    drive = Drive(Model.parse("coulomb-viscous+cogging"), INERTIA, recording.motion)
    _, found = estimate(drive, recording, {"cogging.k": k * 1.0005})
    assert found.parameters["cogging.k"] == pytest.approx(k, rel=3e-4)
    size = np.hypot(found.parameters["cogging.a"], found.parameters["cogging.b"])
    assert size == pytest.approx(amplitude, rel=0.05)
    assert found.parameters["K_c"] == pytest.approx(COULOMB, rel=0.01)
