"""True models fitted to rough drives: what their parameters are, and whether the intervals hold them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
SIDE = 1.96


@pytest.fixture(scope="module")
def coverage() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BENCHMARKS))
        import effect_coverage

        yield effect_coverage


def distance(found: dict[str, Any]) -> float:
    return abs(float(found["value"]) - float(found["true"])) / float(found["error"])


@pytest.mark.parametrize(
    ("name", "index"),
    [("cogging", 16), ("position-friction", 13), pytest.param("position-friction", 15, marks=pytest.mark.long)],
)
def test_a_wave_too_fast_for_the_rows_is_where_a_fit_begins(coverage: Any, name: str, index: int) -> None:
    """The rows show another wave: the fit ended at k = 0.59, 3.96 and 1.00, with up to four times the test error."""
    row = coverage.trial((name, index, 1))
    wave = row["parameters"][f"{name}.k"]
    assert wave["value"] == pytest.approx(wave["true"], rel=1e-3)
    assert distance(wave) < 3.0


@pytest.mark.parametrize("index", [10, pytest.param(12, marks=pytest.mark.long)])
def test_a_ripple_goes_with_the_recorded_torque(coverage: Any, index: int) -> None:
    """What a fit explains of the torque lacks what a controller does against it: K_v was 8 and 12 errors too small."""
    row = coverage.trial(("torque-ripple", index, 1))
    for key in ("K_v", "K_c"):
        assert distance(row["parameters"][key]) < 3.0, key


@pytest.mark.parametrize(("name", "index"), [("asymmetry", 5), ("inertia-error", 7), ("torque-offset", 17)])
def test_a_small_shift_that_shows_is_no_part_of_the_friction(coverage: Any, name: str, index: int) -> None:
    """Less than a tenth of a sample, seen with five to fifteen standard errors: K_v was 29, 5 and 4 % off."""
    viscous = coverage.trial((name, index, 1))["parameters"]["K_v"]
    assert distance(viscous) < 3.2
    assert viscous["value"] == pytest.approx(viscous["true"], rel=0.1)


@pytest.mark.long
def test_intervals_hold(coverage: Any) -> None:
    names = ("nothing", "torque-offset", "gravity", "load-friction", "stiffness")
    rows = [coverage.trial((name, index, 5)) for name in names for index in range(4)]
    found = [p for row in rows if row["status"] == "ok" for p in row["parameters"].values()]
    given = [distance(p) for p in found if p["error"] and not p["why"]]
    assert len(given) > 50
    assert np.mean(np.array(given) < SIDE) > 0.85


def test_what_is_true_follows_from_the_equations(coverage: Any) -> None:
    """A cos(k q + φ) of the simulator is a cos kq + b sin kq; a ripple of its torque counts against the motion."""
    from rough.effects import Change

    position, waves = np.linspace(0.0, 7.0, 50), ((0.0, 3.0, 2.0, 0.4), (0.0, 6.0, 0.5, 1.1))
    for name, sign in (("cogging", 1.0), ("torque-ripple", -1.0)):
        p = coverage.wave(Change(name, waves=waves))
        model = sum(
            p[f"a{s}"] * np.cos(m * p["k"] * position) + p[f"b{s}"] * np.sin(m * p["k"] * position)
            for s, m in (("", 1.0), ("_2", 2.0))
        )
        simulated = sum(size * np.cos(k * position + phase) for _, k, size, phase in waves)
        np.testing.assert_allclose(model, sign * simulated, atol=1e-12)
