"""What the diagnosis finds on the joints of the TX40, from the raw recording with the rigid part as load."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from fricmodels.diagnosis import Ladder, compare_model, improve, kept_back, ready
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.readers import read

ROOT = Path(__file__).parents[2]
DATA = ROOT.parent / "shared" / "data"
INERTIA = 1e-9

pytestmark = [
    pytest.mark.measured,
    pytest.mark.skipif(not (DATA / "tx40").is_dir(), reason="../shared/data/tx40 is not there"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, from_benchmarks: Callable[[str], ModuleType]) -> Path:
    """Prepare the joints as the page does."""
    out = tmp_path_factory.mktemp("tx40")
    from_benchmarks("measured.tx40").prepare(DATA, out)
    return out


@pytest.fixture(scope="module")
def joint_1(folder: Path) -> Ladder:
    """Return the ladder of joint 1."""
    return improve(read(folder / "tx40_joint1.csv"), Model.parse("coulomb-viscous"), INERTIA)


def test_base_law_agrees_with_the_published_coefficients(folder: Path) -> None:
    """F_v = 8.05 N m s/rad and F_s = 7.14 N m; not 40 % low, as with sgn at standstill."""
    train, test = kept_back(ready(read(folder / "tx40_joint1.csv")))
    values = compare_model(train, test, Drive(Model.parse("coulomb-viscous"), INERTIA)).estimate.parameters
    assert values["K_v"] == pytest.approx(8.05, rel=0.1)
    assert values["K_c"] == pytest.approx(7.14, rel=0.1)


@pytest.mark.long
def test_viscous_friction_is_curved_on_joint_1(joint_1: Ladder) -> None:
    """Named first, and the error kept back falls by a third at least."""
    assert joint_1.first.findings[0].tested.name == "nonlinear-viscous"
    kept = [rung.comparison.sliding.held_out_percent for rung in joint_1.rungs]
    assert kept[-1] < 0.67 * kept[0]
    values = joint_1.rungs[-1].comparison.estimate.parameters
    assert 4 < values["nonlinear-viscous.a"] < 11


def test_the_wrist_is_understood_by_motor_not_by_joint(folder: Path) -> None:
    """Joint 6 keeps a third of the torque as error; motor 6, which turns with joints 5 and 6, a tenth."""
    errors = {}
    for name in ("joint6", "motor6"):
        train, test = kept_back(ready(read(folder / f"tx40_{name}.csv")))
        comparison = compare_model(train, test, Drive(Model.parse("coulomb-viscous"), INERTIA))
        errors[name] = comparison.errors.percent
    assert errors["motor6"] < 0.4 * errors["joint6"]
    assert comparison.estimate.parameters["K_v"] == pytest.approx(0.616, rel=0.15)
    assert comparison.estimate.parameters["K_c"] == pytest.approx(1.95, rel=0.2)
