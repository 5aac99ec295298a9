"""Positions alone, with torques that jump: a clean drive is called clean, and what is hidden is found."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

INERTIA = 0.01
_COUNT, _INTERVAL, _FINE = 12_000, 1e-3, 20


def stepped(seed: int, noise: float, spring: float = 0.0) -> Recording:
    """Return positions of a speed-controlled drive whose reference jumps twice a second; its torque is held in between.

    Time stepping that fulfils Coulomb's law exactly (Moreau), in twenty steps a sample; no code of the project.
    """
    rng = np.random.default_rng(seed)
    reference = np.repeat(rng.uniform(-20, 20, _COUNT // 500), 500)
    position = velocity = total = 0.0
    step = _INTERVAL / _FINE
    positions, torques = np.empty(_COUNT), np.empty(_COUNT)
    for n in range(_COUNT):
        positions[n] = position
        total += (reference[n] - velocity) * _INTERVAL
        torques[n] = torque = float(np.clip(2.0 * (reference[n] - velocity) + 20.0 * total, -6, 6))
        for _ in range(_FINE):
            free = velocity + step * (torque - 0.05 * velocity - spring * position) / INERTIA
            held = step * 0.2 / INERTIA
            reached = max(free - held, 0.0) + min(free + held, 0.0)
            position += step * (velocity + reached) / 2
            velocity = reached
    channels = {
        "time": np.arange(_COUNT) * _INTERVAL,
        "torque": torques,
        "position": positions + noise * rng.standard_normal(_COUNT),
    }
    return Recording("steps", Motion.ROTARY, channels, np.zeros(_COUNT, dtype=np.int64))


@pytest.mark.parametrize(
    ("seed", "noise", "inertia"),
    [
        (1, 1e-3, None),
        pytest.param(0, 1e-4, INERTIA, marks=pytest.mark.long),
        *(pytest.param(*case, marks=pytest.mark.long) for case in [(0, 1e-4, None), (0, 1e-3, INERTIA)]),
        *(pytest.param(*case, marks=pytest.mark.long) for case in [(0, 1e-3, None), (1, 1e-3, INERTIA)]),
    ],
)
def test_a_clean_drive_is_called_clean(seed: int, noise: float, inertia: float | None) -> None:
    """A velocity that is derived over several samples smears what the torque does; that is no stiff joint."""
    diagnosis = diagnose(stepped(seed, noise), "coulomb-viscous", inertia)
    assert (diagnosis.verdict, diagnosis.findings, diagnosis.view) == ("adequate", (), None)


def test_a_hidden_spring_is_found() -> None:
    diagnosis = diagnose(stepped(0, 1e-3, spring=0.02), "coulomb-viscous", INERTIA)
    assert diagnosis.findings[0].tested.name == "stiffness"
    assert diagnosis.findings[0].tested.parameters["k"] == pytest.approx(0.02, rel=0.02)
