"""What a law or an effect may declare, and what it sees."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from fricmodels.errors import InputError
from fricmodels.expressions import Expression
from fricmodels.model import Model
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Law, Parameters, Signals


class Viscous(Law):
    """Viscous friction."""

    name = "viscous"
    K_v = Parameter("K_v", unit="N m s/rad")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        return p.K_v * s.velocity


def test_parameters_and_states_are_collected_in_order_and_inherited() -> None:
    class Lagged(Viscous):
        name = "lagged"
        T = Parameter("T", unit="s", initial=1.0)
        K_v = Parameter("K_v", unit="N m s/rad", lower=0.0)
        z = State("z")

    assert [p.symbol for p in Viscous.parameters] == ["K_v"]
    assert [p.symbol for p in Lagged.parameters] == ["T", "K_v"], "what is declared again replaces what was inherited"
    assert [z.symbol for z in Lagged.states] == ["z"]


def test_a_symbol_is_declared_once() -> None:
    with pytest.raises(TypeError, match="declared twice"):
        type("Doubled", (Viscous,), {"name": "doubled", "a": Parameter("x"), "b": Parameter("x")})
    with pytest.raises(TypeError, match="declared twice"):
        type("Doubled", (Viscous,), {"name": "doubled", "a": Parameter("x"), "b": State("x")})


def test_a_bound_by_another_parameter_needs_that_parameter() -> None:
    with pytest.raises(TypeError, match="at least 'C'"):
        type("Unbounded", (Viscous,), {"name": "unbounded", "a": Parameter("K_c", at_least="C")})


def test_signals_remember_what_was_touched_and_states_are_not_signals() -> None:
    s = Signals({"velocity": 1.0, "position": 2.0}, {"z": 3.0})
    assert (s.velocity, s.z) == (1.0, 3.0)
    assert s.touched == {"velocity"}


def test_what_is_not_there_is_named_with_what_is() -> None:
    with pytest.raises(AttributeError, match=r"'speed'.*velocity, z"):
        _ = Signals({"velocity": 1.0}, {"z": 3.0}).speed
    with pytest.raises(AttributeError, match=r"'K'.*K_v"):
        _ = Parameters({"K_v": 1.0}).K


def test_a_state_without_a_rate_is_refused() -> None:
    class Forgetful(Effect):
        """It declares a state that never changes."""

        name = "forgetful"
        z = State("z")

        def torque(self, s: Signals, p: Parameters) -> Expression:
            return s.z

        def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
            return {}

    with pytest.raises(InputError, match="no rate for its state 'z'"):
        Model(Viscous(), [Forgetful()]).expression()


def test_a_term_without_a_torque_cannot_be_made() -> None:
    with pytest.raises(TypeError, match="torque"):
        type("Empty", (Law,), {"name": "empty"})()
