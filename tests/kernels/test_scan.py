"""Compiled recursions against closed solutions and against CasADi."""

from __future__ import annotations

import pickle
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import casadi
import numpy as np
import pytest

from fricmodels.kernels import Scan
from fricmodels.kernels.scan import cache_directory


@pytest.fixture(scope="module")
def decay() -> Scan:
    """x ← a x + u, output x before the step."""
    x, u, a = (casadi.SX.sym(name) for name in ("x", "u", "a"))
    return Scan(casadi.Function("decay", [x, u, a], [a * x + u, x]))


def test_a_geometric_sequence(decay: Scan) -> None:
    last, outputs, done = decay([1.0], np.zeros(20), [0.5])
    np.testing.assert_allclose(outputs[:, 0], 0.5 ** np.arange(20), rtol=1e-15)
    assert last[0] == 0.5**20
    assert done == 20


def test_strides_keep_every_kth_output(decay: Scan) -> None:
    _, every, _ = decay([1.0], np.ones(21), [0.9])
    last, some, done = decay([1.0], np.ones(21), [0.9], stride=5)
    np.testing.assert_array_equal(some, every[4::5])
    assert (len(some), done) == (4, 21)
    assert last[0] == pytest.approx(0.9**21 + (1 - 0.9**21) / 0.1, rel=1e-12)


def test_a_state_that_leaves_the_finite_numbers_stops_the_run_there(decay: Scan) -> None:
    inputs = np.zeros(50)
    inputs[17] = np.inf
    last, _, done = decay([1.0], inputs, [0.5])
    assert done == 17
    assert not np.isfinite(last[0])
    assert decay([1.0], np.full(10, np.nan), [0.5])[2] == 0


def test_no_rows_no_steps(decay: Scan) -> None:
    last, outputs, done = decay([3.0], np.zeros(0), [0.5])
    assert (last[0], outputs.shape, done) == (3.0, (0, 1), 0)


def test_runs_joined_end_to_end_are_one_run(decay: Scan) -> None:
    inputs = np.random.default_rng(0).normal(size=100)
    whole, outputs, _ = decay([1.0], inputs, [0.9])
    middle, first, _ = decay([1.0], inputs[:37], [0.9])
    end, second, _ = decay(middle, inputs[37:], [0.9])
    np.testing.assert_array_equal(np.vstack([first, second]), outputs)
    np.testing.assert_array_equal(end, whole)


def test_the_states_of_a_step_change_together() -> None:
    """A rotation mixes both states; overwriting the first before the second is computed would spiral."""
    x, u, c = casadi.SX.sym("x", 2), casadi.SX.sym("u"), casadi.SX.sym("c")
    rotated = casadi.vertcat(casadi.cos(c) * x[0] - casadi.sin(c) * x[1], casadi.sin(c) * x[0] + casadi.cos(c) * x[1])
    last, outputs, _ = Scan(casadi.Function("rotate", [x, u, c], [rotated, rotated]))([1.0, 0.0], np.zeros(90), [0.1])
    np.testing.assert_allclose(last, [np.cos(9.0), np.sin(9.0)], atol=1e-13)
    np.testing.assert_allclose(np.hypot(*outputs.T), 1.0, atol=1e-13)


def test_a_step_has_three_inputs_and_two_outputs() -> None:
    x = casadi.SX.sym("x")
    with pytest.raises(TypeError, match="state, input, constant"):
        Scan(casadi.Function("f", [x], [x]))


def test_the_cache_is_where_it_was_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRICMODELS_CACHE", str(tmp_path))
    assert cache_directory() == tmp_path
    x, u, c = (casadi.SX.sym(name) for name in "xuc")
    last, _, _ = Scan(casadi.Function("cached", [x, u, c], [x + 0.12345 * u + c, x]))([0.0], np.ones(2), [1.0])
    assert last[0] == pytest.approx(2.2469)
    assert len(list(tmp_path.glob("fricmodels_*.code"))) == 1


def test_a_cache_that_cannot_be_written_does_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    monkeypatch.setenv("FRICMODELS_CACHE", str(blocked / "below"))
    x, u, c = (casadi.SX.sym(name) for name in "xuc")
    last, _, _ = Scan(casadi.Function("blocked", [x, u, c], [x + 0.54321 * u * c, x]))([0.0], np.ones(2), [1.0])
    assert last[0] == pytest.approx(1.08642)


def test_outputs_that_do_not_fit_are_not_written_to(decay: Scan) -> None:
    for wrong in (np.zeros((9, 1)), np.zeros((20, 1))[::2], np.zeros((10, 1), dtype=np.float32), np.zeros(10)):
        with pytest.raises(ValueError, match=r"contiguous numbers of shape \(10, 1\)"):
            decay([1.0], np.zeros(10), [0.5], outputs=wrong)
        assert not np.any(wrong)


def test_inputs_may_be_read_only(decay: Scan) -> None:
    rows = np.ones(5)
    rows.flags.writeable = False
    assert decay([0.0], rows, [1.0])[0] == 5.0


def test_a_pickled_recursion_is_the_same(decay: Scan) -> None:
    decay([1.0], np.zeros(1), [0.5])
    again = pickle.loads(pickle.dumps(decay))
    assert again([1.0], np.zeros(3), [0.5])[0] == 0.125


def test_threads_run_one_recursion_at_the_same_time() -> None:
    """While compiled code runs, other threads of Python go on."""
    x, u, c = (casadi.SX.sym(name) for name in "xuc")
    scan = Scan(casadi.Function("long", [x, u, c], [casadi.sin(x) + c * u, x]))
    scan([0.0], np.ones(1), [0.5])
    rows, running, counted = np.ones(2_000_000), threading.Event(), 0

    def run(constant: float) -> float:
        running.set()
        last, _, _ = scan([0.0], rows, [constant])
        return float(last[0])

    with ThreadPoolExecutor(2) as pool:
        found = [pool.submit(run, constant) for constant in (0.25, 0.5)]
        running.wait()
        while not all(future.done() for future in found):
            counted += 1
    assert counted > 100
    assert [future.result() for future in found] == [run(0.25), run(0.5)]
