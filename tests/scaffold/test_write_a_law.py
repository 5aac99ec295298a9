"""The tutorial docs/write-a-law.md, line by line."""

from __future__ import annotations

import json
import re
import shlex
import time
from pathlib import Path
from typing import Any

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "write-a-law.md"
PIECE = re.compile(r"(?:<!-- (file|class): (\S+) -->\n)?```(python|sh)\n(.*?)```", re.DOTALL)
TEN_MINUTES = 600.0


@pytest.mark.long
def test_the_tutorial(environment: Any, tmp_path: Path) -> None:
    begin = time.monotonic()
    written, said = 0, ""
    for kind, name, language, content in PIECE.findall(PAGE.read_text(encoding="utf-8")):
        if kind == "file":
            (tmp_path / name).write_text(content, encoding="utf-8")
        elif kind == "class":
            written += sum(bool(line.strip()) for line in content.splitlines())
            replace_class(tmp_path / name, content)
        else:
            assert language == "sh"
            for line in filter(None, content.splitlines()):
                said += execute(environment, shlex.split(line), tmp_path)
    assert time.monotonic() - begin < TEN_MINUTES
    assert 0 < written < 25

    quoted = re.search(r"^> What remains:(?:.*\n> )*.*", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert quoted is not None
    assert " ".join(quoted[0].replace("> ", "").split()) in " ".join(said.split())
    before, after = (json.loads((tmp_path / name / "diagnosis.json").read_text()) for name in ("before", "after"))
    assert before["verdict"] == "unknown-effect"
    assert len(before["ladder"]) == 1
    first, last = after["ladder"][0], after["ladder"][-1]
    assert [step["added"] for step in after["ladder"] if step.get("added")] == ["rattling"]
    assert 4 < first["held_out_rms_percent"] < 5
    assert 5 < first["rms_percent"] < 6.5
    assert max(last["rms_percent"], last["held_out_rms_percent"]) < 1.2 * after["noise_floor_percent"]
    found = after["effects"][0]
    assert found["name"] == "rattling"
    expected = {"A": 0.30, "omega_0": 3.0, "w": 0.12}
    for symbol, true in expected.items():
        assert found["parameters"][symbol] == pytest.approx(true, rel=0.05)


def replace_class(file: Path, content: str) -> None:
    text = file.read_text(encoding="utf-8")
    start, end = text.index("class "), text.index("@hookimpl")
    file.write_text(f"{text[:start]}{content}\n\n{text[end:]}", encoding="utf-8")


def execute(environment: Any, command: list[str], directory: Path) -> str:
    program, *arguments = command
    if program == "pip":
        assert arguments[:2] == ["install", "-e"]
        environment.install(directory / arguments[2])
        return ""
    if program == "python":
        program, arguments = arguments[0].removesuffix(".py"), arguments[1:]
    done = environment.run(program, *arguments, cwd=directory)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"
    return str(done.stdout)
