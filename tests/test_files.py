"""Files appear whole; what a killed program left of one is removed, what a living one writes is not."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from fricmodels import files

WRITER = """
import sys, time
from pathlib import Path
from fricmodels.files import replaced
with replaced(Path(sys.argv[1])) as beside:
    beside.write_text("half of")
    print("writing", flush=True)
    time.sleep(60)
"""


@pytest.fixture(autouse=True)
def _fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "_tidied", set())


def test_what_a_killed_program_left_is_removed_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writers = []
    for name in ("one.json", "two.json"):
        writers.append(subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path / name)], stdout=subprocess.PIPE))
        assert writers[-1].stdout is not None
        assert writers[-1].stdout.readline() == b"writing\n"
    others = [".mine.abcdefgh.part", "notes.part", ".film.part", ".one.json.ABC.fricmodels.part"]
    for name in others:
        (tmp_path / name).write_text("mine")
    (tmp_path / ".x.abcdefgh.fricmodels.part").symlink_to(tmp_path / "notes.part")
    killed, living = writers
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    try:
        files.write_text(tmp_path / "three.json", "{}")
        left = sorted(path.name.split(".")[1] for path in tmp_path.glob(".*.json.????????.fricmodels.part"))
        assert left == ["two"], "the one that is being written stays"
        assert all((tmp_path / name).exists() for name in others)
    finally:
        living.kill()
        living.communicate()
    files.write_text(tmp_path / "four.json", "{}")
    assert len([*tmp_path.glob(".two.*")]) == 1, "a folder is looked at once"
    monkeypatch.setattr(files, "_tidied", set())
    files.write_text(tmp_path / "five.json", "{}")
    assert not [*tmp_path.glob(".two.*")]


def test_where_files_cannot_be_locked_they_are_written_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl

    def refuse(*_: object) -> None:
        raise OSError(95, "not supported")

    monkeypatch.setattr(fcntl, "flock", refuse)
    files.write_text(tmp_path / "a.json", "{}")
    left = tmp_path / ".a.json.abcdefgh.fricmodels.part"
    left.write_text("half of")
    files.remove_left_over(tmp_path)
    monkeypatch.setattr(files, "_tidied", set())
    files.remove_left_over(tmp_path)
    assert left.exists(), "nobody knows whether it is in use"
    assert (tmp_path / "a.json").read_text() == "{}"


def test_a_long_document_is_written_as_json_writes_it(tmp_path: Path) -> None:
    head, rows = {"schema": "x", "none": []}, [{"a": 1.5, "b": [None, True, {"ω": "é"}]}, {}]
    files.write_listed(tmp_path / "a.json", head, "rows", rows)
    text = json.dumps({**head, "rows": rows}, indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == text
    with pytest.raises(ValueError, match="not JSON compliant"):
        files.write_listed(tmp_path / "a.json", head, "rows", [{"a": float("nan")}])
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == text, "what was there stays"
