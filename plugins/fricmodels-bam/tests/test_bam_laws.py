"""The laws against the source's formulas, its drive and back-drive diagram, and the exam."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from fricmodels_bam import LAWS, CoulombViscous, Directional, LoadDependent, Quadratic, Stribeck, StribeckLoadDependent
from fricmodels_bam.published import XL330
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.testing import LawExam, sit
from fricmodels.tournament import load_config, run

Array = NDArray[np.float64]

VALUES = {
    "K_v": 0.02, "K_c": 0.1, "K_cs": 0.05, "omega_s": 0.4, "alpha": 1.6, "K_l": 0.2, "K_ls": 0.1, "K_m": 0.3,
    "K_e": 0.12, "K_ms": 0.07, "K_es": 0.15, "K_mq": 0.06, "K_eq": 0.09,
}  # fmt: skip


def states(velocity: Array, motor: Array, load: Array) -> Recording:
    """Return samples with these signals."""
    count = len(velocity)
    channels = {"time": np.arange(count, dtype=float), "torque": motor, "velocity": velocity, "load_torque": load}
    return Recording("states", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))


def torque(law: type[CoulombViscous], recording: Recording, **changed: float) -> Array:
    """Return the law's torque."""
    model = Model(law())
    values = {p.key: {**VALUES, **changed}[p.key] for p in model.parameters}
    return Drive(model, 1.0).friction(recording, values)


@pytest.fixture(scope="module")
def anywhere() -> Recording:
    """Return random states of all four signs of motor torque and load."""
    rng = np.random.default_rng(3)
    return states(*rng.normal(0, [[0.8], [1.5], [1.2]], (3, 400)))


def budget(law: str, velocity: Array, motor: Array, external: Array, p: Mapping[str, float]) -> Array:
    """Return the most that friction resists, written out from section II of the source; external torque τ_e."""
    k = p
    near = np.exp(-(np.abs(velocity / k["omega_s"]) ** k["alpha"]))
    gear = np.abs(motor - external)
    sides = np.abs(k["K_m"] * motor - k["K_e"] * external)
    sides_near = np.abs(k["K_ms"] * motor - k["K_es"] * external)
    smaller = np.where(np.abs(motor) > np.abs(external), k["K_eq"] * external**2, k["K_mq"] * motor**2)
    wedge = np.where(np.sign(motor) != np.sign(external), smaller, 0.0)
    dry = {
        "bam-m1": 0.0,
        "bam-m2": near * k["K_cs"],
        "bam-m3": k["K_l"] * gear,
        "bam-m4": k["K_l"] * gear + near * (k["K_cs"] + k["K_ls"] * gear),
        "bam-m5": sides + near * (k["K_cs"] + sides_near),
        "bam-m6": sides + near * (k["K_cs"] + sides_near + wedge),
    }
    return k["K_v"] * np.abs(velocity) + k["K_c"] + dry[law]


@pytest.mark.parametrize("law", LAWS)
def test_the_published_formula(law: type[CoulombViscous], anywhere: Recording) -> None:
    """The source counts the external torque with the other sign."""
    velocity = anywhere.velocity
    expected = budget(law.name, velocity, anywhere.torque, -anywhere.load_torque, VALUES) * np.sign(velocity)
    assert torque(law, anywhere) == pytest.approx(expected, abs=1e-12)


def test_each_law_contains_a_simpler_one(anywhere: Recording) -> None:
    """Where what it adds is zero, or equal on both sides."""
    m1 = torque(CoulombViscous, anywhere)
    assert torque(Stribeck, anywhere, K_cs=0.0) == pytest.approx(m1)
    assert torque(LoadDependent, anywhere, K_l=0.0) == pytest.approx(m1)
    assert torque(StribeckLoadDependent, anywhere, K_cs=0.0, K_ls=0.0) == pytest.approx(torque(LoadDependent, anywhere))
    equal = {"K_m": 0.2, "K_e": 0.2, "K_ms": 0.1, "K_es": 0.1}
    assert torque(Directional, anywhere, **equal) == pytest.approx(torque(StribeckLoadDependent, anywhere))
    assert torque(Quadratic, anywhere, K_mq=0.0, K_eq=0.0) == pytest.approx(torque(Directional, anywhere))


