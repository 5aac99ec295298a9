"""A model beside a controller: what a fitted model says sample by sample, and the inverse of its equation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.kernels import Scan
from fricmodels.rig import Rig
from fricmodels.tracking import Compensator, Experiment, Settings
from fricmodels.tracking.compensator import compensation_step

MODELS = ["coulomb-viscous", "exponential-stick-slip+cogging", "coulomb-viscous+presliding", "coulomb-viscous+gravity"]


def moving(count: int = 300) -> dict[str, np.ndarray]:
    time = np.arange(count) * 0.002
    return {
        "time": time,
        "velocity": np.sin(9 * time),
        "position": (1 - np.cos(9 * time)) / 9,
        "acceleration": 9 * np.cos(9 * time),
        "load_torque": 0.3 * np.sin(4 * time),
        "temperature": 20 + time,
    }


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("at_rest", ["none", "reference", "smooth"])
def test_it_is_what_the_fitted_model_compensates(kept: Callable[..., Any], name: str, at_rest: str) -> None:
    model, signals = kept(name), moving()
    turn = None if at_rest == "none" else 0.05
    width = model.document.rest_width
    own = Compensator(model.drive, model.parameters, width, at_rest=at_rest, turn=turn)  # type: ignore[arg-type]
    wanted = np.cos(9 * signals["time"])
    rows = own.rows(0.002, 2.0 * signals["acceleration"], wanted, signals)
    needed = {k: v for k, v in signals.items() if k in {*model.needs, "velocity", "time"}}
    expected = model.compensation(at_rest=at_rest, reference=wanted, width=turn or width, **needed)
    np.testing.assert_allclose(own.along(rows), expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected)))


@pytest.mark.parametrize("effect", ["torque-gain", "torque-ripple", "inertia-error"])
def test_it_solves_the_equation_of_motion(kept: Callable[..., Any], effect: str) -> None:
    """J a + τ_L + τ_F(…, τ_m) = τ_m, where friction depends on the motor torque or on the acceleration."""
    model = kept(f"coulomb-viscous+{effect}")
    assert any(model.parameters[p.key] for p in model.drive.model_parameters if p.key.startswith(effect))
    signals = moving()
    base = 1.5 * signals["acceleration"] + signals["load_torque"]  # the stated inertia is another one
    own = Compensator(model.drive, model.parameters, model.document.rest_width, stated=1.5)
    torque = base + own.along(own.rows(0.002, base, 0.0, signals))
    needed = {k: v for k, v in signals.items() if k in {*model.needs, "velocity"}}
    friction = model.torque(motor_torque=torque, **needed)
    sliding = np.abs(signals["velocity"]) > 1e-3
    wanted = model.inertia * signals["acceleration"] + signals["load_torque"] + friction
    np.testing.assert_allclose(torque[sliding], wanted[sliding], rtol=1e-9, atol=1e-9)


def test_called_by_address_it_is_the_recursion() -> None:
    """In the loop it goes through compiled code that knows it by its address alone."""
    from numba import njit

    from fricmodels.model import Model

    model = Model.parse("coulomb-viscous+presliding")
    own = Compensator(_drive(model), {p.key: 0.5 for p in model.parameters}, 1e-6)
    signals = moving()
    rows = own.rows(0.002, signals["acceleration"], 0.0, signals)

    @njit
    def called(function: Any, memory: Any, rows: Any, constants: Any) -> Any:
        found, result = np.zeros(len(rows)), np.zeros(1)
        for k in range(len(rows)):
            function(memory.ctypes, rows[k].ctypes, constants.ctypes, result.ctypes)
            found[k] = result[0]
        return found

    result = called(own.pointer, own.memory.copy(), rows, own.constants)
    np.testing.assert_allclose(result, own.along(rows), rtol=1e-12)
    assert isinstance(Scan(compensation_step(model, "none")), Scan)


def _drive(model: Any) -> Any:
    from fricmodels.drive import Drive

    return Drive(model, 1.0)


def test_nine_tenths_are_held_of_what_a_contact_carries_however_it_is_bent() -> None:
    """Harder forward than backward: bent either way, the contact is held at rest as strongly as it pushes."""
    from fricmodels.model import Model

    model = Model.parse("asymmetric-coulomb-viscous+presliding")
    own = {"presliding.F_1": 3.0, "presliding.F_2": 1.5, "presliding.D": 0.0, "presliding.x_s": 1e-3}
    values = {"J": 1.0, "K_v1": 0.0, "K_v2": 0.0, "K_c1": 3.0, "K_c2": 1.5, **own}
    held = []
    for side in (1.0, -1.0):
        velocity = np.r_[np.full(200, side), np.zeros(50)]
        signals = {"velocity": velocity, "position": np.cumsum(velocity) * 1e-3, "time": 1e-3 * np.arange(250)}
        whole = Compensator(_drive(model), values, 1e-6)
        held.append(whole.along(whole.rows(1e-3, np.zeros(250), velocity, signals))[-1])
    np.testing.assert_allclose(held, [0.9 * 3.0, -0.9 * 1.5], rtol=1e-6)


def test_what_is_no_number_is_refused(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous")
    bad = Compensator(model.drive, {**model.parameters, "K_v": np.nan}, 1e-6)
    rows = bad.rows(0.01, np.zeros(5), 0.0, {"velocity": np.ones(5)})
    with pytest.raises(InputError, match="no number"):
        bad.along(rows)


HIDDEN: list[dict[str, Any]] = [
    {"name": "stribeck", "rise": 4.0, "speed": 0.1},
    {"name": "cogging", "harmonics": [{"order": 9.0, "amplitude": 2.0, "phase": 0.4}]},
    {"name": "position-friction", "harmonics": [{"order": 9.0, "amplitude": 2.0, "phase": 0.4}]},
    {"name": "torque-ripple", "harmonics": [{"order": 9.0, "amplitude": 0.2, "phase": 0.4}]},
    {"name": "torque-gain", "error": 0.2},
    {"name": "torque-offset", "torque": 1.0},
    {"name": "inertia-error", "error": 0.3},
    {"name": "gravity", "sine": 3.0, "cosine": 1.0},
    {"name": "presliding", "kind": "dahl", "width": 0.01, "damping_ratio": 0.3},
    {"name": "presliding", "kind": "lugre", "width": 0.01, "damping_ratio": 0.3},
    {"name": "presliding", "kind": "maxwell-slip", "width": 0.01, "damping_ratio": 0.3},
    {"name": "rising-stiction", "rise": 3.0, "time": 0.5, "distance": 0.02},
    {"name": "frictional-lag", "delay": 0.01},
    {"name": "thermal", "end": 40.0, "time": 5.0, "viscous": 0.02},
    {"name": "joint-compliance", "frequency": 40.0, "load_inertia_share": 0.4, "load_friction_share": 0.3},
    {"name": "backlash", "gap": 0.01, "load_inertia_share": 0.3, "contact_frequency": 100.0, "damping_ratio": 0.7},
]


@pytest.mark.parametrize("effect", HIDDEN, ids=lambda e: f"{e['name']} {e.get('kind', '')}".strip())
def test_the_true_torque_follows_whatever_is_hidden(joint: Callable[..., Rig], effect: dict[str, Any]) -> None:
    """With a perfect encoder and no delay next to nothing of the error is left."""
    law = {"viscous": 1.0, "coulomb": 8.0}
    if effect["name"] == "frictional-lag":
        law |= {"stick": 12.0, "fall": 5.0}
    rig = joint(effects=[effect], friction=law, samples=1000)
    how = Settings(encoder_step=0.0, delay=0.0, bandwidth=6.0, motion="trapezoid")
    experiment = Experiment(rig, how)
    left = experiment.run_true().figures.rms_error / experiment.run(None).figures.rms_error
    assert left < (0.05 if effect["name"] in ("backlash", "joint-compliance", "presliding") else 0.01)
