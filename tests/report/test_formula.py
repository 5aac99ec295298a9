"""Formulas of laws and effects as MathML: well formed whatever the text, and right where it can be read off."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels import plugins
from fricmodels.report.formula import mathml, symbol


def tree(element: str) -> ElementTree.Element:
    return ElementTree.fromstring(element)


def text(element: str) -> str:
    return "".join(tree(element).itertext())


FORMULAS = [
    (name, entry.cls.formula)
    for registry in (plugins.load().laws, plugins.load().effects)
    for name in registry
    if (entry := registry.entry(name)).cls.formula
]


@pytest.mark.parametrize(("name", "formula"), FORMULAS)
def test_every_registered_formula_is_set_and_nothing_is_lost(name: str, formula: str) -> None:
    lines = mathml(formula)
    assert len(lines) == formula.count("; ") + 1
    for line in lines:
        root = tree(line)
        assert root.tag == "math"
        assert root.get("aria-label")
    letters = {c for c in formula if c.isalpha()}
    assert letters <= set("".join(map(text, lines)))


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("K_v·ω", "<msub><mi>K</mi><mi>v</mi></msub>"),
        ("|ω|^(1/2)", "<mrow><mn>1</mn><mo>/</mo><mn>2</mn></mrow></msup>"),
        ("ω²", "<msup><mi>ω</mi><mn>2</mn></msup>"),
        ("(1 − z)/T", "<mfrac><mrow><mn>1</mn><mo>−</mo><mi>z</mi></mrow><mi>T</mi></mfrac>"),
        ("dτ_m/dt", "<mfrac><mrow><mi>d</mi><msub><mi>τ</mi><mi>m</mi></msub></mrow><mrow><mi>d</mi><mi>t</mi></mrow>"),
        ("γ2", "<msub><mi>γ</mi><mn>2</mn></msub>"),
        ("sgn₁ω", "<msub><mi>sgn</mi><mn>1</mn></msub>"),
        ("cos kq", "<mi>k</mi><mi>q</mi>"),
        ("= −g", '<mo form="prefix">−</mo>'),
    ],
)
def test_parts_of_formulas(formula: str, expected: str) -> None:
    assert expected in mathml(formula)[0]


def test_symbols_of_parameters() -> None:
    assert text(symbol("stribeck.omega_s")) == "ωs"
    assert text(symbol("delta")) == "δ"
    assert text(symbol("K_v1")) == "Kv1"


@given(st.text(alphabet="ab_^/()[]|·+−²₁τω<>&\"'; 12", max_size=60))
def test_any_text_gives_well_formed_mathematics(formula: str) -> None:
    for line in mathml(formula):
        tree(line)


def test_nesting_beyond_reason_is_shown_as_it_stands() -> None:
    assert text(mathml("(" * 5000)[0]) == "(" * 5000
