"""A fit that explains the torque without the motion that it makes is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate


def driven(command: np.ndarray, noise: float = 0.0) -> Recording:
    """Return a motor (J = 0.02, K_v = 0.3, K_c = 0.5) under a command that is held over each sample, from rest."""
    period, velocity = 0.01, [0.0]
    decay = np.exp(-0.3 / 0.02 * period)
    for torque in command[:-1]:
        final = (torque - 0.5 * np.sign(velocity[-1] or torque)) / 0.3
        velocity.append(final + (velocity[-1] - final) * decay)
    shaken = np.array(velocity) + noise * np.random.default_rng(1).standard_normal(len(command))
    channels = {"time": period * np.arange(len(command)), "torque": command, "velocity": shaken}
    return Recording("motor", Motion.ROTARY, channels, np.zeros(len(command), dtype=np.int64))


def fitted(recording: Recording, inertia: float | None = None) -> dict[str, float]:
    drive = Drive(Model.parse("coulomb-viscous"), inertia)
    return dict(estimate(drive, recording)[1].parameters)


CONSTANT = np.full(400, 4.0)
STEPS = np.repeat([4.0, 2.0, -3.0, -5.0, 3.0, 4.5, -2.0, -4.0], 50)


def test_one_torque_throughout_is_refused() -> None:
    with pytest.raises(InputError, match="one size in each direction"):
        fitted(driven(CONSTANT, 0.05))


def test_with_the_inertia_it_is_not() -> None:
    assert fitted(driven(CONSTANT, 0.05), 0.02)["K_c"] < 4.0


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_steps_of_several_sizes_tell_the_drive(noise: float) -> None:
    found = fitted(driven(STEPS, noise))
    assert [found["J"], found["K_v"], found["K_c"]] == pytest.approx([0.02, 0.3, 0.5], rel=0.1)


def test_a_measured_torque_is_never_so_exact() -> None:
    recording = driven(CONSTANT, 0.05)
    torque = CONSTANT + 0.01 * np.random.default_rng(2).standard_normal(len(CONSTANT))
    assert fitted(replace(recording, channels={**recording.channels, "torque": torque}))["K_c"] > 0.0
