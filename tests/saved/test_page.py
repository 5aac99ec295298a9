"""The page of models is executed from top to bottom: files, commands, Python, and its C."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from fricmodels.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "models.md"
BLOCK = re.compile(r"(?:<!-- file: (\S+) -->\n)?```(\w+)\n(.*?)```", re.DOTALL)


def test_every_block_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    kinds = []
    for file, kind, text in BLOCK.findall(PAGE.read_text(encoding="utf-8")):
        kinds.append(kind)
        if file:
            (tmp_path / file).write_text(text, encoding="utf-8")
        elif kind == "sh":
            for command in text.splitlines():
                _, *arguments = shlex.split(command)
                with pytest.raises(SystemExit) as stopped:
                    main(arguments)
                assert not stopped.value.code, f"{command}\n{capfd.readouterr().err}"
        elif kind == "python":
            exec(compile(text, str(PAGE), "exec"), names)
        elif kind == "c":
            _compiled(text, tmp_path, names["model"])
    assert kinds.count("python") >= 7
    assert kinds.count("sh") >= 4
    model = names["model"]
    assert model.parameters["K_c"] == pytest.approx(0.8, rel=0.02)
    assert model.parameters["cogging.k"] == pytest.approx(7.0, rel=1e-3)
    assert "dcmotor" in (tmp_path / "robot_with_friction.xml").read_text(encoding="utf-8")
    assert names["drive"].velocity != 0.0


def _compiled(text: str, folder: Path, model: Any) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        return
    include, body = text.split("\n", 1)
    said = 'printf("%.17g %.17g", friction, command);'
    program = f"{include}\n#include <stdio.h>\nint main(void) {{\n{body}\n{said}\nreturn 0; }}\n"
    (folder / "page.c").write_text(program, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-Wno-missing-field-initializers"]
    subprocess.run([compiler, *flags, "-o", "page", "page.c", "-lm"], cwd=folder, check=True)
    printed = subprocess.run([str(folder / "page")], capture_output=True, text=True, check=True).stdout.split()
    at = {"velocity": 1.0, "position": 0.2}
    assert float(printed[0]) == pytest.approx(model.torque(**at), rel=1e-12)
    assert float(printed[1]) == pytest.approx(model.compensation(**at, at_rest="smooth", width=0.05), rel=1e-12)
