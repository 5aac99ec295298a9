"""The registry: what is registered, what is left out, and why."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterator
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.hookspecs import hookimpl
from fricmodels.term import Effect, Law

EFFECTS = [
    "asymmetry",
    "torque-offset",
    "stribeck",
    "nonlinear-viscous",
    "load-friction",
    "directional-efficiency",
    "torque-gain",
    "inertia-error",
    "gravity",
    "gravity-friction",
    "stiffness",
    "cogging",
    "position-friction",
    "torque-ripple",
    "presliding",
    "frictional-lag",
    "rising-stiction",
    "backlash",
    "sensor-delay",
    "thermal",
    "drift",
    "step-change",
    "joint-compliance",
    "other",
    "other-friction",
    "other-gravity",
    "chain-gravity",
    "other-inertia",
    "proximal-coupling",
    "run-offset",
]


@pytest.fixture
def fresh() -> Iterator[None]:
    """Let the registry be loaded anew, and again afterwards."""
    plugins.load.cache_clear()
    yield
    plugins.load.cache_clear()


def provided(monkeypatch: pytest.MonkeyPatch, **modules: Any) -> plugins.Plugins:
    """Load the registry with the built-in entry points and these modules, each of a distribution of its own."""
    points: list[Any] = [p for p in importlib.metadata.entry_points(group="fricmodels") if p.dist.name == "fricmodels"]
    for name, module in modules.items():
        points.append(SimpleNamespace(name=name, dist=SimpleNamespace(name=f"dist-{name}"), load=module))
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: points)
    return plugins.load()


def module_with(**hooks: Any) -> Any:
    """Return a loader of a module with hook implementations."""
    module = ModuleType("made")
    for name, hook in hooks.items():
        setattr(module, name, hookimpl(hook))
    return lambda: module


class Rubber(Law):
    """A law of somebody else's."""

    name = "rubber"

    def torque(self, s: Any, p: Any) -> Any:
        return s.velocity


class Unfinished(Effect):
    """An effect without a torque."""

    name = "unfinished"


def test_all_effects_of_the_catalogue_are_registered_by_the_project_itself() -> None:
    registered = plugins.load()
    own = [n for n in registered.effects if registered.effects.entry(n).distribution == "fricmodels"]
    assert sorted(own) == sorted(EFFECTS)


def test_laws_of_others_come_beside_the_built_in_ones(monkeypatch: pytest.MonkeyPatch, fresh: None) -> None:
    registered = provided(monkeypatch, tyre=module_with(fricmodels_laws=lambda: [Rubber]))
    assert registered.laws["rubber"] is Rubber
    assert registered.laws.entry("rubber").distribution == "dist-tyre"
    assert "coulomb-viscous" in registered.laws
    assert registered.failures == ()


def test_a_plugin_that_does_not_import_is_named_and_the_rest_goes_on(
    monkeypatch: pytest.MonkeyPatch, fresh: None
) -> None:
    def broken() -> ModuleType:
        raise ModuleNotFoundError("No module named 'tyres'")

    registered = provided(monkeypatch, bad=broken, tyre=module_with(fricmodels_laws=lambda: [Rubber]))
    assert [str(failure) for failure in registered.failures] == [
        "plugin 'bad' of dist-bad is left out: ModuleNotFoundError: No module named 'tyres'"
    ]
    assert "rubber" in registered.laws


def test_a_hook_that_fails_is_named(monkeypatch: pytest.MonkeyPatch, fresh: None) -> None:
    def hook() -> list[type[Law]]:
        raise ValueError("no licence")

    (failure,) = provided(monkeypatch, bad=module_with(fricmodels_laws=hook)).failures
    assert "fricmodels_laws: ValueError: no licence" in failure.reason


def test_a_class_that_lacks_its_method_or_its_name_is_left_out(monkeypatch: pytest.MonkeyPatch, fresh: None) -> None:
    nameless = type("Nameless", (Law,), {"torque": Rubber.torque})
    registered = provided(
        monkeypatch, bad=module_with(fricmodels_effects=lambda: [Unfinished], fricmodels_laws=lambda: [nameless])
    )
    reasons = " ".join(failure.reason for failure in registered.failures)
    assert "effect 'unfinished' does not write torque" in reasons
    assert "is a law without a name" in reasons
    assert "unfinished" not in registered.effects


def test_a_name_that_is_taken_stays_with_its_first_owner(monkeypatch: pytest.MonkeyPatch, fresh: None) -> None:
    other = type("Other", (Rubber,), {"name": "coulomb-viscous"})
    registered = provided(monkeypatch, bad=module_with(fricmodels_laws=lambda: [other]))
    assert registered.laws["coulomb-viscous"] is not other
    assert registered.failures[0].reason == "law 'coulomb-viscous' is already provided by fricmodels"


def test_an_unknown_name_is_answered_with_the_nearest_one() -> None:
    with pytest.raises(InputError, match=r"unknown law 'coulom-viscous'; did you mean 'coulomb-viscous'\?"):
        _ = plugins.load().laws["coulom-viscous"]


def test_registries_are_loaded_once() -> None:
    assert plugins.load() is plugins.load()
    assert len(plugins.load().laws) == len(list(plugins.load().laws))


def test_a_name_that_a_left_out_plugin_may_have_is_told_apart_from_a_mistake(
    monkeypatch: pytest.MonkeyPatch, fresh: None
) -> None:
    """Where a whole plugin is left out any unknown name may be its own; where one class is, only that name is."""
    one = provided(monkeypatch, bad=module_with(fricmodels_effects=lambda: [Unfinished]))
    with pytest.raises(plugins.LeftOut, match="effect 'unfinished' cannot be used: plugin 'bad' of dist-bad"):
        _ = one.effects["unfinished"]
    with pytest.raises(InputError, match="did you mean 'cogging'") as mistaken:
        _ = one.effects["coging"]
    assert not isinstance(mistaken.value, plugins.LeftOut)
    plugins.load.cache_clear()

    def broken() -> ModuleType:
        raise ModuleNotFoundError("No module named 'tyres'")

    with pytest.raises(plugins.LeftOut, match=r"unknown effect 'tread'.*No module named 'tyres'"):
        _ = provided(monkeypatch, bad=broken).effects["tread"]


def test_a_class_that_cannot_be_made_is_left_out(monkeypatch: pytest.MonkeyPatch, fresh: None) -> None:
    def refuse(self: Any) -> None:
        raise OSError("no licence")

    costly = type("Costly", (Rubber,), {"name": "costly", "__init__": refuse})
    registered = provided(monkeypatch, bad=module_with(fricmodels_laws=lambda: [costly, Rubber]))
    assert registered.failures[0].reason == "law 'costly' cannot be made: OSError: no licence"
    assert "rubber" in registered.laws
