"""What holds for every figure: units, bounded size, safe text, and colours for both pages."""

from __future__ import annotations

import base64
import json
import re
from typing import Any

import numpy as np
import pytest

from fricmodels import plugins
from fricmodels.diagnosis.diagnose import Diagnosis
from fricmodels.diagnosis.ladder import Ladder, Rung
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.report import figures
from fricmodels.report.figures import DARK, LIGHT
from fricmodels.report.figures.residuals import changing
from fricmodels.results.diagnosis import Candidate

from .conftest import INERTIA, moved, recoloured

UNIT = re.compile(r"\[[^\]]+\]$")
HOSTILE = "<script>alert(1)</script> $x$"
ROWS = [
    {
        "model": model,
        "estimator": estimator,
        "dataset": dataset,
        "tags": {},
        "status": "ok",
        "held_out_rms_torque_error_percent": 1.0 + i,
    }
    for i, (model, estimator, dataset) in enumerate(
        (m, e, d) for m in ("coulomb-viscous", HOSTILE) for e in ("batch", "ekf") for d in "ab"
    )
]
CANDIDATES = [
    Candidate(name=name, p_value=0.01, share_of_residual=0.2, held_out_gain=gain, gates=gain > 0.1)
    for name, gain in (("cogging", 0.4), ("stribeck", 0.05), (HOSTILE, -0.1))
]


@pytest.fixture(scope="module", params=list(Motion))
def every(request, compared) -> dict[str, Any]:
    """Every figure, on a recording with a hostile name."""
    recording = moved(request.param, name=HOSTILE)
    drive = Drive(Model.parse("coulomb-viscous"), INERTIA, request.param)
    poor, good = compared(recording), compared(recording, "coulomb-viscous+cogging")
    diagnosis = Diagnosis(poor, "missing-effect", (), None, {})
    steps = Ladder(diagnosis, (Rung(poor), Rung(good, added="cogging")), diagnosis, (diagnosis,))
    fit = plugins.load().estimators["ekf"]().fit(drive, recording)
    maps = {name: figures.residual_map(poor, "velocity", name) for name in changing(poor)}
    assert set(maps) == {"position", "acceleration", "load_torque", "temperature", "time"}
    return {
        "overlay": figures.overlay(poor),
        "friction_curve": figures.friction_curve(poor),
        "friction_curve, no cogging left": figures.friction_curve(good),
        "error_against": figures.error_against(poor, "position", good, 2 * np.pi / 5.0),
        "error_against, without the larger model": figures.error_against(poor, "velocity"),
        "error_against, since reversal": figures.error_against(poor, figures.SINCE_REVERSAL, good),
        "stribeck": figures.stribeck(poor, good),
        "coverage": figures.coverage(poor),
        "correlation": figures.correlation(("K_v", HOSTILE), [[1.0, -0.5], [-0.5, 1.0]]),
        "candidates": figures.candidates(CANDIDATES),
        "hysteresis": figures.hysteresis(poor),
        "residual_spectrum": figures.residual_spectrum(poor),
        "error_shares": figures.error_shares(poor),
        "ladder": figures.ladder(steps),
        "parameter_history": figures.parameter_history(fit),
        "leaderboard": figures.leaderboard(ROWS),
        **maps,
    }


def axes(figure: Any) -> dict[str, Any]:
    layout = figure.to_plotly_json()["layout"]
    return {key: layout[key] for key in layout if re.fullmatch(r"[xy]axis\d*", key)}


NAMES_ONLY = {
    ("leaderboard", "yaxis"),
    ("error_shares", "yaxis"),
    ("ladder", "yaxis"),
    ("candidates", "yaxis"),
}
NAMES_ONLY |= {("correlation", "xaxis"), ("correlation", "yaxis")}


def test_every_axis_has_a_unit(every):
    for name, figure in every.items():
        for key, axis in axes(figure).items():
            if (name, key) in NAMES_ONLY or axis.get("matches") or axis.get("showticklabels") is False:
                continue
            assert UNIT.search(axis["title"]["text"]), (name, key)


def test_a_linear_axis_has_no_torque_and_a_rotary_one_no_metre(every):
    texts = [axis["title"]["text"] for figure in every.values() for axis in axes(figure).values() if "title" in axis]
    linear = any("m/s]" in text for text in texts)
    for text in texts:
        assert not (linear and ("N m" in text or "rad" in text or "[1/turn]" in text)), text
        assert not (not linear and ("[N]" in text or "m/s" in text or "[1/m]" in text)), text


def test_every_figure_is_small_however_long_the_recording(every):
    for name, figure in every.items():
        assert len(figure.to_json()) < 150_000, name
        for trace in figure.data:
            if trace.type == "heatmap":
                assert max(np.shape(trace.z)) <= 60, name
            else:
                assert len(trace.x) <= 2000, name


def test_no_name_of_a_file_or_a_plugin_becomes_markup(every):
    for name, figure in every.items():
        for theme in (LIGHT, DARK):
            text = recoloured(figure, theme).to_json()
            assert "<script>" not in text.encode().decode("unicode_escape", "ignore"), name
            assert "$x$" not in text, name


def test_every_figure_goes_dark_whole(every):
    light = set(LIGHT.values())
    for name, figure in every.items():
        left = light & set(strings(json.loads(recoloured(figure, DARK).to_json())))
        assert not left, (name, left)


def strings(tree: Any) -> list[str]:
    if isinstance(tree, dict):
        return [text for value in tree.values() for text in strings(value)]
    if isinstance(tree, list):
        return [text for value in tree for text in strings(value)]
    return [tree] if isinstance(tree, str) else []


def test_every_figure_fits_a_narrow_page(every):
    for name, figure in every.items():
        assert figure.layout.width is None, name
        assert figure.layout.template.layout.legend.orientation == "h"
        title = figure.layout.title.text.split("<br>")
        assert len(re.sub("<[^>]+>", "", title[0])) <= 45, name
        assert len(re.sub("<[^>]+>", "", title[-1]).replace("&lt;", "<").replace("&gt;", ">")) <= 70, name


def test_every_color_is_one_of_the_theme(every):
    """What is not in the theme would stay as it is on a dark page."""
    known = {*LIGHT.values(), "rgba(0,0,0,0)"}
    for name, figure in every.items():
        for key, value in coloured(json.loads(figure.to_json())):
            assert value in known, (name, key, value)


def coloured(tree: Any, key: str = "") -> list[tuple[str, str]]:
    if isinstance(tree, dict):
        return [pair for name, value in tree.items() for pair in coloured(value, name)]
    if isinstance(tree, list):
        return [pair for value in tree for pair in coloured(value, key)]
    return [(key, tree)] if isinstance(tree, str) and "color" in key and key not in ("bdata", "dtype") else []


def test_numbers_are_packed(every):
    """Long arrays are binary in JSON, a fifth of what their digits would take."""
    packed = json.loads(every["overlay"].to_json())["data"][0]["y"]
    assert len(base64.b64decode(packed["bdata"])) == 4 * len(every["overlay"].data[0].y)
