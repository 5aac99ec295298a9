"""A test that takes ``term`` runs for every law and every effect."""

from __future__ import annotations

import pytest

from fricmodels import plugins


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "term" in metafunc.fixturenames:
        registered = plugins.load()
        terms = [registered.laws[name]() for name in registered.laws]
        terms += [registered.effects[name]() for name in registered.effects]
        metafunc.parametrize("term", terms, ids=[term.name for term in terms])
