"""Models: names, parameters, needs, and which parameters are linear."""

from __future__ import annotations

import pytest

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.model import Model


def linear(name: str) -> dict[str, bool]:
    model = Model.parse(name)
    return {p.key: flag for p, flag in zip(model.parameters, model.linear, strict=True)}


@pytest.mark.parametrize(
    "name", ["coulomb-viscous", "square-root+cogging", "coulomb-viscous+presliding+backlash+drift"]
)
def test_a_name_is_read_back(name: str) -> None:
    model = Model.parse(name)
    assert model.name == name
    assert model == Model.parse(name)
    assert hash(model) == hash(Model.parse(name))


def test_spaces_around_names_do_not_matter() -> None:
    assert Model.parse(" coulomb-viscous + cogging ").name == "coulomb-viscous+cogging"


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("coulom-viscous", "unknown law 'coulom-viscous'; did you mean 'coulomb-viscous'?"),
        ("coulomb-viscous+coging", "unknown effect 'coging'; did you mean 'cogging'?"),
        ("coulomb-viscous+", "unknown effect ''; known: asymmetry, backlash"),
        (
            "cogging",
            "'cogging' is an effect, and a model begins with a law: write LAW+cogging, such as",
        ),
        ("stribeck+cogging", "such as coulomb-viscous+stribeck+cogging"),
        ("coulomb-viscous+square-root", "a model has one law, and 'coulomb-viscous' and 'square-root' are two"),
        ("coulomb-viscous+coulomb-viscous", "a model has one law, and 'coulomb-viscous' stands twice"),
        ("", "unknown law ''; known: "),
        ("coulomb-viscous+cogging+cogging", "has an effect twice"),
    ],
)
def test_a_wrong_name_is_refused_with_the_nearest_right_one(name: str, told: str) -> None:
    with pytest.raises(InputError) as refused:
        Model.parse(name)
    assert told in str(refused.value)
    assert "\n" not in str(refused.value)


def test_effects_are_added_and_taken_away() -> None:
    model = Model.parse("coulomb-viscous+cogging")
    bigger = model.plus(plugins.load().effects["gravity"]())
    assert bigger.name == "coulomb-viscous+cogging+gravity"
    assert bigger.minus("cogging").name == "coulomb-viscous+gravity"
    assert model.name == "coulomb-viscous+cogging"


def test_parameters_of_effects_carry_the_effects_name() -> None:
    model = Model.parse("exponential-stick-slip+cogging")
    cogging = [f"cogging.{symbol}" for symbol in ("a", "b", "a_2", "b_2", "k")]
    assert [p.key for p in model.parameters] == ["K_v", "K_c", "C", "B", *cogging]
    assert model.parameters[1].at_least == "C"


@pytest.mark.parametrize(
    ("name", "needs"),
    [
        ("coulomb-viscous", {"velocity"}),
        ("coulomb-viscous+torque-offset", {"velocity"}),
        ("coulomb-viscous+cogging", {"velocity", "position"}),
        ("coulomb-viscous+torque-ripple", {"velocity", "position", "motor_torque"}),
        ("coulomb-viscous+thermal", {"velocity", "temperature"}),
        ("coulomb-viscous+load-friction+drift", {"velocity", "load_torque", "time"}),
        ("coulomb-viscous+joint-compliance", {"velocity", "acceleration"}),
        ("coulomb-viscous+sensor-delay", {"velocity", "motor_torque_rate"}),
    ],
)
def test_a_model_needs_the_signals_that_its_equations_touch(name: str, needs: set[str]) -> None:
    assert Model.parse(name).needs == needs


def test_linear_parameters_are_found_from_the_expression() -> None:
    assert all(linear("asymmetric-coulomb-viscous").values())
    assert linear("exponential-stick-slip") == {"K_v": True, "K_c": True, "C": True, "B": False}
    assert linear("coulomb-viscous+cogging")["cogging.k"] is False
    assert linear("coulomb-viscous+cogging")["cogging.a"] is True
    found = linear("coulomb-viscous+stribeck+step-change")
    assert [key for key, flag in found.items() if not flag] == ["stribeck.omega_s", "stribeck.delta", "step-change.t_0"]


def test_what_shapes_the_memory_is_nonlinear_and_what_scales_it_is_linear() -> None:
    contact = linear("coulomb-viscous+presliding")
    assert (contact["presliding.F_1"], contact["presliding.x_s"]) == (True, False)
    lag = linear("coulomb-viscous+frictional-lag")
    assert (lag["frictional-lag.F_s"], lag["frictional-lag.K"]) == (True, True)
    assert [lag[f"frictional-lag.{symbol}"] for symbol in ("omega_s", "T", "r")] == [False] * 3


def test_adding_an_effect_changes_nothing_in_the_others() -> None:
    alone, together = linear("coulomb-viscous+stribeck"), linear("coulomb-viscous+cogging+stribeck+presliding")
    assert {key: together[key] for key in alone} == alone
