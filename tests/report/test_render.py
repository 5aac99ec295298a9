"""A page as one file: complete, quiet, the same bytes for the same content, and names are never markup."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
import re
from functools import cache
from pathlib import Path

import plotly.graph_objects as go
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.errors import InputError
from fricmodels.report import write
from fricmodels.report.page import (
    Code,
    Equations,
    Fold,
    Gallery,
    Heading,
    Page,
    Picture,
    Points,
    Section,
    Tile,
    Verdict,
    Words,
    table,
)
from fricmodels.report.render import asset, figure_names, fragment, held, plotly_script, render

SCRIPTS = re.compile(r"<script([^>]*)>(.*?)</script>", re.DOTALL)


def page(name: str = "drive", *, pictures: bool = True) -> Page:
    figure = go.Figure(go.Scatter(x=[1.0, 2.0], y=[3.0, 4.0], name=name))
    figure.update_layout(title_text=name, height=300)
    grid = table(name, {name: False, "value": True}, [(name, "1")])
    blocks = [
        Words(name),
        Heading(name, remark=name),
        Points([name]),
        Equations([("x", name)]),
        grid,
        Code(name, name),
        Fold(name, [Gallery([Picture(name, name, figure, grid)])] if pictures else [Words(name)]),
    ]
    return Page(name, name, Verdict(name, "good", [name]), [Tile(name, name, name)], [Section("s", name, blocks)], name)


def packed(text: str, name: str) -> str:
    match = re.search(rf'<script type="application/octet-stream" id="{name}"[^>]*>([^<]*)</script>', text)
    assert match is not None
    return gzip.decompress(base64.b64decode(match[1])).decode()


def test_equal_pages_give_equal_bytes() -> None:
    assert render(page()) == render(page())


def test_the_policy_admits_the_two_programs_of_the_page_and_no_traffic() -> None:
    text = render(page())
    policy = html.unescape(re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1])  # type: ignore[index]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    assert not {"connect-src", "frame-src", "font-src", "media-src", "object-src"} & set(rules)
    programs = [asset("report.js"), plotly_script()]
    digests = [base64.b64encode(hashlib.sha256(program.encode()).digest()).decode() for program in programs]
    assert rules["script-src"] == " ".join(f"'sha256-{digest}'" for digest in digests)
    executed = [content for attributes, content in SCRIPTS.findall(text) if "type=" not in attributes]
    assert executed == [asset("report.js")]
    assert packed(text, "plotly") == plotly_script()


def test_figures_are_inside_without_their_template() -> None:
    content = json.loads(packed(render(page("motor")), "figure-1-data"))
    assert content["data"][0]["name"] == "motor"
    assert "template" not in content["layout"]
    looks = json.loads(packed(render(page()), "looks"))
    assert looks["light"].keys() == looks["dark"].keys()
    assert looks["template"]["layout"]["font"]


def test_a_page_without_figures_carries_no_library() -> None:
    assert len(render(page(pictures=False))) < 50_000


@cache
def plainly() -> str:
    return render(page("ab", pictures=False))


@settings(deadline=None, max_examples=40)
@given(st.text(alphabet="ab<>&\"'/=`{}%$#!-; \n\\|^_(", max_size=40))
def test_no_name_becomes_markup(name: str) -> None:
    plain, hostile = plainly(), render(page(f"ab{name}", pictures=False))
    shape = re.compile(r"<\s*(/?\w+)")
    mathematics = re.compile(r"<math.*?</math>|<style>.*?</style>|<script>.*?</script>", re.DOTALL)
    assert shape.findall(mathematics.sub("", hostile)) == shape.findall(mathematics.sub("", plain))
    assert "<script>" not in hostile.replace("<script>" + asset("report.js"), "")


def test_a_figure_cannot_end_its_element() -> None:
    text = render(page("</script><script>alert(1)</script>"))
    assert len(SCRIPTS.findall(text)) == 4
    assert json.loads(packed(text, "figure-1-data"))["data"][0]["name"].startswith("</script>")


def test_the_file_is_written_whole_and_its_folder_is_made(tmp_path: Path) -> None:
    path = write(page(pictures=False), tmp_path / "new" / "report.html")
    assert path.read_text(encoding="utf-8") == render(page(pictures=False))
    assert [file.name for file in path.parent.iterdir()] == ["report.html"]
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write(page(pictures=False), tmp_path / "file" / "report.html")


def luminance(colour: str) -> float:
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_in_figures_has_the_contrast_of_WCAG_AA(scheme: str) -> None:
    """What axe cannot judge: text drawn as SVG, on the ground of the page."""
    from fricmodels.report.figures import style

    grounds = re.findall(r"--ground: (#\w{6})", asset("report.css"))
    ground = luminance({"light": grounds[0], "dark": grounds[1]}[scheme])
    colours = {"light": style.LIGHT, "dark": style.DARK}[scheme]
    for part in ("text", "muted"):
        brighter, darker = sorted([luminance(colours[part]), ground], reverse=True)
        assert (brighter + 0.05) / (darker + 0.05) >= 4.5, part


def test_a_fragment_is_a_piece_of_a_page_with_its_figures() -> None:
    figure = go.Figure(go.Scatter(x=[1.0], y=[2.0], name="a"))
    text, figures = fragment([Words("a < b"), Picture("one", "two", figure, name="spectrum")])
    assert text.startswith("<p>a &lt; b</p>")
    assert 'id="spectrum"' in text
    assert "<html" not in text
    assert json.loads(figures["spectrum"])["data"][0]["name"] == "a"


def test_figures_keep_their_names_wherever_they_stand() -> None:
    figure = go.Figure()
    listed = [Picture("a", "b", figure, name=name) for name in ("spectrum", "Load torque", "spectrum")]
    assert [*figure_names(listed).values()] == ["spectrum", "load-torque", "spectrum-2"]


def test_a_number_stays_on_one_line_with_its_unit() -> None:
    text = held("by 0.00421 N m RMS at 26.7 rad/s, per sample (1 ms), 3 % of 8 000 samples in 2 sets")
    assert text.replace("\u00a0", "_") == (
        "by 0.00421_N_m RMS at 26.7_rad/s, per sample (1_ms), 3_% of 8 000 samples in 2 sets"
    )
