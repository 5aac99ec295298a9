"""What the figures of a comparison show is what was measured."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report import figures
from fricmodels.report.figures.grid import even_edges
from fricmodels.report.figures.hysteresis import reversals
from fricmodels.report.figures.residuals import binned_mean, changing, correlation_length
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.spectrum import spectrum
from fricmodels.simulation import simulate

from .conftest import COULOMB, INERTIA, ORDER, RIPPLE, SAMPLES, VISCOUS, moved


def trace(figure, name):
    return next(each for each in figure.data if each.name == name)


# ---- over time ---------------------------------------------------------------------------------------------------


def test_the_overlay_shows_the_recorded_torque(rotary):
    shown = trace(figures.overlay(rotary), "torque measured")
    recorded = np.concatenate([rotary.train.torque, rotary.test.torque])
    time = np.concatenate([rotary.train.time, rotary.test.time])
    drawn = ~np.isnan(shown.y)
    order = np.argsort(time)
    at = np.searchsorted(time[order], shown.x[drawn])
    assert shown.y[drawn] == pytest.approx(recorded[order][at], rel=1e-6)
    assert shown.y[drawn].max() == pytest.approx(recorded.max(), rel=1e-6)
    assert shown.y[drawn].min() == pytest.approx(recorded.min(), rel=1e-6)


def test_modelled_and_residual_make_up_the_measured_torque(rotary):
    samples = Samples.of(rotary)
    residual = trace(figures.overlay(rotary), "residual")
    assert np.nanmax(residual.y) == pytest.approx(samples.error.max(), rel=1e-6)
    rms = float(np.sqrt(np.mean(samples.error[~samples.kept_back] ** 2)))
    assert rms == pytest.approx(rotary.errors.SI, rel=1e-9)


def test_the_residual_before_stands_on_the_same_axis(compared):
    recording = moved()
    poor, good = compared(recording), compared(recording, "coulomb-viscous+cogging", {"cogging.k": ORDER})
    figure = figures.overlay(good, before=poor)
    before, after = trace(figure, "residual of the model as given"), trace(figure, "residual")
    assert before.yaxis == after.yaxis
    shown = ~np.isnan(before.y)
    at = np.searchsorted(Samples.of(poor).place, before.x[shown])
    assert before.y[shown] == pytest.approx(Samples.of(poor).error[at], abs=1e-5)
    assert after.y[shown] == pytest.approx(Samples.of(good).error[at], abs=1e-5)


def test_a_peak_of_one_sample_is_seen(compared):
    recording = moved()
    torque = recording.torque.copy()
    torque[4321] = 400.0
    comparison = compared(recording.with_channels(torque=torque))
    assert np.nanmax(trace(figures.overlay(comparison), "torque measured").y) == 400.0


def test_what_was_kept_back_is_shaded(rotary):
    spans = [(shape.x0, shape.x1) for shape in figures.overlay(rotary).layout.shapes]
    for time, kept in ((rotary.test.time, True), (rotary.train.time, False)):
        inside = np.any([(time >= a) & (time <= b) for a, b in spans], axis=0)
        assert np.all(inside == kept)


def test_a_part_of_the_time_is_shown_in_full(rotary):
    shown = trace(figures.overlay(rotary, (6.0, 9.0)), "torque measured")
    assert 6.0 <= shown.x.min() < 6.01
    assert 8.99 < shown.x.max() <= 9.0
    assert np.count_nonzero(~np.isnan(shown.y)) in (750, 751)


def test_runs_that_overlap_in_time_stand_one_after_another(compared):
    recording = moved()
    run = np.repeat(np.arange(5), SAMPLES // 5)
    channels = dict(recording.channels)
    channels["time"] = recording.time - recording.time[:: SAMPLES // 5][run]
    samples = Samples.of(compared(replace(recording, channels=channels, run=run)))
    assert samples.consecutive
    assert np.all(np.diff(samples.place) > 0)
    assert samples.place[-1] == pytest.approx(recording.time[-1], rel=1e-3)
    assert np.flatnonzero(np.diff(samples.recording.run)).tolist() == [1199, 2399, 3599, 4799]
    assert samples.kept_back.tolist() == [False] * 3600 + [True] * 2400


def test_samples_are_evaluated_once_and_freed_with_the_comparison(compared):
    comparison = compared(moved())
    assert Samples.of(comparison) is Samples.of(comparison)
    samples = weakref.ref(Samples.of(comparison))
    del comparison
    gc.collect()
    assert samples() is None


# ---- friction ------------------------------------------------------------------------------------------------------


def test_the_density_counts_every_moving_sample(rotary):
    samples = Samples.of(rotary)
    counted = np.sum(figures.friction_curve(rotary).data[0].customdata)
    moving = np.count_nonzero(~samples.resting)
    assert moving * 0.997 <= counted <= moving


def test_the_curve_is_the_law(rotary):
    curve = trace(figures.friction_curve(rotary), "modelled")
    viscous, coulomb = (rotary.estimate.parameters[key] for key in ("K_v", "K_c"))
    assert curve.y == pytest.approx(viscous * curve.x + coulomb * np.sign(curve.x), rel=1e-5)


def test_the_band_is_that_of_the_covariance(rotary):
    estimate = rotary.estimate
    band = trace(figures.friction_curve(rotary), "±2 standard errors")
    curve = trace(figures.friction_curve(rotary), "modelled")
    half = len(band.x) // 2
    keys = list(estimate.standard_errors)
    slope = np.array([{"K_v": curve.x, "K_c": np.sign(curve.x)}.get(key, 0 * curve.x) for key in keys])
    expected = 2 * np.sqrt(np.einsum("in,ij,jn->n", slope, estimate.covariance, slope))
    assert band.y[:half] - curve.y == pytest.approx(expected, rel=1e-2)
    assert np.sqrt(np.diag(estimate.covariance)) == pytest.approx(list(estimate.standard_errors.values()))


def test_measured_friction_is_the_torque_less_all_that_is_not_friction(compared):
    recording = moved()
    samples = Samples.of(compared(recording, "coulomb-viscous+cogging", {"cogging.k": ORDER}))
    assert samples.friction_drive.model.name == "coulomb-viscous"
    sliding = ~samples.resting & (np.abs(samples.velocity) > 0.5)
    true = VISCOUS * samples.velocity + COULOMB * np.sign(samples.velocity)
    assert samples.measured_friction[sliding] == pytest.approx(true[sliding], abs=0.1)


def test_friction_that_depends_on_more_than_velocity_has_a_spread(compared):
    figure = figures.friction_curve(compared(moved(), "coulomb-viscous+load-friction"))
    mean, low, high = (
        trace(figure, "modelled (mean)"),
        *(t for t in figure.data if t.name == "nine tenths of the model's samples"),
    )
    assert np.all(low.y <= mean.y)
    assert np.all(mean.y <= high.y)
    assert np.all(np.diff(mean.x) > 0)


# ---- residual ------------------------------------------------------------------------------------------------------


def test_means_of_cells_by_hand():
    x = np.array([0.1, 0.2, 0.9, 0.9, 0.1, 0.9])
    y = np.array([0.1, 0.1, 0.1, 0.9, 0.9, 0.9])
    values = np.array([1.0, 3.0, 5.0, 7.0, -2.0, 9.0])
    cells = binned_mean(x, y, values, np.zeros(6, dtype=np.int64), cells=2)
    assert cells.mean.tolist() == [[2.0, 5.0], [-2.0, 8.0]]
    assert cells.count.tolist() == [[2, 1], [1, 2]]


def test_standard_error_of_a_mean_of_white_and_of_correlated_values():
    rng = np.random.default_rng(3)
    x, y = rng.uniform(size=(2, 40_000))
    piece = np.zeros(40_000, dtype=np.int64)
    white = rng.standard_normal(40_000)
    cells = binned_mean(x, y, white, piece, cells=10)
    ratio = cells.mean / cells.standard_error
    assert np.std(ratio) == pytest.approx(1.0, abs=0.15)
    smooth = np.convolve(white, np.ones(20) / 20, "same")
    assert correlation_length(white, piece) == pytest.approx(1.0, abs=0.3)
    assert correlation_length(smooth, piece) == pytest.approx(20.0, rel=0.2)


def test_maps_show_only_channels_that_change(compared):
    recording = moved()
    channels = {name: recording[name] for name in ("time", "torque", "velocity", "load_torque")}
    channels["temperature"] = np.full(SAMPLES, 20.0)
    plain = compared(Recording("plain", Motion.ROTARY, channels, recording.run))
    assert set(changing(plain)) == {"position", "acceleration", "load_torque", "time"}
    with pytest.raises(InputError, match="temperature"):
        figures.residual_map(plain, "velocity", "temperature")


def test_a_map_shows_the_ripple_where_it_is(rotary):
    heat = figures.residual_map(rotary, "velocity", "position").data[0]
    expected = RIPPLE * np.cos(ORDER * heat.y)[:, None] * np.ones(len(heat.x))
    fast = np.abs(heat.x) > 1.0
    known = np.isfinite(heat.z) & fast
    assert np.corrcoef(heat.z[known], expected[known])[0, 1] > 0.9


def test_a_map_says_the_torque_beside_its_standard_errors(rotary):
    heat = figures.residual_map(rotary).data[0]
    assert heat.customdata[..., 0] == pytest.approx(heat.z, nan_ok=True)
    assert np.isfinite(heat.customdata[..., 1][np.isfinite(heat.z)]).all()


def test_the_spectrum_of_a_ripple_has_its_order_and_amplitude():
    place = np.cumsum(np.random.default_rng(0).uniform(0.0, 0.002, 50_000))
    found = spectrum(place, 0.7 * np.cos(2 * np.pi * 7.3 * place + 1.0), 100.0)
    peak = np.argmax(found.amplitude)
    assert found.order[peak] == pytest.approx(7.3, abs=0.02)
    assert found.amplitude[peak] == pytest.approx(0.7, rel=0.03)


def test_dwelling_does_not_count():
    place = np.concatenate([np.linspace(0, 10, 20_000), np.full(30_000, 3.3)])
    found = spectrum(place, np.cos(2 * np.pi * 5 * place), 50.0)
    assert found.amplitude.max() == pytest.approx(1.0, rel=0.03)


def test_the_ripple_stands_out_of_the_residual(rotary):
    shown = trace(figures.residual_spectrum(rotary), "the same in both directions")
    assert shown.x[np.argmax(shown.y)] == pytest.approx(ORDER, abs=0.5)
    assert shown.y.max() == pytest.approx(RIPPLE, rel=0.25)


def test_a_linear_axis_counts_periods_in_a_metre(compared):
    shown = trace(figures.residual_spectrum(compared(moved(Motion.LINEAR))), "the same in both directions")
    assert shown.x[np.argmax(shown.y)] == pytest.approx(ORDER / (2 * np.pi), abs=0.1)


def test_without_a_position_the_spectrum_is_over_time(compared):
    recording = moved()
    channels = {name: recording[name] for name in ("time", "torque", "velocity", "load_torque")}
    figure = figures.residual_spectrum(compared(Recording("plain", Motion.ROTARY, channels, recording.run)))
    assert figure.layout.xaxis.title.text == "frequency [Hz]"


# ---- reversals -----------------------------------------------------------------------------------------------------


def test_reversals_are_those_of_the_motion(rotary):
    samples = Samples.of(rotary)
    near = reversals(samples)
    velocity = samples.velocity[~samples.resting]
    assert near.count <= np.count_nonzero(np.diff(np.sign(velocity)))
    assert near.count >= 10
    after = near.select(near.leaving)
    position = samples.recording["position"]
    for turn in range(near.count):
        own = after.index[after.turn == turn]
        assert after.way[after.turn == turn] == pytest.approx(np.abs(position[own] - position[own[0]]), abs=0.01)


def test_coulomb_friction_has_no_loop(compared):
    figure = figures.hysteresis(compared(moved(ripple=0.0)))
    for name in ("measured", "modelled"):
        before, after = trace(figure, f"{name}, before"), trace(figure, f"{name}, after")
        for branch in (before, after):
            known = np.isfinite(branch.y) & (np.abs(branch.x) > 0.2)
            true = VISCOUS * branch.x + COULOMB * np.sign(branch.x)
            assert branch.y[known] == pytest.approx(true[known], abs=0.1)


def test_a_recording_that_never_reverses_has_no_loops(compared):
    recording = moved()
    velocity = recording.velocity + 10.0
    position = recording["position"] + 10.0 * recording.time
    torque = INERTIA * np.gradient(velocity, recording.time) + COULOMB + VISCOUS * velocity
    ahead = recording.with_channels(velocity=velocity, position=position, torque=torque + recording.load_torque)
    with pytest.raises(InputError, match="never reverses"):
        figures.hysteresis(compared(ahead))


# ---- shares --------------------------------------------------------------------------------------------------------


def test_shares_are_those_of_the_comparison(comparison):
    figure = figures.error_shares(comparison)
    shown, whole = trace(figure, "RMS error in the regime"), trace(figure, "over all that was fitted")
    for row in (row for row in comparison.where if row.regime in shown.y):
        at = shown.y.index(row.regime)
        assert shown.x[at] == pytest.approx(row.rms_torque_error)
        assert shown.customdata[at] == pytest.approx([100 * row.share_of_squared_error, 100 * row.share_of_samples])
    assert set(whole.x) == {comparison.errors.SI}


def test_the_regimes_of_a_group_stand_together_and_divide_the_motion(comparison):
    from fricmodels.diagnosis.where import grouped
    from fricmodels.report.figures.shares import MOST_REGIMES
    from fricmodels.report.pictures import by_regime

    groups = grouped(comparison.where)
    assert {row.regime for row in groups["direction"]} == {"forward", "backward"}
    for name in ("position", "load", "temperature", "time"):
        assert sum(row.share_of_squared_error for row in groups[name]) == pytest.approx(1.0)
    shown = trace(figures.error_shares(comparison), "RMS error in the regime")
    flat = [row.regime for group in groups.values() for row in sorted(group, key=lambda row: -row.rms_torque_error)]
    assert list(shown.y) == flat[: len(shown.y)]
    assert len(shown.y) <= MOST_REGIMES < len(flat)
    drawn, largest = set(shown.y), [max(row.rms_torque_error for row in group) for group in groups.values()]
    for group, most in zip(groups.values(), largest, strict=True):
        assert len(drawn & {row.regime for row in group}) in (0, len(group)), "a group is drawn whole or not at all"
        if group[0].regime not in drawn:
            assert all(
                most <= size for size, own in zip(largest, groups.values(), strict=True) if own[0].regime in drawn
            )
    picture = by_regime(comparison)
    assert f"the table has all {len(flat)} regimes" in picture.message
    assert picture.table is not None
    assert len(picture.table.rows) == 1 + len(flat), "and the whole"


def test_noise_alone_has_no_peaks_and_a_ripple_within_noise_has_one():
    found, first = 0, []
    place = np.linspace(0, 12, 20_000)
    for seed in range(40):
        noise = np.random.default_rng(seed).standard_normal(len(place))
        found += len(spectrum(place, noise, 200.0).peaks()) > 0
        heard = spectrum(place, noise + 0.15 * np.cos(2 * np.pi * 23 * place), 200.0)
        first.append(heard.order[heard.peaks()[0]])
    assert found <= 4
    assert first == pytest.approx([23.0] * 40, abs=0.05)


# ---- cells ---------------------------------------------------------------------------------------------------------


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.integers(2, 60))
def test_cells_are_even_cover_all_and_have_a_border_at_zero(one, other, cells):
    low, high = min(one, other), max(one, other)
    if high - low < 1e-6:
        high = low
    edges = even_edges(low, high, cells)
    assert len(edges) == cells + 1
    assert edges[0] <= low + 1e-9 * abs(low)
    assert edges[-1] >= high - 1e-9 * abs(high)
    assert np.diff(edges) == pytest.approx(np.full(cells, (edges[-1] - edges[0]) / cells), rel=1e-6)
    if low < 0 < high:
        assert np.min(np.abs(edges)) == 0
        assert edges[-1] - edges[0] <= cells / (cells - 1) * (high - low) * (1 + 1e-9)


def test_friction_that_builds_up_over_a_distance_shows_as_a_loop(compared):
    """A drive that bends its contact before it slides: the torque turns over within three times x_s."""
    drive = Drive(Model.parse("coulomb-viscous+presliding"), INERTIA)
    values = {
        "K_v": 0.5,
        "K_c": 3.0,
        "presliding.F_1": 3.0,
        "presliding.F_2": 3.0,
        "presliding.D": 0.0,
        "presliding.x_s": 0.01,
    }
    time = 0.002 * np.arange(6000)
    torque = 6.0 * np.sin(3 * time) + 4.0 * np.sin(7.1 * time)
    recording = simulate(drive, values, time, torque, with_position=True, noise=0.1)
    for model in ("coulomb-viscous", "coulomb-viscous+presliding"):
        figure = figures.hysteresis(compared(recording, model))
        built_up = next(each for each in figure.data if each.name == "measured, after" and not each.showlegend)
        assert built_up.y[0] < -1.5
        assert np.interp(0.03, built_up.x, built_up.y) > 2.0
