"""Values that hold with a look-alike in the place of an effect: equal models of a drive, with other numbers."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fricmodels.diagnosis import improve
from fricmodels.diagnosis.document import document
from fricmodels.recording import Recording
from fricmodels.report.wording import on_parameters

Made = Callable[..., Recording]
TRUE = {"J": 2.0, "K_v": 0.5, "K_c": 3.0}


def test_the_values_of_both_look_alikes_are_said(made: Made) -> None:
    """A stated inertia a fifth too small is a torque constant that is off as well, with another friction."""
    ladder = improve(made(noise=0.2), "coulomb-viscous", 0.8 * TRUE["J"])
    data = document(ladder.first, ladder)
    (effect,) = data.effects
    assert set(effect.names) == {"torque-gain", "inertia-error"}
    (other,) = effect.in_its_place
    assert {effect.name, other.name} == set(effect.names)
    final = data.steps[-1]
    found = {effect.name: dict(final.parameters), other.name: dict(other.parameters)}
    assert found["inertia-error"]["inertia-error.dJ"] == pytest.approx(0.2 * TRUE["J"], rel=0.02)
    assert found["inertia-error"]["K_v"] == pytest.approx(TRUE["K_v"], rel=0.02)
    assert found["inertia-error"]["K_c"] == pytest.approx(TRUE["K_c"], rel=0.02)
    assert found["torque-gain"]["torque-gain.g"] == pytest.approx(-0.2, abs=0.01)
    assert found["torque-gain"]["K_c"] == pytest.approx(0.8 * TRUE["K_c"], rel=0.02)
    assert other.held_out_percent == pytest.approx(final.held_out_rms_percent, rel=0.02)
    said = " ".join(on_parameters(data))
    assert f"With {other.name} in the place of {effect.name}: " in said
    assert "may differ" not in said


@pytest.mark.long
def test_an_effect_that_stands_alone_has_none(made: Made) -> None:
    ladder = improve(
        made("coulomb-viscous+cogging", {"cogging.a": 2.0, "cogging.k": 7.3}), "coulomb-viscous", TRUE["J"]
    )
    data = document(ladder.first, ladder)
    assert [effect.name for effect in data.effects] == ["cogging"]
    assert data.effects[0].in_its_place == ()
