"""Every command that can write the report writes it, and says where; what it cannot do it says in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricmodels.cli import main
from fricmodels.rig import write as write_recording
from fricmodels.rig.demonstration import hidden

CONFIG = """\
name: joint
datasets:
  - {name: joint, files: joint.csv, inertia: 1.8}
models: [coulomb-viscous, coulomb-viscous+cogging]
estimators: rls
simulate: false
"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    data, _ = write_recording(hidden().model_copy(update={"samples": 2_500}).simulate(), folder / "joint.csv")
    return data


@pytest.fixture
def here(recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "joint.csv").write_bytes(recording.read_bytes())
    (tmp_path / "joint.yaml").write_text(CONFIG, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def done(arguments: str) -> int:
    with pytest.raises(SystemExit) as stopped:
        main(arguments.split())
    return int(stopped.value.code or 0)


@pytest.mark.parametrize(
    "command", ["compare", *(pytest.param(command, marks=pytest.mark.long) for command in ("diagnose", "improve"))]
)
def test_beside_the_answer(command: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = here / "new" / "page.html"
    assert done(f"{command} joint.csv --model coulomb-viscous --inertia 1.8 --report new/page.html") == 0
    assert "new/page.html" in capsys.readouterr().out.replace("\n", "")
    text = page.read_text(encoding="utf-8")
    assert f"fricmodels {command} joint.csv --model coulomb-viscous --inertia 1.8" in text
    assert ("stribeck" in text.partition("<main")[0]) == (command != "compare")


def test_after_a_tournament_and_again_from_its_folder(here: Path) -> None:
    assert done("run joint.yaml --out run --executor serial --report run/first.html") == 0
    assert done("report run") == 0
    assert (here / "run" / "report.html").read_bytes() == (here / "run" / "first.html").read_bytes()
    text = (here / "run" / "report.html").read_text(encoding="utf-8")
    assert "fricmodels run joint.yaml --out run" in text


@pytest.mark.long
def test_of_a_recording_alone(here: Path) -> None:
    assert done("report joint.csv --inertia 1.8") == 0
    assert "lacks" in (here / "joint.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("report nowhere", "nowhere"),
        ("report nowhere.csv", "nowhere.csv"),
        ("report .", "leaderboard.json"),
        ("improve joint.csv --model coulomb-viscous --report .", "directory"),
        ("report joint.csv --model colomb-viscous", "did you mean 'coulomb-viscous'"),
        ("compare joint.csv --model coulomb-viscous --report joint.csv/page.html", "page.html"),
    ],
)
def test_what_cannot_be_done(arguments: str, named: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert done(arguments) == 2
    captured = capsys.readouterr()
    lines = [line for line in captured.err.splitlines() if not line.startswith("warning: ")]
    assert len(lines) == 1
    assert named in lines[0]
    assert not list(here.rglob("*.html"))
