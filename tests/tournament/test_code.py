"""Rows carry the code that made them: what another version left in the store is not shown as this one's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fricmodels.tournament import code, run
from fricmodels.tournament.config import Config
from fricmodels.tournament.demonstration import MOTOR

CONFIG = Config.model_validate(
    {
        "datasets": [{"name": "motor", "simulate": {**MOTOR, "noise_percent": 0}}],
        "models": ["coulomb-viscous", "makkar"],
        "estimators": "batch",
        "simulate": False,
    }
)


@pytest.fixture
def changed(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], None]]:
    """``changed("fricmodels-makkar")`` is as if this distribution's source had been edited."""

    def change(distribution: str) -> None:
        known = code.digest
        monkeypatch.setattr(code, "digest", lambda name: "edited" if name == distribution else known(name))
        code.code_of.cache_clear()

    yield change
    code.code_of.cache_clear()


def fitted(out: Path) -> list[str]:
    """Run the tournament and return the models that were fitted anew."""
    done: list[str] = []
    run(CONFIG, out, executor="serial", report=lambda number, total, job, row: done.append(job.model))
    return done


def test_only_what_changed_code_made_is_fitted_again(tmp_path: Path, changed: Callable[[str], None]) -> None:
    assert fitted(tmp_path) == ["coulomb-viscous", "makkar"]
    assert fitted(tmp_path) == []
    changed("fricmodels-makkar")
    assert fitted(tmp_path) == ["makkar"]
    changed("fricmodels")
    assert fitted(tmp_path) == ["coulomb-viscous", "makkar"]
    assert fitted(tmp_path) == []


def test_a_changed_file_changes_the_digest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "law.py"
    monkeypatch.setattr(code, "_sources", lambda package: [(package, file)])
    file.write_text("torque = 1")
    before = code.digest.__wrapped__("fricmodels")
    file.write_text("torque = 2")
    assert code.digest.__wrapped__("fricmodels") != before


def test_what_fits_and_scores_is_part_of_it_and_what_only_shows_is_not() -> None:
    files = {name for name, _ in code._sources("fricmodels")}
    for decisive in ("model.py", "weakform/problem.py", "score/torque.py", "effects/cogging.py", "tournament/jobs.py"):
        assert f"fricmodels/{decisive}" in files
    assert "fricmodels/report/page.py" not in files
    assert any(name.startswith("estimators/batch/") for name, _ in code._sources("estimators"))


def test_the_data_of_a_law_are_made_by_its_code(changed: Callable[[str], None]) -> None:
    before = code.code_of("batch", "coulomb-viscous", "makkar")
    assert code.code_of("batch", "coulomb-viscous") != before
    changed("fricmodels-makkar")
    assert code.code_of("batch", "coulomb-viscous", "makkar") != before
