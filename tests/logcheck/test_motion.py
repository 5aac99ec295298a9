"""The log check says where a motion is one sine, whatever the channels, and of no other motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.logcheck import Severity, findings
from fricmodels.logcheck.finding import Finding
from fricmodels.recording import Recording

Array = NDArray[np.float64]
RATE, SAMPLES = 500.0, 8000
TIME = np.arange(SAMPLES) / RATE


def moved(position: Callable[[Array], Array], *, noise: float = 0.01, runs: int = 1) -> Recording:
    """Return a drive with friction that follows a course, with noise on its velocity in parts of the RMS value."""
    rng = np.random.default_rng(4)
    course = position(TIME)
    velocity = np.gradient(course, TIME)
    velocity[0], velocity[-1] = velocity[1], velocity[-2]
    torque = 0.05 * np.gradient(velocity, TIME) + 0.6 * np.sign(velocity) + 0.1 * velocity
    channels = {
        "time": TIME,
        "torque": torque + 0.01 * rng.standard_normal(SAMPLES),
        "velocity": velocity + noise * np.sqrt(np.mean(velocity**2)) * rng.standard_normal(SAMPLES),
        "position": 1.3 + course,
    }
    return Recording("log", Motion.ROTARY, channels, np.repeat(np.arange(runs), SAMPLES // runs))


def said(recording: Recording) -> list[Finding]:
    return [one for one in findings(recording) if one.kind == "one-frequency"]


def sine(time: Array) -> Array:
    return np.asarray(np.sin(2 * np.pi * 0.7 * time + 0.4))


@pytest.mark.parametrize("left_out", ["", "velocity", "position"])
@pytest.mark.parametrize("runs", [1, 4])
def test_one_sine_is_noted_with_its_frequency(left_out: str, runs: int) -> None:
    recording = moved(sine, runs=runs)
    channels = {name: values for name, values in recording.channels.items() if name != left_out}
    (note,) = said(replace(recording, channels=channels))
    assert note.severity is Severity.NOTE
    assert "one sine of 0.7 Hz" in note.text
    assert "second frequency" in note.remedy


def test_it_does_not_depend_on_the_unit_or_the_direction() -> None:
    recording = moved(sine)
    scale = {"velocity": -8.0, "position": -8.0, "torque": -4.0}
    other = {name: scale.get(name, 1.0) * values for name, values in recording.channels.items()}
    axis = replace(recording, motion=Motion.LINEAR)
    assert said(axis)
    assert [one.text for one in said(axis)] == [one.text for one in said(replace(axis, channels=other))]


def trapezoids(time: Array) -> Array:
    velocity = np.clip(3.0 * np.sin(2 * np.pi * 0.7 * time), -1.0, 1.0)
    return np.asarray(np.cumsum(velocity) / RATE)


def triangles(time: Array) -> Array:
    velocity = 2.0 / np.pi * np.arcsin(np.sin(2 * np.pi * 0.7 * time))
    return np.asarray(np.cumsum(velocity) / RATE)


COURSES = {
    "two sines": lambda time: sine(time) + 0.15 * np.sin(2 * np.pi * 1.9 * time),
    "a sine that changes its frequency": lambda time: np.sin(2 * np.pi * (0.5 + 0.02 * time) * time),
    "a sine on a slow way": lambda time: sine(time) + 0.5 * np.sin(2 * np.pi * 0.09 * time),
    "trapezoids": trapezoids,
    "triangles": triangles,
}


@pytest.mark.parametrize("course", COURSES)
def test_of_no_other_motion_it_is_said(course: str) -> None:
    assert not said(moved(COURSES[course]))


def test_noise_alone_is_no_sine() -> None:
    recording = moved(sine)
    rng = np.random.default_rng(0)
    still = {"velocity": rng.standard_normal(SAMPLES), "position": 1e-3 * rng.standard_normal(SAMPLES)}
    assert not said(replace(recording, channels={**recording.channels, **still}))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_noise_about_rest_is_no_way_back(side: float) -> None:
    """Half of the samples at rest seem to go back."""
    there = moved(lambda time: side * np.clip(time, 4.0, 12.0) ** 1.3, noise=0.05)
    back = moved(lambda time: side * np.clip(time, 4.0, 9.0) - 0.8 * side * np.clip(time, 10.0, 14.0), noise=0.05)
    assert [one.kind for one in findings(there) if one.kind == "little-motion"] == ["little-motion"]
    assert [one.kind for one in findings(back) if one.kind == "little-motion"] == []