def holding(law: type[CoulombViscous], values: Mapping[str, float], motor: float) -> tuple[float, float]:
    """Return the loads that just let a motor torque drive and just drive it back, at creeping speed."""
    loads = np.linspace(0.0, 4.0 * motor, 400_001)
    interval = Drive(Model(law()), 1.0).sticking_interval(
        states(np.zeros_like(loads), np.full_like(loads, motor), loads),
        {p.key: values[p.key] for p in Model(law()).parameters},
    )
    held = loads[(motor - loads >= interval[0]) & (motor - loads <= interval[1])]
    return float(held[0]), float(held[-1])


@pytest.mark.parametrize("motor", [0.5, 2.0])
def test_drive_and_back_drive_diagram(motor: float) -> None:
    """The source's diagram: M1 a band along the diagonal, M3 a cone about it, M5 another slope on either side."""
    m1 = holding(CoulombViscous, VALUES, motor)
    assert m1 == pytest.approx((motor - 0.1, motor + 0.1), abs=1e-4 * motor)
    m3 = holding(LoadDependent, VALUES, motor)
    assert m3 == pytest.approx((((1 - 0.2) * motor - 0.1) / 1.2, ((1 + 0.2) * motor + 0.1) / 0.8), abs=1e-4 * motor)
    m5 = holding(Directional, {**VALUES, "K_cs": 0.0, "K_ms": 0.0, "K_es": 0.0}, motor)
    assert m5 == pytest.approx(
        (((1 - 0.3) * motor - 0.1) / (1 + 0.12), ((1 + 0.3) * motor + 0.1) / (1 - 0.12)), abs=1e-4 * motor
    )


def test_the_servo_is_driven_back_more_easily_than_its_drive_suggests() -> None:
    """With the published M5 of the XL-330 the motor drives 0.6 of its torque and holds 1.9 times it at rest."""
    drives, holds = holding(Directional, XL330["bam-m5"].values, 1.0)
    moving = {**XL330["bam-m5"].values, "K_cs": 0.0, "K_ms": 0.0, "K_es": 0.0}
    sliding = holding(Directional, moving, 1.0)
    assert sliding == pytest.approx(((1 - 0.32339 - 0.00606) / 1.10147, (1.32339 + 0.00606) / 0.89853), abs=1e-3)
    assert drives < sliding[0]
    assert holds > sliding[1]


def test_units_follow_the_motion() -> None:
    """Newtons for a linear axis."""
    units = {p.symbol: p.unit_for(Motion.LINEAR) for p in Quadratic.parameters}
    assert units["K_c"] == units["K_cs"] == "N"
    assert units["omega_s"] == "m/s"
    assert units["K_mq"] == units["K_eq"] == "1/N"
    assert units["K_m"] == units["alpha"] == "1"


class TestM1(LawExam):
    """Linear: every estimator."""

    term = CoulombViscous
    estimators = ("batch", "rls", "constant-velocity", "ekf")


class TestM2(LawExam):
    """Nonlinear: the batch estimator."""

    term = Stribeck


class TestM3(LawExam):
    """Linear: every estimator but the paper's own filter, which ends 10 % off on such a motion."""

    term = LoadDependent
    estimators = ("batch", "rls", "constant-velocity", "ekf")


class TestM4(LawExam):
    """Nonlinear, with load."""

    term = StribeckLoadDependent


class TestM5(LawExam):
    """Nonlinear in the shares of motor and load too."""

    term = Directional


class TestM6(LawExam):
    """The square adds two linear parameters."""

    term = Quadratic


@pytest.mark.long
@pytest.mark.parametrize("law", [StribeckLoadDependent, Directional])
def test_the_filter_follows(law: type[CoulombViscous]) -> None:
    """The extended Kalman filter finds nonlinear laws with load too."""
    exam = type("Exam", (LawExam,), {"term": law, "estimators": ("ekf",)})
    outcome = sit(exam, "test_recovered")
    assert outcome.result == "passed", outcome.message


@pytest.mark.long
def test_tournament(tmp_path: Path) -> None:
    """On a gearbox that loses more when it drives, load-dependent laws halve the error, directional ones are best."""
    folder = Path(__file__).parents[1]
    board = run(load_config(folder / "tournament.yaml"), tmp_path, directory=folder, executor="serial")
    assert not board.failures
    error = {row["model"]: row["held_out_rms_torque_error_percent"] for row in board.rows}
    assert error["bam-m2"] == pytest.approx(error["bam-m1"], rel=0.05)
    assert max(error[f"bam-m{i}"] for i in (3, 4, 5, 6)) < 0.5 * error["bam-m1"]
    assert min(error["bam-m5"], error["bam-m6"]) < min(error["bam-m3"], error["bam-m4"])
