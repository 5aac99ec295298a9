"""Every command that README and docs show is executed, in order, with the files that they show."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from fricmodels.cli import COMMANDS, main

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "plugins" / "fricmodels-makkar" / "README.md"]
FILE = re.compile(r"<!-- file: (\S+) -->\n```\w+\n(.*?)```", re.DOTALL)
SHELL = re.compile(r"```sh\n(.*?)```", re.DOTALL)


def run(command: str) -> int:
    program, *arguments = shlex.split(command)
    assert program == "fricmodels"
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    return int(stopped.value.code or 0)


def test_readme(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    text = PAGES[0].read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for name, content in FILE.findall(text):
        (tmp_path / name).write_text(content, encoding="utf-8")
    commands = [line for block in SHELL.findall(text) for line in block.splitlines() if line.strip()]
    assert len(commands) > 8
    for command in commands:
        assert run(command) == 0, f"{command}\n{capfd.readouterr().err}"
    rows = json.loads((tmp_path / "runs" / "motor" / "leaderboard.json").read_text())["rows"]
    error = "held_out_rms_torque_error_percent"
    assert rows[0]["model"] == "coulomb-viscous+gravity"
    assert rows[0][error] < 0.5 * rows[1][error]
    diagnosis = json.loads((tmp_path / "runs" / "ladder" / "diagnosis.json").read_text())
    assert [step["added"] for step in diagnosis["ladder"] if step.get("added")] == ["gravity"]


def test_commands_that_the_readme_names_exist() -> None:
    named = set(re.findall(r"fricmodels ([a-z]+)", PAGES[0].read_text(encoding="utf-8")))
    assert named <= set(COMMANDS)
    assert set(COMMANDS) <= named


def test_other_pages_name_commands_that_exist() -> None:
    for page in [*PAGES, *sorted((ROOT / "docs").rglob("*.md"))]:
        for line in re.findall(r"^\s*fricmodels ([a-z]+)", page.read_text(encoding="utf-8"), re.MULTILINE):
            assert line in COMMANDS, f"{page.relative_to(ROOT)}: fricmodels {line}"
