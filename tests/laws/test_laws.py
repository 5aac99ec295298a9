"""The laws against their published curves and against each other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.term import Law

LAWS = [name for name in plugins.load().laws if plugins.load().laws.entry(name).distribution == "fricmodels"]
PAPER = {"K_v1": 1e-4, "K_v2": 6.6e-5, "K_c1": 1e-2, "K_c2": 6.6e-3}

forces = st.floats(1e-4, 1e3)


def friction(name: str, values: Mapping[str, float], velocity: NDArray[np.float64]) -> NDArray[np.float64]:
    count = len(velocity)
    channels = {"time": np.arange(count) * 1e-3, "torque": np.zeros(count), "velocity": velocity}
    recording = Recording("sweep", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))
    return Drive(Model.parse(name), 1.0).friction(recording, values)


def test_the_names_are_those_of_the_design() -> None:
    assert set(LAWS) == {
        "coulomb-viscous",
        "asymmetric-coulomb-viscous",
        "exponential-stick-slip",
        "asymmetric-exponential-stick-slip",
        "square-root",
        "two-thirds-power",
    }


@pytest.mark.parametrize("name", LAWS)
def test_friction_opposes_motion_and_at_rest_is_the_limit_from_above(name: str) -> None:
    law: type[Law] = plugins.load().laws[name]
    values = {p.symbol: 0.3 if p.symbol.startswith("C") else 0.7 for p in law.parameters}
    velocity = np.array([-5.0, -1.0, -1e-3, -1e-12, 0.0, 1e-12, 1e-3, 1.0, 5.0])
    torque = friction(name, values, velocity)
    assert np.all(np.sign(torque) == np.where(velocity >= 0, 1, -1))
    assert torque[4] == pytest.approx(0.7, rel=1e-12)
    assert torque[5] == pytest.approx(torque[4], abs=1e-8)
    assert torque[3] == pytest.approx(-torque[4], abs=1e-8)


def test_the_papers_simulated_motor() -> None:
    """Elhami and Brookfield (1997): K_v1 1.0e-4, K_v2 6.6e-5 N m s; K_c1 1.0e-2, K_c2 6.6e-3 N m."""
    torque = friction("asymmetric-coulomb-viscous", PAPER, np.array([100.0, 0.0, -1e-9, -100.0]))
    np.testing.assert_allclose(torque, [0.02, 0.01, -0.0066, -0.0132], rtol=1e-7)


def test_equation_4_term_by_term() -> None:
    values = {"K_v1": 2.0, "K_v2": 3.0, "K_c1": 7.0, "K_c2": 8.0, "C_1": 5.0, "C_2": 4.0, "B_1": 1.5, "B_2": 0.5}
    omega = np.array([0.0, 0.3, 2.0, -0.3, -2.0])
    speed = np.abs(omega)
    first, second = np.where(omega >= 0, 1, 0), np.where(omega < 0, -1, 0)
    expected = (2.0 * speed + 5.0 + (7.0 - 5.0) * np.exp(-1.5 * speed)) * first
    expected = expected + (3.0 * speed + 4.0 + (8.0 - 4.0) * np.exp(-0.5 * speed)) * second
    np.testing.assert_allclose(friction("asymmetric-exponential-stick-slip", values, omega), expected, rtol=1e-14)


@given(forces, forces, forces, forces, st.lists(st.floats(-100, 100), min_size=1, max_size=20))
def test_laws_contain_each_other(viscous: float, stick: float, slip: float, rate: float, speeds: list[float]) -> None:
    omega = np.array(speeds)
    plain = friction("coulomb-viscous", {"K_v": viscous, "K_c": stick}, omega)
    both = {f"{key}{side}": value for side in (1, 2) for key, value in (("K_v", viscous), ("K_c", stick))}
    np.testing.assert_allclose(friction("asymmetric-coulomb-viscous", both, omega), plain, rtol=1e-12)
    level = {"K_v": viscous, "K_c": stick, "C": stick, "B": rate}
    np.testing.assert_allclose(friction("exponential-stick-slip", level, omega), plain, rtol=1e-12)
    falling = {"K_v": viscous, "K_c": stick, "C": slip, "B": rate}
    sides = {f"{k}{'' if k.startswith('K') else '_'}{i}": v for i in (1, 2) for k, v in falling.items()}
    expected = friction("exponential-stick-slip", falling, omega)
    full = friction("asymmetric-exponential-stick-slip", sides, omega)
    np.testing.assert_allclose(full, expected, rtol=1e-9, atol=1e-12 * (stick + slip))


@given(forces, forces, st.floats(1e-3, 100))
def test_symmetric_laws_are_odd(viscous: float, coulomb: float, speed: float) -> None:
    for name in ("coulomb-viscous", "square-root", "two-thirds-power"):
        forward, backward = friction(name, {"K_v": viscous, "K_c": coulomb}, np.array([speed, -speed]))
        assert forward == -backward


def test_power_laws_at_round_numbers() -> None:
    values = {"K_v": 2.0, "K_c": 1.0}
    np.testing.assert_allclose(friction("square-root", values, np.array([4.0, -9.0])), [5.0, -7.0], rtol=1e-12)
    np.testing.assert_allclose(friction("two-thirds-power", values, np.array([8.0, -27.0])), [9.0, -19.0], rtol=1e-12)


def test_stick_never_falls_below_slip_by_declaration() -> None:
    for name in ("exponential-stick-slip", "asymmetric-exponential-stick-slip"):
        bounds = {p.key: p.at_least for p in Model.parse(name).parameters if p.at_least}
        assert bounds
        assert all(stick.replace("K_c", "C") == slip.replace("_", "") for stick, slip in bounds.items())
