"""A law or an effect is its class: one defined again under its name, as in a notebook, has its new equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from estimators.batch import Batch
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.parameter import Parameter, State
from fricmodels.recording import Recording
from fricmodels.term import Effect, Law, Parameters, Signals
from fricmodels.weakform.separable import separable

Torque = Callable[[Signals, Parameters], Any]


def squared(s: Signals, p: Parameters) -> Any:
    return p.c * s.velocity**2


def cubed(s: Signals, p: Parameters) -> Any:
    return p.c * 7 * s.velocity**3


def law(formula: Torque) -> Law:
    class Mine(Law):
        name = "mine"
        c = Parameter("c", "N m", initial=1.0)

        def torque(self, s: Signals, p: Parameters) -> Any:
            return formula(s, p)

    return Mine()


def lag(rate: float) -> Effect:
    class Lag(Effect):
        name = "lag"
        g = Parameter("g", "N m", initial=1.0)
        z = State("z")

        def torque(self, s: Signals, p: Parameters) -> Any:
            return p.g * s.z

        def rates(self, s: Signals, p: Parameters) -> Any:
            return {"z": rate * s.velocity}

    return Lag()


def moving(velocity: Any) -> Recording:
    velocity = np.asarray(velocity, dtype=float)
    time = 0.01 * np.arange(len(velocity))
    channels = {"time": time, "velocity": velocity, "torque": 3.0 * velocity**2}
    channels["acceleration"] = np.gradient(velocity, time)
    return Recording("made", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def test_a_law_has_the_formula_of_its_own_class() -> None:
    recording = moving([1.0, 2.0, 3.0])
    before, after = (Drive(Model(law(formula)), 1.0) for formula in (squared, cubed))
    assert before.model.name == after.model.name
    assert before.model != after.model
    np.testing.assert_allclose(before.friction(recording, {"c": 1.0}), [1, 4, 9])
    np.testing.assert_allclose(after.friction(recording, {"c": 1.0}), [7, 56, 189])


def test_an_estimator_fits_the_new_formula() -> None:
    recording = moving(2 + np.sin(np.linspace(0, 20, 2001)))
    inertia = 1e-9
    fits = [
        Batch().fit(Drive(Model(law(formula)), inertia), recording)
        for formula in (squared, lambda s, p: squared(s, p) / 2)
    ]
    assert fits[0].parameters["c"] == pytest.approx(3.0, rel=1e-6)
    assert fits[1].parameters["c"] == pytest.approx(6.0, rel=1e-6)


def test_the_states_of_an_effect_follow_its_new_rates() -> None:
    recording = moving(np.ones(5))
    base = Model(law(squared))
    states = [Drive(base.plus(lag(rate)), 1.0).states(recording, [0.0, 1.0])[0] for rate in (1.0, 10.0)]
    np.testing.assert_allclose(states[0], recording.time, atol=1e-12)
    np.testing.assert_allclose(states[1], 10 * recording.time, atol=1e-12)


def test_what_was_built_for_a_model_serves_an_equal_one() -> None:
    one, other = (Model.parse("coulomb-viscous+presliding") for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
    assert one.expression() is other.expression()
    assert separable(one) is separable(other)


def test_terms_of_one_class_with_other_settings_are_not_the_same() -> None:
    class Power(Law):
        name = "power"
        c = Parameter("c", "N m", initial=1.0)

        def __init__(self, exponent: int) -> None:
            self.exponent = exponent

        def torque(self, s: Signals, p: Parameters) -> Any:
            return p.c * s.velocity**self.exponent

    assert Power(2) == Power(2)
    assert Power(2) != Power(3)
    recording = moving([1.0, 2.0, 3.0])
    torques = [Drive(Model(Power(n)), 1.0).friction(recording, {"c": 1.0}) for n in (2, 3)]
    np.testing.assert_allclose(torques, [[1, 4, 9], [1, 8, 27]])
