"""Figures of ladders, histories, leaderboards and confusions show their numbers."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from fricmodels import plugins
from fricmodels.diagnosis.diagnose import Diagnosis
from fricmodels.diagnosis.ladder import Ladder, Rung
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.report import figures

from .conftest import COULOMB, INERTIA, VISCOUS, moved


def trace(figure, name):
    return next(each for each in figure.data if each.name == name)


def row(model="coulomb-viscous", estimator="batch", dataset="a", error=1.0, **more):
    status = "ok" if error is not None else "diverged"
    return {
        "model": model,
        "estimator": estimator,
        "dataset": dataset,
        "tags": {},
        "status": status,
        "rms_torque_error_percent": error,
        "held_out_rms_torque_error_percent": error,
    } | more


def test_the_ladder_shows_every_error_and_the_noise(compared):
    recording = moved()
    poor, good = compared(recording), compared(recording, "coulomb-viscous+cogging")
    diagnosis = Diagnosis(poor, "missing-effect", (), None, {})
    rungs = (Rung(poor), Rung(good, added="cogging"), Rung(poor, removed="cogging"))
    figure = figures.ladder(Ladder(diagnosis, rungs, diagnosis, (diagnosis,)))
    assert list(trace(figure, "fit error").x) == [rung.comparison.errors.percent for rung in rungs]
    assert list(trace(figure, "test error").x) == [rung.comparison.errors.held_out_percent for rung in rungs]
    assert list(trace(figure, "sensor noise alone").x) == [rung.comparison.noise_floor_percent for rung in rungs]
    assert list(figure.layout.yaxis.ticktext) == ["as given", "+ cogging", "− cogging"]


def test_the_leaderboard_shows_median_and_quartiles():
    rows = [row(error=error, dataset=name) for error, name in zip((1.0, 2.0, 3.0, 4.0, 5.0), "abcde", strict=True)]
    shown = trace(figures.leaderboard(rows), "batch")
    assert list(shown.x) == [3.0]
    assert list(shown.error_x.array) == [1.0]
    assert list(shown.error_x.arrayminus) == [1.0]


def test_a_failure_is_no_advantage_and_is_said():
    rows = [row(error=error, dataset=str(i)) for i, error in enumerate((1.0, 1.0, None, None, None))]
    rows += [row(model="square-root", error=5.0, dataset=str(i)) for i in range(5)]
    figure = figures.leaderboard(rows)
    names = [note.text.split("<br>")[0] for note in figure.layout.annotations]
    assert names == [
        "1. square-root",
        "2. coulomb-viscous",
    ]
    assert "no result: 3 of 5 fits" in figure.layout.annotations[1].text
    assert list(trace(figure, "batch").x) == [5.0]


def test_a_table_is_as_good_as_rows():
    rows = [row(error=1.0), row(error=None, dataset="b"), row(error=2.0, estimator="ekf")]
    assert figures.leaderboard(pd.DataFrame(rows)).to_json() == figures.leaderboard(rows).to_json()


def test_without_held_out_errors_those_of_the_fit_are_shown():
    figure = figures.leaderboard([row(error=2.0, held_out_rms_torque_error_percent=None)])
    assert list(figure.data[0].x) == [2.0]
    assert "fit error" in figure.layout.xaxis.title.text


def test_an_empty_leaderboard_is_refused():
    with pytest.raises(InputError, match="no rows"):
        figures.leaderboard([])


def test_the_history_is_that_of_the_fit():
    drive = Drive(Model.parse("coulomb-viscous"), INERTIA)
    fit = plugins.load().estimators["ekf"]().fit(drive, moved(ripple=0.0))
    history = fit.parameter_history(drive.units, {"K_v": VISCOUS, "K_c": COULOMB}, points=4 * len(fit.history))
    figure = figures.parameter_history(history)
    estimates = [each for each in figure.data if each.name == "estimate"]
    for shown, key in zip(estimates, fit.estimated, strict=True):
        assert np.nanmax(shown.y) == pytest.approx(fit.history[key].max(), rel=1e-6)
        assert shown.y[-1] == pytest.approx(fit.history[key].iloc[-1], rel=1e-6)
    assert [each.y[0] for each in figure.data if each.name == "true"] == pytest.approx([VISCOUS, COULOMB])
    assert figure.layout.yaxis.title.text == "K_v [N m s/rad]"


def test_a_fit_without_history_says_what_to_do():
    drive = Drive(Model.parse("coulomb-viscous"), INERTIA)
    fit = plugins.load().estimators["batch"]().fit(drive, moved())
    with pytest.raises(InputError, match="sequential estimator"):
        figures.parameter_history(fit)
