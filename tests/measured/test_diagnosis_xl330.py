"""What the diagnosis finds on the XL330 servo that swings a pendulum, with gravity as the known load."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from fricmodels.diagnosis import Ladder, improve, ready
from fricmodels.model import Model
from fricmodels.readers import read
from fricmodels.score import torque_error_over
from fricmodels.split import Split

ROOT = Path(__file__).parents[2]
DATA = ROOT.parent / "shared" / "data"

pytestmark = [
    pytest.mark.measured,
    pytest.mark.skipif(not (DATA / "bam_xl330").is_dir(), reason="../shared/data/bam_xl330 is not there"),
]


@pytest.fixture(scope="module")
def story(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    """Return the module that prepares the logs."""
    return from_benchmarks("measured.xl330")


@pytest.fixture(scope="module")
def folder(story: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Prepare the logs as the page does."""
    out = tmp_path_factory.mktemp("xl330")
    story.prepare(DATA, out)
    return out


@pytest.fixture(scope="module")
def ladder(folder: Path) -> Ladder:
    """Return the ladder of the twelve logs."""
    return improve(read(folder / "xl330_M1_fit.csv"), Model.parse("coulomb-viscous"), how=Split(by="runs"))


@pytest.mark.long
def test_load_friction_is_named(ladder: Ladder) -> None:
    """As the authors of the bench found: servos need load-dependent friction."""
    assert "load-friction" in ladder.first.findings[0].names
    kept = [rung.comparison.errors.held_out_percent for rung in ladder.rungs]
    assert kept[-1] < 0.85 * kept[0]


@pytest.mark.long
def test_inertia_is_that_of_pendulum_and_armature(ladder: Ladder) -> None:
    """m l² = 0.0049 kg m² and 0.0018 kg m² published for the armature."""
    values = ladder.first.comparison.estimate.parameters
    assert values["J"] == pytest.approx(0.49 * 0.1**2 + 0.00181, rel=0.06)


@pytest.mark.long
def test_the_error_falls_on_logs_that_took_no_part(ladder: Ladder, folder: Path) -> None:
    """One log of every trajectory and of every gain."""
    check = ready(read(folder / "xl330_M1_check.csv"))

    def error(index: int) -> float:
        comparison = ladder.rungs[index].comparison
        left = torque_error_over(comparison.drive, comparison.estimate.parameters, check, 0.02)
        return float(np.sqrt(np.mean(left**2)))

    assert error(-1) < 0.9 * error(0)


def test_the_free_swing_loses_in_proportion_to_the_load_too(story: ModuleType) -> None:
    """With the torque off nothing depends on the motor constants."""
    loss, error = story.free_swing(DATA)
    assert loss > 2 * error
    assert 0.05 < loss < 0.4
