"""Captions are computed: they say what the figure shows, on recordings of ten kinds."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest

from fricmodels.diagnosis.comparison import Comparison, compare_model, kept_back
from fricmodels.diagnosis.where import in_words
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report import pictures
from fricmodels.report.captions import map_words, where_words
from fricmodels.report.figure_tables import points_of
from fricmodels.report.figures.samples import Samples
from fricmodels.weakform.prepared import ready

Made = Callable[..., Recording]
KINDS = {
    "nothing": ("coulomb-viscous", {}),
    "gravity": ("coulomb-viscous+gravity", {"gravity.a": 1.5, "gravity.b": 0.5}),
    "cogging": ("coulomb-viscous+cogging", {"cogging.a": 0.6, "cogging.k": 7.3}),
    "stribeck": ("coulomb-viscous+stribeck", {"stribeck.F_s": 1.5, "stribeck.omega_s": 0.3}),
    "offset": ("coulomb-viscous+torque-offset", {"torque-offset.c": 0.5}),
    "stiffness": ("coulomb-viscous+stiffness", {"stiffness.k": 0.8}),
    "asymmetry": ("coulomb-viscous+asymmetry", {"asymmetry.c": 0.5, "asymmetry.d": 0.1}),
    "inertia": ("coulomb-viscous+inertia-error", {"inertia-error.epsilon": 0.1}),
    "waves": (
        "coulomb-viscous+position-friction",
        {"position-friction.a": 0.6, "position-friction.k": 5.0},
    ),
    "one direction": ("coulomb-viscous", {}),
}


@pytest.fixture(scope="module", params=[*KINDS])
def comparison(request: pytest.FixtureRequest, made: Made) -> Comparison:
    model, values = KINDS[request.param]
    known = {p.key: p.declared.initial for p in Model.parse(model).parameters if p.key not in ("K_v", "K_c")}
    recording = made(model, {**known, **values}, samples=4000)
    if request.param == "one direction":
        speed = np.abs(recording["velocity"])
        recording = replace(recording.with_channels(derived=False, velocity=speed), name="one way")
    train, test = kept_back(ready(recording))
    return compare_model(train, test, Drive(Model.parse("coulomb-viscous"), 2.0))


def _number(text: str) -> float:
    mantissa, _, power = text.replace("−", "-").partition("×10")
    return float(mantissa) * 10.0 ** float(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)


def test_no_caption_contradicts_its_data(comparison: Comparison) -> None:
    samples = Samples.of(comparison)
    for picture in [pictures.over_time(comparison), pictures.curve(comparison), *pictures.marks(comparison)]:
        assert "remembers" not in picture.message
        assert "whatever the" not in picture.message
        if picture.name.startswith("map-"):
            ends = re.findall(r"between (\S+) and (\S+)", picture.message)[0]
            low, high = (_number(text) for text in ends)
            drawn = np.asarray(picture.figure.data[0].z, dtype=float)
            assert low == pytest.approx(np.nanmin(drawn), rel=0.01, abs=1e-4)
            assert high == pytest.approx(np.nanmax(drawn), rel=0.01, abs=1e-4)
    words, worst = where_words(comparison, most=3), max(comparison.where, key=lambda row: row.rms_torque_error)
    if "about the same" not in words:
        first = re.match(r"The error is largest (.*?) \((\S+) N m RMS, (\S+) % of the samples\)", words)
        assert first is not None, words
        assert first[1] == in_words(worst.regime), "the regime that is named first is the one with the largest error"
        assert _number(first[2]) == pytest.approx(worst.rms_torque_error, rel=0.01)
        assert float(first[3]) == pytest.approx(100 * worst.share_of_samples, rel=0.06, abs=0.01)
        sizes = [_number(text) for text in re.findall(r"\((\S+) N m RMS", words)]
        assert sizes == sorted(sizes, reverse=True)
        assert all(size > comparison.errors.SI for size in sizes)
    low = pictures.low_speed(comparison)
    points = {str(trace.name): np.asarray(trace.y) for trace in low.figure.data}
    sides = [side for side in ("forward", "backward") if f"measured {side}, 95 % bars" in points]
    apart = np.concatenate([points[f"measured {side}, 95 % bars"] - points[f"modelled, {side}"] for side in sides])
    said = re.search(r"lie (\S+) N m RMS apart", low.message)
    assert said is not None
    assert _number(said[1]) == pytest.approx(float(np.sqrt(np.mean(apart**2))), rel=0.01)
    assert f"{len(samples.place):,}".replace(",", "\u202f") in pictures.over_time(comparison).message


def test_measured_and_modelled_are_drawn_at_the_same_samples(comparison: Comparison) -> None:
    """Zoomed in, the two curves differ by the error and by nothing else."""
    samples = Samples.of(comparison)
    measured, modelled, residual = pictures.over_time(comparison).figure.data[:3]
    assert np.array_equal(measured.x, modelled.x)
    shown = ~np.isnan(measured.y)
    at = np.searchsorted(samples.place, measured.x[shown])
    size = float(np.nanmax(np.abs(measured.y)))
    assert measured.y[shown] - modelled.y[shown] == pytest.approx(samples.error[at], abs=1e-6 * size)
    assert residual.y[shown] == pytest.approx(samples.error[at], abs=1e-6 * size)


def test_a_map_of_two_filled_rows_is_not_said_to_change_with_one_quantity() -> None:
    grid = np.full((12, 12), np.nan)
    grid[3], grid[8] = 1.0, -1.0
    figure = go.Figure(go.Heatmap(z=grid, colorbar={"title": {"text": "mean residual [N m]"}}))
    figure.update_layout(xaxis_title="velocity [rad/s]", yaxis_title="acceleration [rad/s²]")
    assert "alone explains" not in map_words(figure)
    full = np.repeat(np.linspace(-1, 1, 12)[:, None], 12, axis=1)
    figure.data[0].z = full
    assert "acceleration alone explains" in map_words(figure)


def test_no_row_of_a_table_is_called_none(comparison: Comparison) -> None:
    shown = points_of(pictures.curve(comparison).figure)
    assert shown is not None
    assert not {"None", ""} & {row[0] for row in shown.rows}


def test_what_an_effect_adds_takes_the_mean_error_away(made: Made) -> None:
    recording = made("coulomb-viscous+cogging", {"cogging.a": 0.6, "cogging.k": 7.3}, samples=6000)
    train, test = kept_back(ready(recording))
    before, after = (
        compare_model(train, test, Drive(Model.parse(name), 2.0), start)
        for name, start in (("coulomb-viscous", None), ("coulomb-viscous+cogging", {"cogging.k": 7.3}))
    )
    effect = Model.parse("coulomb-viscous+cogging").effects[0]
    picture = pictures.evidence(before, effect, after, {"k": 7.3})
    assert picture.figure.layout.xaxis.title.text == "position within one period [rad]"
    errors, added, left = picture.figure.data
    assert float(np.max(added.y)) == pytest.approx(0.6, rel=0.1)
    assert np.sqrt(np.mean(left.y**2)) < 0.1 * np.sqrt(np.mean(errors.y**2))
    assert np.mean(np.abs(errors.y - added.y - left.y)) < 1e-9
    inside = np.abs(errors.y - added.y) <= errors.error_y.array
    assert np.mean(inside) > 0.8, "the curve runs through the 95 % bars"


def test_friction_that_opposes_the_motion_is_shown_opposing_it(made: Made) -> None:
    """Over the position, waves of friction cancel between the directions; opposing the motion they are seen."""
    whole = "coulomb-viscous+position-friction"
    recording = made(whole, {"position-friction.a": 0.6, "position-friction.k": 5.0}, samples=6000)
    train, test = kept_back(ready(recording))
    before, after = (
        compare_model(train, test, Drive(Model.parse(name), 2.0), start)
        for name, start in (
            ("coulomb-viscous", None),
            ("coulomb-viscous+position-friction", {"position-friction.k": 5.0}),
        )
    )
    effect = Model.parse("coulomb-viscous+position-friction").effects[0]
    picture = pictures.evidence(before, effect, after, {"k": 5.0})
    assert picture.figure.layout.yaxis.title.text == "torque error, opposing motion [N m]"
    assert "Counted opposing the motion" in picture.message
    assert float(np.max(picture.figure.data[1].y)) == pytest.approx(0.6, rel=0.1)


def test_a_delay_is_shown_over_the_rate_of_the_torque(made: Made) -> None:
    """A delay T adds T·dτ_m/dt: the mean error over that rate is a line of slope T, less what the law took of it."""
    delay = 0.02
    recording = made("coulomb-viscous+sensor-delay", {"sensor-delay.T": delay}, samples=6000)
    train, test = kept_back(ready(recording))
    before = compare_model(train, test, Drive(Model.parse("coulomb-viscous"), 2.0))
    effect = Model.parse("coulomb-viscous+sensor-delay").effects[0]
    figure = pictures.evidence(before, effect, None, {"T": delay}).figure
    assert figure.layout.xaxis.title.text == "rate of the motor torque [N m/s]"
    x, y = (np.asarray(each, dtype=float) for each in (figure.data[0].x, figure.data[0].y))
    assert 0.5 * delay < np.polyfit(x, y, 1)[0] < 1.1 * delay
    assert np.corrcoef(x, y)[0, 1] > 0.9
