"""A torque in coarse steps: at a constant speed it is rounded the same way every time, and intervals allow for it."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform import solve
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.staircase import errors_of_torque_steps

INERTIA, TRUE = 1e-3, {"K_v": 3e-3, "K_c": 0.05}


def recorded(width: ModuleType, seed: int, share: float) -> Recording:
    """Return a drive that keeps one speed after the other, its torque in steps of a share of its RMS value."""
    velocity = width.steps(seed, 8.0, 12.0)
    torque = INERTIA * np.gradient(velocity) * width.FINE + TRUE["K_v"] * velocity + TRUE["K_c"] * np.sign(velocity)
    every = width.FINE // 1000
    time, position, _ = width.read_off(velocity, 1000, 14, 0.0, seed)
    mean = np.convolve(torque, np.full(every, 1.0 / every), "same")[::every]
    step = share * float(np.sqrt(np.mean(mean**2)))
    rounded = step * np.round(mean / step) if share else mean
    channels = {"time": time, "position": position, "torque": rounded}
    return Recording("steps", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.long
def test_intervals_hold(from_benchmarks: Callable[[str], ModuleType]) -> None:
    """Without it the values were 2.2 standard errors off in the mean square: twelve speeds are rounded alike."""
    width, drive = from_benchmarks("derivative_width"), Drive(Model.parse("coulomb-viscous"), INERTIA)
    off = []
    for seed in range(40, 52):
        _, found = estimate(drive, ready(recorded(width, seed, 0.05)))
        off += [(found.parameters[key] - value) / found.standard_errors[key] for key, value in TRUE.items()]
    assert np.sqrt(np.mean(np.square(off))) < 1.6
    assert np.mean(np.abs(off) < 1.96) > 0.75


MORE = [(0.1, 2), (0.1, 3), (0.1, 7), (0.2, 4), (0.2, 10)]


@pytest.mark.parametrize(
    ("share", "seed"), [(0.05, 6), *(pytest.param(*case, marks=pytest.mark.long) for case in MORE)]
)
def test_they_are_no_effect(from_benchmarks: Callable[[str], ModuleType], share: float, seed: int) -> None:
    """At each speed the torque is rounded the same way: that was named asymmetry, Stribeck or nonlinear friction."""
    recording = recorded(from_benchmarks("derivative_width"), seed, share)
    assert diagnose(recording, "coulomb-viscous", INERTIA).verdict == "adequate"


@pytest.mark.parametrize("share", [0.02, 0.1])
def test_errors_are_as_large_as_those_of_rounding(from_benchmarks: Callable[[str], ModuleType], share: float) -> None:
    recording = ready(recorded(from_benchmarks("derivative_width"), 3, share))
    errors = errors_of_torque_steps(recording)
    step = share * recording.rms_torque
    assert float(np.std(errors)) == pytest.approx(step / np.sqrt(12.0), rel=0.1)
    assert float(np.max(np.abs(errors))) < 1.1 * step


def test_there_are_none_without_steps(from_benchmarks: Callable[[str], ModuleType]) -> None:
    assert not len(errors_of_torque_steps(ready(recorded(from_benchmarks("derivative_width"), 3, 0.0))))


def test_what_steps_move_without_end_is_a_number_still(
    from_benchmarks: Callable[[str], ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of velocities in eleven levels the square overflowed, and eigenvalues of a covariance did not converge."""

    def scatter(problem: WeakFormProblem, _: object) -> tuple[np.ndarray, np.ndarray]:
        return np.full((8, problem.rows), 1e200), np.zeros((0, problem.rows))

    monkeypatch.setattr(solve, "scatter_of_steps", scatter)
    recording = ready(recorded(from_benchmarks("derivative_width"), 3, 0.0))
    _, found = estimate(Drive(Model.parse("coulomb-viscous"), INERTIA), recording)
    assert all(np.isfinite(error) for error in found.standard_errors.values())
