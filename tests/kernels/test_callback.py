"""A step that compiled code calls by its address."""

from __future__ import annotations

import gc
from typing import Any

import casadi
import numpy as np
from numba import njit

from fricmodels.kernels import Callback
from fricmodels.kernels.machine_code import _loaded


@njit
def called(function: Any, state: Any, inputs: Any, constants: Any, output: Any) -> None:
    function(state.ctypes, inputs.ctypes, constants.ctypes, output.ctypes)


def pointer(turn: float) -> Any:
    """x ← turned x + u, output x[0] c where u is positive, else x[1]: of the state before."""
    x, u, c = casadi.SX.sym("x", 2), casadi.SX.sym("u"), casadi.SX.sym("c")
    rotated = casadi.vertcat(np.cos(turn) * x[0] - np.sin(turn) * x[1], np.sin(turn) * x[0] + np.cos(turn) * x[1])
    return Callback(casadi.Function("f", [x, u, c], [rotated + u, casadi.if_else(u > 0, x[0] * c, x[1])])).pointer


def test_state_and_output_are_written_in_place() -> None:
    state, output = np.array([1.0, 2.0]), np.zeros(1)
    function = pointer(0.0)
    called(function, state, np.array([0.5]), np.array([3.0]), output)
    np.testing.assert_allclose(state, [1.5, 2.5], rtol=1e-15)
    assert output[0] == 3.0
    called(function, state, np.array([-0.5]), np.array([3.0]), output)
    assert (output[0], state.tolist()) == (2.5, [1.0, 2.0])


def test_a_function_lives_as_long_as_its_pointer() -> None:
    functions = [pointer(float(turn)) for turn in range(3)]
    _loaded.cache_clear()
    gc.collect()
    for turn, function in enumerate(functions):
        state = np.array([1.0, 0.0])
        called(function, state, np.zeros(1), np.zeros(1), np.zeros(1))
        np.testing.assert_allclose(state, [np.cos(turn), np.sin(turn)], rtol=1e-15)


def test_numbers_that_are_none_do_not_raise() -> None:
    state, output = np.array([np.inf, np.nan]), np.zeros(1)
    called(pointer(1.0), state, np.array([np.nan]), np.array([0.0]), output)
    assert np.isnan([*state, *output]).all()
