"""Colours can be read on both pages, text is shown as it stands, and Plotly is asked for when it is missing."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import plotly.graph_objects as go
import pytest

from fricmodels.dimension import ACCELERATION, FORCE, INERTIA, Motion
from fricmodels.errors import InputError
from fricmodels.report.figures import DARK, LIGHT, ladder
from fricmodels.report.figures.style import (
    SERIES,
    escaped,
    graph_objects,
    logarithmic,
    shortened,
    styled,
    unit_of,
    words,
)

from .conftest import recoloured

TEXT = ("text", "muted")
LINES = ("measured", "blue", "green", "vermillion", "axis")
PAGES = {"light": (LIGHT, "#ffffff"), "dark": (DARK, DARK["surface"])}


def luminance(colour: str) -> float:
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("page", PAGES)
def test_all_text_has_the_contrast_of_wcag_aa(page):
    theme, background = PAGES[page]
    for part in TEXT:
        assert contrast(theme[part], background) >= 4.5
        assert contrast(theme[part], theme["surface"]) >= 4.5
    for cell in ("few", "some"):
        assert contrast(theme["text"], theme[cell]) >= 4.5


@pytest.mark.parametrize("page", PAGES)
def test_lines_stand_out_from_the_page(page):
    theme, background = PAGES[page]
    for part in LINES:
        assert contrast(theme[part], background) >= 3.0


def test_series_differ_in_colour_dash_and_marker():
    assert len({colour for colour, _, _ in SERIES}) == len(SERIES)
    assert len({marker for _, _, marker in SERIES}) == len(SERIES)
    assert len({dash for _, dash, _ in SERIES[:6]}) == 6


def test_themes_have_the_same_parts_and_no_colour_means_two_things():
    assert set(LIGHT) == set(DARK)
    assert len({*LIGHT.values(), *DARK.values()}) == len(LIGHT) + len(DARK)


def test_a_figure_goes_dark_and_comes_back():
    figure = styled(go.Figure(go.Scatter(x=[1], y=[2], name=LIGHT["blue"], line_color=LIGHT["blue"])), "title")
    dark = recoloured(figure, DARK)
    assert dark.data[0].line.color == DARK["blue"]
    assert dark.data[0].name == LIGHT["blue"]
    assert dark.layout.template.layout.font.color == DARK["text"]
    assert not set(LIGHT.values()) & set(re.findall(r'color": ?"([^"]+)"', dark.to_json()))
    assert json.loads(recoloured(dark, LIGHT).to_json()) == json.loads(figure.to_json())
    assert figure.data[0].line.color == LIGHT["blue"]


def test_what_a_file_is_called_is_neither_markup_nor_a_formula_nor_a_template():
    assert escaped("<b>a</b> & $x$ %{y}\nz") == "&lt;b&gt;a&lt;/b&gt; &amp; &#36;x&#36; %&#123;y} z"
    assert shortened("x" * 80) == "x" * 51 + "…"


def test_units_are_those_of_the_motion():
    assert unit_of("torque", Motion.ROTARY) == "N m"
    assert unit_of("load_torque", Motion.LINEAR) == "N"
    assert unit_of(ACCELERATION, Motion.ROTARY) == "rad/s²"
    assert unit_of(INERTIA, Motion.ROTARY) == "kg m²"
    assert unit_of(FORCE * ACCELERATION, Motion.LINEAR) == "N m/s²"
    assert unit_of("temperature", Motion.ROTARY) == "°C"
    assert words("load_torque", Motion.LINEAR) == "load force"


def test_a_logarithmic_axis_is_labelled_in_plain_numbers():
    axis = logarithmic([0.02, 15.0])
    assert axis["ticktext"] == ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10", "20"]
    assert "1" in logarithmic([0.0])["ticktext"]
    assert logarithmic([1e-6, 1e3])["ticktext"][0] == "1e-06"


def test_without_plotly_the_error_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly", None)
    monkeypatch.setitem(sys.modules, "plotly.graph_objects", None)
    with pytest.raises(InputError, match=r"pip install 'fricmodels\[report\]'"):
        graph_objects()
    with pytest.raises(InputError, match="plotly"):
        ladder(None)


def test_plotly_is_not_imported_before_the_first_figure():
    code = (
        "import fricmodels.report.figures, sys; assert not {'plotly', 'casadi', 'scipy', 'pandas'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
