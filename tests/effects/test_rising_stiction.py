"""A contact that ages may have rested long before a record began, or not at all: its age there is found."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.diagnosis import compare, diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

STEP, FINE = 0.01, 10
INERTIA, VISCOUS, COULOMB = 0.5, 1.5, 5.0
RISE, TIME, DISTANCE = 3.0, 3.0, 0.05
NAME = "coulomb-viscous+rising-stiction"


def recorded(age: float, *, strokes: int = 14, seed: int = 3) -> Recording:
    """Return strokes there and back with rests of 0.3 to 5 s between them, and a contact of some age at first."""
    rng = np.random.default_rng(seed)
    parts, side = [np.zeros(50 * FINE)], 1.0
    for _ in range(strokes):
        lasting = int(rng.uniform(120, 260)) * FINE
        top = rng.uniform(0.3, 1.2)
        parts += [
            side * top * np.sin(np.pi * np.arange(lasting) / lasting) ** 2,
            np.zeros(int(rng.uniform(30, 500)) * FINE),
        ]
        side = -side
    velocity = np.concatenate(parts)
    step = STEP / FINE
    z = np.empty(len(velocity))
    z[0] = age
    rate = 1.0 / TIME + np.abs(velocity) / DISTANCE
    for k in range(1, len(velocity)):  # exact along each step
        z[k] = 1.0 / (TIME * rate[k]) + (z[k - 1] - 1.0 / (TIME * rate[k])) * np.exp(-rate[k] * step)
    acceleration = np.gradient(velocity, step)
    friction = (COULOMB + RISE * z) * np.sign(velocity) + VISCOUS * velocity
    torque = np.where(velocity == 0.0, 0.0, INERTIA * acceleration + friction)
    take = slice(FINE // 2, None, FINE)
    time: Array = STEP * np.arange(float(len(velocity[take])))
    channels: dict[str, Array] = {
        "time": time,
        "velocity": velocity[take],
        "position": np.cumsum(velocity)[take] * step,
        "torque": torque[take] + 0.02 * rng.standard_normal(len(time)),
    }
    return Recording("valve", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("age", [*(pytest.param(age, marks=pytest.mark.long) for age in (1.0, 0.4)), 0.0])
def test_whatever_its_age_at_first_the_contact_is_told(age: float) -> None:
    recording = recorded(age)
    found = diagnose(recording, "coulomb-viscous", INERTIA)
    assert found.findings[0].names[0] == "rising-stiction"
    fitted = compare(recording, NAME, INERTIA)
    values, errors = fitted.estimate.parameters, fitted.estimate.standard_errors
    for symbol, true in {"F": RISE, "T": TIME, "x_s": DISTANCE}.items():
        key = f"rising-stiction.{symbol}"
        assert values[key] == pytest.approx(true, abs=max(4 * errors[key], 0.05 * true))
    (states,) = fitted.drive.states(fitted.train, fitted.drive.split(values)[1])
    assert states[0] == pytest.approx(age, abs=0.1)
    assert np.all((states > -1e-9) & (states < 1.0 + 1e-9))
