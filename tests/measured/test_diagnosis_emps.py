"""What the diagnosis finds on the EMPS axis, beside what its authors found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.diagnosis import Ladder, compare, diagnose, improve, ready
from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.score import torque_error_over
from fricmodels.tournament import load_config, run

ROOT = Path(__file__).parents[2]
FOLDER = ROOT.parent / "shared" / "data" / "emps"

pytestmark = [
    pytest.mark.measured,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="../shared/data/emps is not there"),
]


def load(which: str) -> Recording:
    """Return one of the two files."""
    columns = ("time=t:s", "force=force_N:N", "position=pos_m:m")
    return read(FOLDER / f"emps_{which}.csv", columns=columns, motion=Motion.LINEAR)


@pytest.fixture(scope="module")
def ladder() -> Ladder:
    """Return the ladder from the symmetric law."""
    return improve(load("id"), Model.parse("coulomb-viscous"))


@pytest.mark.long
def test_first_named_is_the_asymmetry_that_the_authors_found() -> None:
    assert diagnose(load("id"), Model.parse("coulomb-viscous")).findings[0].tested.name == "asymmetry"


def test_the_asymmetry_is_as_large_as_the_authors_found() -> None:
    """Viscous friction differs by −36.9 N s/m (half the difference), Coulomb friction hardly."""
    found = compare(load("id"), "coulomb-viscous+asymmetry")
    values = found.estimate.parameters
    assert values["asymmetry.d"] == pytest.approx(-36.86, rel=0.1)
    assert abs(values["asymmetry.c"]) < 1.0
    assert values["M"] == pytest.approx(95.15, rel=0.01)
    assert values["K_v"] == pytest.approx(203.6, rel=0.03)
    assert values["K_c"] == pytest.approx(20.39, rel=0.03)


@pytest.mark.long
def test_the_ladder_adds_it_first(ladder: Ladder) -> None:
    """And refits what a comparison of the larger model finds."""
    assert ladder.first.findings[0].tested.name == "asymmetry"
    assert ladder.rungs[1].added == "asymmetry"
    alone = compare(load("id"), "coulomb-viscous+asymmetry").estimate.parameters
    assert ladder.rungs[1].comparison.estimate.parameters == pytest.approx(alone, rel=0.01, abs=0.1)


@pytest.mark.long
def test_errors_fall_on_the_file_that_took_no_part(ladder: Ladder) -> None:
    """Every effect lowers the error kept back; the last is better on the pulses file than the first by a third."""
    rungs = ladder.rungs[:1]
    for rung in ladder.rungs[1:]:  # an effect that was exchanged for another one is not on the way to the last
        rungs = rungs[:-1] if rung.removed else (*rungs, rung)
    errors = [rung.comparison.errors for rung in rungs]
    kept = [error.held_out_percent for error in errors]
    assert kept == sorted(kept, reverse=True)
    assert errors[-1].bands[2].window_ms == 20.0
    assert errors[-1].bands[2].held_out_percent <= 2.9
    pulses = ready(load("pulses"))

    def error(index: int) -> float:
        comparison = ladder.rungs[index].comparison
        left = torque_error_over(comparison.drive, comparison.estimate.parameters, pulses, 0.02)
        return 100 * float(np.sqrt(np.mean(left**2) / np.mean(pulses.torque**2)))

    assert error(-1) < 0.68 * error(0)


@pytest.mark.long
def test_the_pulses_file_names_the_same_effect_by_itself() -> None:
    """Neither file knows of the other."""
    diagnosis = diagnose(load("pulses"), Model.parse("coulomb-viscous"))
    first = diagnosis.findings[0].tested
    assert first.name == "asymmetry"
    assert first.parameters["d"] == pytest.approx(-36.86, rel=0.1)


@pytest.mark.long
def test_relative_errors_as_the_authors_define_them(tmp_path: Path) -> None:
    """4.08 % for the symmetric law with an offset, 3.11 % for the asymmetric one, 5.98 % on the pulses."""
    path = ROOT / "configs" / "measured" / "emps.yaml"
    rows = {row["model"]: row for row in run(load_config(path), tmp_path, directory=path.parent).rows}
    symmetric, asymmetric = rows["coulomb-viscous+torque-offset"], rows["asymmetric-coulomb-viscous"]
    assert symmetric["rms_torque_error_percent"] <= 4.0834
    assert symmetric["held_out_rms_torque_error_percent"] <= 5.9824
    assert asymmetric["rms_torque_error_percent"] <= 3.1117
    assert asymmetric["held_out_rms_torque_error_percent"] < symmetric["held_out_rms_torque_error_percent"]
    presliding = rows["asymmetric-coulomb-viscous+presliding"]
    assert presliding["rms_torque_error_percent"] < asymmetric["rms_torque_error_percent"]
    assert presliding["held_out_rms_torque_error_percent"] < asymmetric["held_out_rms_torque_error_percent"]
