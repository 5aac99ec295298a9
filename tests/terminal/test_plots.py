"""Plots made of characters: values stand where they belong, peaks are kept, marks tell series apart."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from fricmodels.terminal import Band, Marks, bar, show_plot


def printed(series: list[Band], width: int = 80, encoding: str = "utf-8") -> list[str]:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    show_plot(Console(file=stream, width=width), series, "time [s]", "[N m]")
    stream.seek(0)
    return stream.read().splitlines()


def canvas(lines: list[str]) -> list[str]:
    return [line.partition("│")[2] for line in lines if "│" in line]


def test_a_line_rises_from_corner_to_corner() -> None:
    x = np.linspace(0, 1, 1000)
    rows = canvas(printed([Band("line", "o", x, 3 * x)]))
    assert rows[0].rstrip().endswith("o")
    assert rows[-1].startswith("o")
    at = [row.index("o") for row in rows]
    assert at == sorted(at, reverse=True)
    assert all("o" in column for column in zip(*(f"{row:<70}"[:70] for row in rows), strict=True))


def test_a_single_peak_among_a_million_samples_is_seen() -> None:
    x = np.arange(1_000_000.0)
    y = np.zeros(1_000_000)
    y[123_456] = 7.0
    lines = printed([Band("peak", "o", x, y)])
    rows = canvas(lines)
    assert rows[0].count("o") == 1
    assert rows[0].index("o") == pytest.approx(0.123456 * 75, abs=1)
    assert lines[1].split()[0] == "7"


def test_what_is_drawn_last_lies_on_top_and_the_legend_names_both() -> None:
    x = np.linspace(0, 1, 100)
    lines = printed([Band("measured", ".", x, x), Band("modelled", "o", x, x)])
    assert "." not in "".join(canvas(lines))
    assert ". measured" in lines[0]
    assert "o modelled" in lines[0]
    assert "[N m]" in lines[0]
    assert "time [s]" in lines[-1]


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.floats(-1e12, 1e12) | st.just(float("nan")), min_size=1, max_size=40),
    st.integers(40, 140),
    st.sampled_from(["utf-8", "ascii"]),
)
def test_any_values_fit(values: list[float], width: int, encoding: str) -> None:
    y = np.array(values)
    series = [Marks("points", "o", np.arange(len(y), dtype=float), y)]
    lines = printed(series, width, encoding)
    assert all(len(line) <= width for line in lines)
    if np.isfinite(y).any():
        assert sum(line.count("o") for line in lines) > 1


def test_a_bar_is_as_long_as_its_share() -> None:
    assert bar(1.0, 8) == "█" * 8
    assert bar(0.5, 8) == "█" * 4
    assert bar(0.0, 8) == ""
    assert bar(1e-9, 8) == "▏"
    assert bar(0.5, 8, ascii_only=True) == "####"
    assert bar(1e-9, 8, ascii_only=True) == "#"
    lengths = [len(bar(share, 20)) for share in np.linspace(0, 1, 200)]
    assert lengths == sorted(lengths)
