"""What parameters and states declare."""

from __future__ import annotations

import pytest

from fricmodels import plugins
from fricmodels.dimension import FORCE, VELOCITY, Motion
from fricmodels.errors import InputError
from fricmodels.parameter import Parameter, State
from fricmodels.term import Term


def everything() -> list[type[Term]]:
    registered = plugins.load()
    return [*(registered.laws[name] for name in registered.laws), *(registered.effects[n] for n in registered.effects)]


def test_the_linear_unit_follows_from_the_rotary_one() -> None:
    viscous = Parameter("K_v", unit="N m s/rad")
    assert viscous.dimension == FORCE * VELOCITY**-1
    assert (viscous.unit_for(Motion.ROTARY), viscous.unit_for(Motion.LINEAR)) == ("N m s/rad", "N s/m")


@pytest.mark.parametrize(("initial", "lower", "upper"), [(-1.0, 0.0, 1.0), (2.0, 0.0, 1.0), (0.0, 1.0, -1.0)])
def test_an_initial_value_outside_its_bounds_is_refused(initial: float, lower: float, upper: float) -> None:
    with pytest.raises(ValueError, match="outside"):
        Parameter("x", initial=initial, lower=lower, upper=upper)


def test_a_unit_that_cannot_be_read_is_named() -> None:
    with pytest.raises(InputError, match="lbf"):
        _ = Parameter("x", unit="lbf").dimension
    with pytest.raises(InputError, match="lbf"):
        _ = State("x", unit="lbf").dimension


@pytest.mark.parametrize("term", everything(), ids=lambda term: str(term.name))
def test_every_declared_parameter_has_words_a_unit_and_sensible_scans(term: type[Term]) -> None:
    for parameter in term.parameters:
        assert parameter.meaning
        assert parameter.unit_for(Motion.LINEAR)
        assert len(parameter.scan) == len(set(parameter.scan))
        if parameter.upper < float("inf"):
            assert all(value <= parameter.upper for value in parameter.scan)
    for state in term.states:
        assert state.meaning
        assert state.dimension is not None
