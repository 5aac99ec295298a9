"""The law against its equation, the curves of the source, recovery from simulated measurements, and the exam."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fricmodels_temperature import BittencourtGunnarsson
from fricmodels_temperature.joint import (
    JOINT,
    LOADS,
    TEMPERATURES,
    average_error,
    friction,
    identify,
    measurement,
    speed_of_least_friction,
)

from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.testing import LawExam
from fricmodels.tournament import load_config, run


def test_the_published_equation() -> None:
    """Written out, at positive speed."""
    speed, load, warm = np.linspace(0.1, 300, 500), 0.6, 47.0
    p = JOINT
    expected = (
        p["F_c0"]
        + p["F_cl"] * load
        + p["F_sl"] * load * np.exp(-((speed / p["phi_sl"]) ** 1.3))
        + (p["F_s0"] + p["F_sT"] * warm) * np.exp(-((speed / (p["phi_s0"] + p["phi_sT"] * warm)) ** 1.3))
        + (p["F_v0"] + p["F_vT"] * np.exp(-warm / p["T_v"])) * speed
    )
    assert friction(speed, load, warm) == pytest.approx(expected, abs=1e-12)
    assert friction(-speed, load, warm) == pytest.approx(-expected, abs=1e-12)
    assert friction(speed, -load, warm) == pytest.approx(expected, abs=1e-12)


def test_warmth_moves_the_curve() -> None:
    """Less friction at high speed, more at low speed, and the least of it at a higher speed."""
    for load in LOADS:
        ends = np.array([friction(np.array([1.0, 280.0]), load, warm) for warm in TEMPERATURES])
        assert np.all(np.diff(ends[:, 0]) > 0)
        assert np.all(np.diff(ends[:, 1]) < 0)
        least = [speed_of_least_friction(load, warm) for warm in TEMPERATURES]
        assert np.all(np.diff(least) > 0)
        assert least[-1] > 4 * least[0]


def test_load_raises_the_curve_most_at_low_speed() -> None:
    """In proportion to the load: by F_cl + F_sl near rest, by F_cl at speed."""
    speeds = np.array([1e-3, 100.0, 280.0])
    added = np.array([friction(speeds, load, 50.0) - friction(speeds, 0.0, 50.0) for load in LOADS])
    assert added == pytest.approx(np.outer(LOADS, added[-1] / LOADS[-1]), abs=1e-12)
    assert added[-1] / LOADS[-1] == pytest.approx([0.145, 0.025, 0.025], abs=1e-4)


def test_where_the_stribeck_speed_would_be_negative_that_part_has_vanished() -> None:
    """At 15 °C, 5 K below; the curve is continuous there."""
    speeds = np.array([0.0, 0.5, 5.0])
    without = {**JOINT, "F_s0": 0.0, "F_sT": 0.0}
    assert friction(speeds, 0.0, 15.0) == pytest.approx(friction(speeds, 0.0, 15.0, without))
    near = [friction(speeds[1:], 0.0, 20.0 + step) for step in (-1e-6, 1e-6)]
    assert near[0] == pytest.approx(near[1], abs=1e-8)


def test_recovered_within_the_stated_errors() -> None:
    """Eleven parameters from five measurements: 95 % intervals that hold, and errors below 3 %."""
    fits = [identify(measurement(seed=seed)) for seed in range(5)]
    keys = list(JOINT)
    true = np.array([JOINT[key] for key in keys])
    found = np.array([[fit.parameters[key] for key in keys] for fit in fits])
    spread = np.array([[fit.standard_errors[key] for key in keys] for fit in fits])
    assert np.all(np.abs(found / true - 1) < 0.03)
    inside = np.abs(found - true) < 1.96 * spread
    assert inside.mean() > 0.85
    assert np.all(np.abs(found - true) < 5 * spread)


def test_a_law_of_speed_alone_cannot_follow() -> None:
    """The source: a sixth of the average error of the standard static law; here the noise is all that is left."""
    recording, again = measurement(seed=0), measurement(seed=1)
    standard = Model.parse("coulomb-viscous+stribeck")
    plain = average_error(again, identify(recording, standard), standard)
    extended = average_error(again, identify(recording))
    assert plain > 6 * extended
    assert extended == pytest.approx(0.002 * np.sqrt(2 / np.pi), rel=0.03)


def test_units_follow_the_motion() -> None:
    """Newtons and metres for a linear axis; kelvins stay."""
    units = {p.symbol: p.unit_for(Motion.LINEAR) for p in BittencourtGunnarsson.parameters}
    assert units["F_sT"] == "N/K"
    assert units["phi_s0"] == "m/s"
    assert units["F_vT"] == "N s/m"
    assert units["T_v"] == "K"


class TestExam(LawExam):
    """The exam of laws."""

    term = BittencourtGunnarsson


def test_tournament(tmp_path: Path) -> None:
    """On a loaded joint that warms the law wins, and finds what the rig hides."""
    folder = Path(__file__).parents[1]
    board = run(load_config(folder / "tournament.yaml"), tmp_path, directory=folder, executor="serial")
    assert not board.failures
    first, second = board.rows[:2]
    assert first["model"] == "bittencourt-gunnarsson"
    error = "held_out_rms_torque_error_percent"
    assert first[error] < 0.5 * second[error]
    assert first["parameters"]["F_cl"] == pytest.approx(0.15, rel=0.05)
    assert first["parameters"]["T_v"] == pytest.approx(1 / 0.03, rel=0.1)
    assert first["parameters"]["F_vT"] == pytest.approx(6.0 * np.exp(0.03 * 40.0), rel=0.1)
