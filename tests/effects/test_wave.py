"""Torques that are periodic in position: a model may have several of a kind."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.effects import Cogging
from fricmodels.errors import InputError
from fricmodels.model import Model


def test_each_has_its_own_parameters() -> None:
    model = Model.parse("coulomb-viscous+cogging+cogging(2)")
    assert model.name == "coulomb-viscous+cogging+cogging(2)"
    assert [p.key for p in model.parameters][-5:] == [
        f"cogging(2).{symbol}" for symbol in ("a", "b", "a_2", "b_2", "k")
    ]
    assert Model.parse("coulomb-viscous + cogging + cogging(2)") == model


def test_the_torques_add_up() -> None:
    both = Model.parse("coulomb-viscous+cogging+cogging(2)")
    values = {"cogging.a": 0.3, "cogging.k": 7.0, "cogging(2).b": 0.2, "cogging(2).k": 17.0}
    position = np.linspace(-2.0, 3.0, 50)
    expected = 0.3 * np.cos(7.0 * position) + 0.2 * np.sin(17.0 * position)
    parameters = [values.get(p.key, 0.0) for p in both.parameters]
    torque = Drive(both, 1.0).torque_of({"position": position, "velocity": 0.0 * position}, parameters, (), 1e-6)
    assert torque == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("argument", ["1", "0", "-2", "x", "10", "2.0", "²"])
def test_what_is_no_further_wave_is_refused(argument: str) -> None:
    with pytest.raises(InputError, match=r"a further wave has a number from 2 to 9, such as cogging\(2\)"):
        Model.parse(f"coulomb-viscous+cogging({argument})")


def test_another_has_the_next_number_and_there_is_an_end() -> None:
    wave: Cogging | None = Cogging()
    names = []
    while wave is not None:
        names.append(wave.name)
        assert wave.first_of_kind() == Cogging()
        wave = wave.another()
    assert names == ["cogging", *(f"cogging({i})" for i in range(2, 10))]
    assert Cogging(2) != Cogging(3)
    assert Cogging.named("3") == Cogging(3)
