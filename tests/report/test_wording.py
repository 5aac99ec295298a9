"""Numbers, intervals and units as they are printed."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.report import wording


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [
        (0.0, 3, "0"),
        (15.38, 3, "15.4"),
        (0.28043, 3, "0.280"),
        (9.996e-4, 2, "0.0010"),
        (9.96e-5, 2, "0.00010"),
        (-3.5e-7, 2, "−3.5×10⁻⁷"),
        (123456.0, 3, "1.23×10⁵"),
        (math.nan, 3, "–"),
        (None, 3, "–"),
    ],
)
def test_numbers(value: float | None, digits: int, expected: str) -> None:
    assert wording.number(value, digits) == expected


@given(st.floats(min_value=1e-12, max_value=1e12), st.integers(min_value=1, max_value=8))
def test_a_printed_number_is_the_number_to_its_digits(value: float, digits: int) -> None:
    printed = wording.number(value, digits)
    mantissa, _, power = printed.partition("×10")
    exponent = int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))) if power else 0
    assert float(mantissa) * 10.0**exponent == pytest.approx(value, rel=0.5001 * 10.0 ** (1 - digits))


def test_an_interval_is_as_precise_as_it_is_certain() -> None:
    assert wording.interval(1.81514, 0.000541) == ("1.8151", "± 0.0011")
    assert wording.interval(6.0, 0.4) == ("6.00", "± 0.78")
    assert wording.interval(1.8, None) == ("1.800", "")
    assert wording.interval(0.001, 0.5) == ("0", "± 0.98")
    assert wording.interval(-0.07, 0.5) == ("−0.07", "± 0.98")


@pytest.mark.parametrize(
    ("text", "expected"), [("kg m^2", "kg m²"), ("1", ""), ("N m s^(1/2)/rad^(1/2)", "N m s¹ᐟ²/rad¹ᐟ²")]
)
def test_units(text: str, expected: str) -> None:
    assert wording.unit(text) == expected


def test_words() -> None:
    assert wording.listed(["a", "b", "c"]) == "a, b and c"
    assert wording.listed([]) == ""
    assert wording.counted(2, "effect") == "two effects"
    assert wording.counted(1, "effect") == "one effect"
    assert wording.small(1e-20) == "below one in a million"
    assert wording.known_model("no-such-law") is None
    assert wording.meaning_of("J", {}) == "inertia"


def test_powers_of_ten_in_a_sentence_are_set() -> None:
    assert wording.set_powers("J, 1e-09 kg m², in 2.5e+03 s") == "J, 1×10⁻⁹ kg m², in 2.5×10³ s"
    assert wording.set_powers("a column file_1e5 of 0.001 s") == "a column file_1e5 of 0.001 s"


@pytest.mark.parametrize(
    ("classes", "said"),
    [
        ([], ""),
        ([["a"]], "a"),
        ([["a", "b", "c"]], "a, b or c"),
        ([["a"], ["b"]], "a and b"),
        ([["a"], ["b"], ["c"]], "a, b and c"),
        ([["a", "b"], ["c"]], "a or b, and c"),
        ([["a"], ["b", "c", "d"], ["e"]], "a; b, c or d; and e"),
    ],
)
def test_which_names_are_of_one_class_can_be_read(classes: list[list[str]], said: str) -> None:
    assert wording.listed_classes(classes) == said


@pytest.mark.parametrize(
    ("classes", "said"),
    [
        ([["a"], ["b"]], ""),
        ([["a", "b", "c"], ["d"]], "The values hold with a. With b or c in its place the others may differ."),
        ([["a", "b"], ["c", "d"]], "The values hold with a and c. With a look-alike in the place of one the others"),
    ],
)
def test_parameters_are_those_of_the_chosen_look_alikes(classes: list[list[str]], said: str) -> None:
    assert wording.values_hold_with(classes)[: len(said) or 1] == said


@pytest.mark.parametrize("key", ["J", "M"])
def test_an_inertia_of_nothing_is_explained(key: str) -> None:
    assert "--inertia" in wording.shows_no_inertia({key: 0.0, "K_c": 1.0}, {})
    assert "--inertia" in wording.shows_no_inertia({key: 1.0}, {key: 0.6})
    assert "wrong sign" not in wording.shows_no_inertia({key: 1.0, "K_c": 0.0}, {key: 0.6})
    turned = {"J": "--column torque=NAME:-1*N*m", "M": "--column force=NAME:-1*N"}[key]
    assert turned in wording.shows_no_inertia({key: 0.0, "K_v": 0.0, "K_c": 0.0}, {})
    assert not wording.shows_no_inertia({key: 1.0}, {key: 0.4})
    assert not wording.shows_no_inertia({key: 1.0, "K_c": 0.0}, {"K_c": 1.0}), "it is given"
    assert not wording.shows_no_inertia({"K_c": 0.0}, {})


@pytest.mark.parametrize(("remaining", "said"), [(None, False), (object(), True)])
def test_what_remains_may_have_moved_the_values(remaining: object, said: bool) -> None:
    final = SimpleNamespace(parameters={"K_c": 1.0}, standard_errors={"K_c": 0.1})
    data: Any = SimpleNamespace(steps=[final], effects=[], ladder=[final], remaining=remaining)
    assert any("What remains is not in it" in remark for remark in wording.on_parameters(data)) is said
