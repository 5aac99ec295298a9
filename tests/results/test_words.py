"""Words and numbers that several views say."""

from __future__ import annotations

import pytest

from fricmodels.results import words


@pytest.mark.parametrize(
    ("value", "text"), [(140.3, "140"), (31.2, "31"), (0.0885, "0.088"), (0.0, "0"), (9_960.0, "10000"), (2e9, "2e+09")]
)
def test_figures_have_no_power_of_ten_where_a_plain_number_can_be_read(value: float, text: str) -> None:
    assert words.figures(value) == text


def test_noise_that_is_rounding_has_no_digits() -> None:
    assert words.noise_text(3.45e-9) == words.noise_text(2.9e-9) == "< 0.1 %"
    assert (words.noise_text(0.2371), words.noise_text(0.2371, 2)) == ("0.237 %", "0.24 %")


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.8123, 0.021, "1.812 ± 0.021"),
        (1.0e4, 1.8e8, "10000 ± 1.8e+08"),
        (0.034, 0.2, "0.03 ± 0.2"),
        (-0.034, 0.2, "-0.03 ± 0.2"),
        (0.0, 3.4, "0 ± 3.4"),
    ],
)
def test_a_value_has_the_figures_that_its_error_bears_and_one_where_that_is_none(
    value: float, error: float, text: str
) -> None:
    assert words.with_spread(value, error) == text
