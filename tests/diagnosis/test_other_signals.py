"""A channel that an effect is no function of may not explain more than it: then the cause is another one."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose
from fricmodels.diagnosis.own_channel import may_be_of
from fricmodels.dimension import Motion
from fricmodels.plugins import load
from fricmodels.recording import Recording

INERTIA = 2.0


def one_sine(*, of_acceleration: float, offset: float, noise: float, seed: int, cubic: float = 0.0) -> Recording:
    """Thirty seconds of a joint under one sine: a torque of |acceleration|, an asymmetry, and one of |velocity|³."""
    time, rng = np.arange(6000) / 200.0, np.random.default_rng(seed)
    phase, omega = 2 * np.pi * 0.7 * time, 2 * np.pi * 0.7
    velocity, acceleration = 5.0 * np.sin(phase), 5.0 * omega * np.cos(phase)
    friction = 3.0 * np.sign(velocity) + 0.2 * velocity
    other = (
        of_acceleration * np.abs(acceleration)
        + offset * (1.0 + 0.4 * np.abs(velocity))
        + cubic * np.abs(velocity / 5) ** 3
    )
    channels = {
        "time": time,
        "velocity": velocity + 1e-3 * rng.standard_normal(6000),
        "position": -5.0 / omega * np.cos(phase) + 1e-4 * rng.standard_normal(6000),
        "torque": INERTIA * acceleration + friction + other + noise * rng.standard_normal(6000),
    }
    return Recording("sine", Motion.ROTARY, channels, np.zeros(6000, dtype=np.int64))


@pytest.mark.parametrize(("size", "noise", "seed"), [(0.1, 0.1, 1), (0.1, 0.3, 2), (0.03, 0.2, 1)])
def test_what_goes_with_the_size_of_the_acceleration_is_no_asymmetry(size: float, noise: float, seed: int) -> None:
    """c − d |ω| is |acceleration| to within 3 % under one sine; the acceleration explains all of it."""
    found = diagnose(one_sine(of_acceleration=size, offset=0.0, noise=noise, seed=seed), "coulomb-viscous", INERTIA)
    assert (found.verdict, found.findings) == ("unknown-effect", ())
    assert found.view is not None
    assert "acceleration" in found.view.channels


@pytest.mark.parametrize("cubic", [0.0, 0.3])
def test_an_asymmetry_keeps_its_name_there_even_where_its_form_is_a_little_wrong(cubic: float) -> None:
    """What is wrong with its form is a function of the speed, as it is itself."""
    recording = one_sine(of_acceleration=0.0, offset=0.5, noise=0.1, seed=1, cubic=cubic)
    assert diagnose(recording, "coulomb-viscous", INERTIA).findings[0].names[0] == "asymmetry"


@pytest.mark.parametrize(
    ("effect", "channel", "may"),
    [
        ("asymmetry", "acceleration", False),
        ("asymmetry", "speed, the same in both directions", True),
        ("gravity", "position, along the motion", True),
        ("gravity", "motor torque", False),
        ("inertia-error", "acceleration", True),
        ("torque-gain", "motor torque, along the motion", True),
        ("torque-offset", "position", False),
        ("thermal", "time", True),
        ("joint-compliance", "motor torque", True),
        ("sensor-delay", "acceleration", True),
        ("asymmetry", "acceleration and speed", True),
        ("asymmetry", "its own course shortly before", True),
    ],
)
def test_the_equation_says_which_channels_an_effect_may_be_a_function_of(effect: str, channel: str, may: bool) -> None:
    recording = one_sine(of_acceleration=0.0, offset=0.0, noise=0.1, seed=1)
    problem = compare(recording, "coulomb-viscous", INERTIA).problem
    assert may_be_of(problem, load().effects.entry(effect).cls(), channel) is may
