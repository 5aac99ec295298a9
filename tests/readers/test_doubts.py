"""A velocity that is not the change of the position: another unit, another sign, another column."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.dimension import Motion
from fricmodels.readers import doubts
from fricmodels.recording import Recording
from fricmodels.rig import random_rig

EXCITATIONS = ("sine", "multisine", "tracking", "trapezoid", "stair", "ramp")


def recording(**changed) -> Recording:
    time = np.arange(4000) * 2e-3
    channels = {
        "time": time,
        "torque": np.cos(3 * time),
        "position": np.sin(3 * time) + 0.2 * np.sin(11 * time),
        "velocity": 3 * np.cos(3 * time) + 2.2 * np.cos(11 * time),
        "acceleration": -9 * np.sin(3 * time) - 24.2 * np.sin(11 * time),
    }
    return Recording("log", Motion.ROTARY, {**channels, **changed}, np.repeat([0, 1], 2000))


@pytest.mark.parametrize(
    ("channel", "factor", "words"),
    [
        (
            "velocity",
            180 / np.pi,
            "is 57.3 times the change of the position (position), as between degrees",
        ),
        ("position", 180 / np.pi, "is 0.0175 times the change of the position (position), as between degrees"),
        ("velocity", 30 / np.pi, "is 9.55 times the change of the position (position), as between rpm and rad/s"),
        ("position", 1000.0, "is 0.001 times the change of the position (position), as between milli and one; give"),
        ("velocity", -1.0, "is -1 times the change of the position (position); turn the sign"),
        (
            "acceleration",
            0.5,
            "(acceleration) is 0.5 times the change of the velocity (velocity); give",
        ),
    ],
)
def test_another_unit_or_sign_is_named(channel, factor, words):
    clean = recording()
    found = doubts(clean.with_channels(derived=False, **{channel: factor * clean[channel]}))
    assert any(words in line for line in found), found
    assert all(line.startswith("log: ") for line in found)


def test_a_position_of_another_axis_is_named():
    other = np.random.default_rng(0).permutation(40).repeat(100) * 0.1
    assert "does not follow the change of the position" in doubts(recording(position=other))[0]


@given(st.floats(0.0, 0.4), st.integers(8, 14), st.floats(0.97, 1.03))
def test_noise_coarse_encoders_wrapped_angles_and_small_errors_of_scale_raise_no_doubt(noise, bits, scale):
    clean = recording()
    rng = np.random.default_rng(1)
    step = 4 * np.pi / 2**bits
    turned = np.mod(4 * clean["position"] + 9.0, 2 * np.pi) / 4
    assert doubts(clean) == []
    changed = {
        "position": np.round(turned / step) * step,
        "velocity": scale * clean.velocity + noise * np.std(clean.velocity) * rng.standard_normal(len(clean)),
    }
    channels = {**clean.channels, **changed}
    del channels["acceleration"]
    assert doubts(Recording("log", Motion.ROTARY, channels, clean.run)) == []


@pytest.mark.parametrize("excitation", EXCITATIONS)
def test_simulated_drives_raise_no_doubt(excitation):
    for seed in range(4):
        rig = random_rig(np.random.default_rng(seed), (), excitation=excitation, samples=8000)
        assert doubts(rig.simulate()) == []


def test_a_derived_or_missing_channel_raises_no_doubt():
    clean = recording()
    assert doubts(clean.with_channels(velocity=50.0 * clean.velocity, acceleration=50.0 * clean["acceleration"])) == []
    channels = {name: values for name, values in clean.channels.items() if name != "position"}
    assert doubts(Recording("log", Motion.ROTARY, channels, clean.run)) == []


def test_too_few_samples_raise_no_doubt():
    assert doubts(recording().select(np.arange(12))) == []
