"""How the torque runs between samples, what steps of a sensor do to an estimate, and what smoothing takes away."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative, prepare
from fricmodels.simulation import Between, simulate
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.inference import at_least
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.prepared import prepared
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.sharpened import smoothed_away
from fricmodels.weakform.solve import solve
from fricmodels.weakform.staircase import errors_of_steps, scatter_of_steps

TRUTH = {"J": 2.0, "K_v": 4.0, "K_c": 6.0}
DRIVE = Drive(Model.parse("coulomb-viscous"), 2.0)


def moved(between: Between, rate: int = 500, *, with_position: bool = False) -> Recording:
    time = np.arange(8 * rate) / rate
    torque = 14.0 * np.sin(2 * np.pi * 0.5 * time) + 9.0 * np.sin(2 * np.pi * 1.3 * time + 1.0)
    return simulate(
        DRIVE, TRUTH, time, torque, between_samples=between, substeps=8, with_position=with_position, name="torque"
    )


@pytest.mark.parametrize("rate", [100, 500])
def test_the_rows_of_a_held_torque_are_exact_at_the_true_velocity(rate: int) -> None:
    recording = prepared(moved("held", rate))
    rows = WeakFormProblem.of(DRIVE, recording, TRUTH).along(recording.velocity, recording.velocity == 0.0)
    left = {held: solve(rows.at(held=held), Plan(), timing=False).solution.cost for held in (False, True)}
    assert left[True] < 0.02 * left[False]


@pytest.mark.parametrize(("between", "shift"), [("held", 0.5), ("linear", 0.0)])
def test_the_recording_tells_how_its_torque_ran(between: Between, shift: float) -> None:
    recording = prepared(moved(between))
    _, found = estimate(DRIVE, recording)
    assert found.shift / recording.interval == pytest.approx(shift, abs=0.05)
    for key in ("K_v", "K_c"):
        assert found.parameters[key] == pytest.approx(TRUTH[key], rel=1e-3)


def test_what_the_rows_know_of_the_torque_is_not_carried_over() -> None:
    """The driving torque differs with its course, the momentum does not."""
    problem = WeakFormProblem.of(DRIVE, prepared(moved("held")), TRUTH)
    before, momentum = problem.driving, problem.momentum
    held = problem.at(held=True)
    assert np.max(np.abs(held.driving - before)) > 0.0
    assert np.array_equal(held.at(held=False).driving, before)
    assert held.momentum is momentum


def test_errors_of_steps_are_within_half_a_step_and_none_without_steps() -> None:
    exact = prepared(moved("linear", with_position=True))
    assert not len(errors_of_steps(exact)[0])
    step = 2 * np.pi / 2048
    position = step * np.round(exact["position"] / step)
    channels = {"time": exact.time, "torque": exact.torque, "position": position}
    coarse = Recording("coarse", exact.motion, channels, exact.run)
    ready = prepared(prepare(coarse))
    cells, slopes = errors_of_steps(ready)
    assert len(cells) == len(slopes) > 1
    assert np.max(np.abs(cells)) <= 1.01 * step / ready.interval
    problem = WeakFormProblem.of(DRIVE, ready, TRUTH)
    scatter, _ = scatter_of_steps(problem, TRUTH)
    assert scatter.shape == (len(cells), problem.rows)
    assert np.all(np.std(scatter, axis=1) > 0.0)


def test_twice_smoothed_keeps_more_of_the_motion() -> None:
    """The filter takes away a share λ of a wave; with what it left over smoothed again it takes away λ²."""
    time = np.arange(2000) / 1000
    wave = np.sin(2 * np.pi * 6.0 * time)
    recording = Recording("wave", DRIVE.motion, {"time": time, "torque": wave, "velocity": wave}, np.zeros(2000, int))
    smooth = lanczos_derivative(time, wave, 20)[0]
    inside = slice(100, -100)
    once = np.std((wave - smooth)[inside]) / np.std(wave[inside])
    twice = np.std((wave - smooth - smoothed_away(recording, smooth, 20))[inside]) / np.std(wave[inside])
    assert twice == pytest.approx(once**2, rel=0.05)


def test_a_variance_is_at_least_that_of_another_kind() -> None:
    found = at_least(np.array([[4.0, 1.0], [1.0, 1.0]]), np.diag([1.0, 9.0]))
    assert np.diag(found).tolist() == [4.0, 9.0]
    assert found[0, 1] == pytest.approx(3.0)
