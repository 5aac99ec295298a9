"""Recursive least squares: against the batch solution, recovery, forgetting, what it refuses."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from estimators.regression import smooth
from estimators.rls import RecursiveLeastSquares, recursive_step
from estimators.window_rows import sided_measure
from fricmodels.errors import EstimationError
from fricmodels.kernels import Scan
from fricmodels.parameter import Parameter, outside_bounds


def test_the_recursion_equals_weighted_least_squares() -> None:
    rng = np.random.default_rng(0)
    design, forgetting = rng.standard_normal((200, 3)), 0.98
    right = design @ [1.0, -2.0, 0.5] + 0.1 * rng.standard_normal(200)
    rows = np.column_stack([design, right, np.ones(200)])
    first = np.concatenate([np.zeros(3), 1e9 * np.eye(3)[np.tril_indices(3)]])
    memory, _, _ = Scan(recursive_step(3))(first, rows, [forgetting])
    weight = np.sqrt(forgetting ** np.arange(199, -1, -1))
    expected = np.linalg.lstsq(design * weight[:, None], right * weight, rcond=None)[0]
    np.testing.assert_allclose(memory[:3], expected, rtol=1e-6)


@pytest.mark.parametrize("known", [True, False], ids=["inertia given", "inertia estimated"])
def test_a_noiseless_drive_is_recovered(paper: SimpleNamespace, known: bool) -> None:
    fit = RecursiveLeastSquares().fit(paper.drive(inertia=paper.inertia if known else None), paper.recording())
    for key, value in {"J": paper.inertia, **paper.true}.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.02)


def test_standstill_is_left_out(paper: SimpleNamespace) -> None:
    made = paper.recording(amplitude=0.014)
    assert np.mean(made.velocity == 0) > 0.15
    fit = RecursiveLeastSquares({"window": 8}).fit(paper.drive(), made)
    assert fit.parameters["K_c1"] == pytest.approx(paper.true["K_c1"], rel=0.05)
    assert fit.parameters["K_c2"] == pytest.approx(paper.true["K_c2"], rel=0.05)


def test_forgetting_follows_a_change(paper: SimpleNamespace) -> None:
    made = paper.recording(cycles=20)
    half = made.time[len(made) // 2]
    heavier = made.torque + np.where(made.time > half, 0.003 * np.sign(made.velocity), 0.0)
    changed = made.with_channels(torque=heavier)
    late = RecursiveLeastSquares({"memory": 1.5}).fit(paper.drive(), changed).parameters["K_c1"]
    mixed = RecursiveLeastSquares({"memory": 1e6}).fit(paper.drive(), changed).parameters["K_c1"]
    assert late == pytest.approx(0.013, rel=0.04)
    assert 0.0105 < mixed < 0.0125


@pytest.mark.long
def test_standard_errors_cover_the_scatter(paper: SimpleNamespace) -> None:
    fits = [RecursiveLeastSquares().fit(paper.drive(), paper.recording(0.05, seed)) for seed in range(20)]
    for key in paper.true:
        scatter = np.std([fit.parameters[key] for fit in fits], ddof=1)
        claimed = np.sqrt(np.mean([fit.standard_errors[key] ** 2 for fit in fits]))
        assert 0.4 < claimed / scatter < 2.0


def test_nonlinear_parameters_are_held_and_named(paper: SimpleNamespace) -> None:
    fit = RecursiveLeastSquares().fit(paper.drive("exponential-stick-slip"), paper.recording())
    assert "B" not in fit.estimated
    assert fit.parameters["B"] > 0
    assert "held" in fit.message
    assert "B" in fit.message


def test_memory_terms_are_refused(paper: SimpleNamespace) -> None:
    with pytest.raises(EstimationError, match="internal states"):
        RecursiveLeastSquares().fit(paper.drive("coulomb-viscous+presliding"), paper.recording())


def test_the_local_cubic_is_exact_for_cubics() -> None:
    time = 0.1 * np.arange(30)
    value, slope = smooth(time, time**3 - time, 9)
    np.testing.assert_allclose(value, (time**3 - time)[4:-4], atol=1e-12)
    np.testing.assert_allclose(slope, (3 * time**2 - 1)[4:-4], atol=1e-11)


def test_the_sign_is_integrated_exactly_through_a_reversal() -> None:
    time = np.arange(11.0)
    velocity, weights = time - 3.3, np.empty(11)
    sided_measure(time, velocity, weights)
    assert float((weights * np.sign(velocity)).sum()) == pytest.approx(10 - 2 * 3.3)
    assert weights.sum() == pytest.approx(10)


def test_the_newest_window_is_that_of_the_whole_run(paper: SimpleNamespace) -> None:
    """Sample by sample, with a gap in time, a position, and parameters that are held: the same rows."""
    made = paper.recording(0.02, cycles=1)
    time = made.time + np.where(np.arange(len(made)) > 60, 0.01, 0.0)
    made = made.with_channels(derived=False, time=time, position=np.cumsum(made.velocity) * 1e-3)
    drive = paper.drive("coulomb-viscous+stribeck+cogging")
    online = RecursiveLeastSquares({"smoothing": 7, "window": 15}).start(drive, made)
    newest, design = online._window, online.windowed
    found = []
    for i in range(len(made)):
        row = newest.take({"load_torque": 0.0, "run": 0.0} | {name: float(v[i]) for name, v in made.channels.items()})
        found.append(np.zeros(len(design.keys) + 2) if row is None else row.copy())
    expected = newest.design.windows(made)
    assert np.count_nonzero(expected[:, -1]) > 50
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10 * np.max(np.abs(expected)))


def test_a_value_outside_its_bounds_is_said_to_be_so(paper: SimpleNamespace) -> None:
    """A filter keeps no bounds: on a drive that friction pushes along, every friction is below zero."""
    made = paper.recording()
    pushed = made.with_channels(torque=made.torque - 0.1 * np.sign(made.velocity))
    fit = RecursiveLeastSquares().fit(paper.drive(), pushed)
    assert fit.parameters["K_c1"] < 0.0
    assert "lies outside its bounds, 0 to inf" in fit.not_identified["K_c1"]
    assert not fit.identified
    assert "K_c1" not in RecursiveLeastSquares().fit(paper.drive(), made).not_identified


def test_what_stands_at_a_bound_is_not_outside() -> None:
    known = {"K_c": Parameter("K_c", "N m", lower=0.0), "g": Parameter("g", "1", lower=-0.9, upper=2.0)}
    assert not outside_bounds(known, {"K_c": 0.0, "g": 2.0})
    assert set(outside_bounds(known, {"K_c": -1e-6, "g": 2.1})) == {"K_c", "g"}
    assert not outside_bounds(known, {"K_c": float("nan"), "g": None})
