"""Every command that a page of the documentation shows is executed, with the files that the page shows."""

from __future__ import annotations

import inspect
import json
import pydoc
import re
import runpy
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from fricmodels.cli import COMMANDS, main

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
FILE = re.compile(r"<!-- file: (\S+) -->\n```\w+\n(.*?)```", re.DOTALL)
SHELL = re.compile(r"```(?:sh|bash|console)\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+\.(?:md|png))(?:#[\w-]*)?\)")
PAGES = sorted(page for page in DOCS.rglob("*.md"))


def commands(page: Path) -> list[str]:
    lines = [line for block in SHELL.findall(page.read_text(encoding="utf-8")) for line in block.splitlines()]
    return [line.removeprefix("$ ") for line in lines if line.removeprefix("$ ").startswith("fricmodels ")]


ELSEWHERE = {"write-a-law.md", "models.md"}
"""They need Python between their commands: tests/scaffold and tests/saved/test_page.py execute them."""
SLOW = {"getting-started.md", "report.md", "compensation.md"}
"""Quicker tests execute such commands: of README, tests/saved/test_page.py, tests/report/test_commands.py, and
tests/cli/test_compensate.py."""
WITH_COMMANDS = [
    pytest.param(page, marks=pytest.mark.long if page.name in SLOW else ())
    for page in PAGES
    if commands(page) and page.name not in ELSEWHERE
]


def name(page: Path) -> str:
    return str(page.relative_to(DOCS))


@pytest.mark.parametrize("page", WITH_COMMANDS, ids=name)
def test_commands_of_a_page_do_what_they_say(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for file, content in FILE.findall(page.read_text(encoding="utf-8")):
        (tmp_path / file).write_text(content, encoding="utf-8")
    for command in commands(page):
        _, *arguments = shlex.split(command)
        with pytest.raises(SystemExit) as stopped:
            main(arguments)
        assert int(stopped.value.code or 0) == 0, f"{command}\n{capfd.readouterr().err}"
    if page.name == "getting-started.md":
        found = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
        assert found["effects"][0]["name"] == "cogging"
        assert found["effects"][0]["parameters"]["k"] == pytest.approx(9.0, rel=1e-2)
        assert found["ladder"][-1]["held_out_rms_percent"] < 0.2 * found["ladder"][0]["held_out_rms_percent"]
        rows = json.loads((tmp_path / "runs" / "joint" / "leaderboard.json").read_text(encoding="utf-8"))["rows"]
        assert rows[0]["model"] == "coulomb-viscous+cogging"
    if page.name == "tournaments.md":
        assert (tmp_path / "motors.html").exists()


def test_every_command_is_documented_and_exists() -> None:
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    named = set(re.findall(r"^\s*fricmodels ([a-z]+)", text, re.MULTILINE))
    assert named <= set(COMMANDS)
    assert {"run", "leaderboard", "list", "compare", "diagnose", "improve", "simulate"} <= named


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (page.parent / target).exists(), target


@pytest.mark.parametrize("name", ["effects.md", "decisions/policy.md"])
def test_the_tables_are_those_of_the_code(name: str) -> None:
    page = runpy.run_path(str(DOCS / "tables.py"))["page"]
    assert (DOCS / name).read_text(encoding="utf-8") == page(name), "run: python docs/tables.py"


def test_the_navigation_names_pages_that_exist() -> None:
    listed = re.findall(r"([\w/-]+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert all((DOCS / page).exists() for page in listed)
    assert sorted(listed) == sorted(map(name, PAGES)), "every page stands in the navigation"


def test_the_site_needs_no_network() -> None:
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert "://" not in text
    assert re.search(r"^  font: false$", text, re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_formulas_are_set_and_not_typed(page: Path) -> None:
    """Code spans and indented lines hold names and commands; what is a formula is written in TeX."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    text = "\n".join(line for line in text.splitlines() if not line.startswith(">"))  # what the program said
    assert re.findall(r"`[^`\n]*(?:[∫Σ√∂‖]|\^\(|d[τω]/dt = )[^`\n]*`", text.replace("`τ = …;  dz/dt = …`", "")) == []
    assert [line for line in text.splitlines() if re.match(r" {4}\S.*[τωφσΣ∫].* = ", line)] == []


def referred() -> Iterator[tuple[str, object]]:
    """Yield every function, class and method that the reference shows, by name."""
    text = (DOCS / "reference.md").read_text(encoding="utf-8")
    for path, chosen in re.findall(r"^::: (\S+)\n(?: +options: \{members: \[([^]]*)\]\})?", text, re.MULTILINE):
        place = pydoc.locate(path)
        names = chosen.split(", ") if chosen else [name for name in vars(place) if not name.startswith("_")]
        for name in names if inspect.ismodule(place) else [""]:
            found = getattr(place, name) if name else place
            if inspect.isclass(found):
                yield from ((f"{path}.{name}.{own}", value) for own, value in vars(found).items() if own[0] != "_")
            yield f"{path}.{name}", found


def test_the_reference_says_each_argument_by_itself() -> None:
    """The documentation is built strictly: an argument that is not in the signature ends it."""
    together = [
        f"{name}: {line.strip()}"
        for name, found in referred()
        for line in (inspect.getdoc(found) or "").partition("Args:")[2].partition("\n\n")[0].splitlines()
        if re.match(r" {4}\w+(, \w+)+:", line)
    ]
    assert together == []


def test_the_plugin_of_the_page_is_an_effect(tmp_path: Path) -> None:
    from fricmodels.dimension import Motion
    from fricmodels.model import Model

    files = dict(FILE.findall((DOCS / "plugins.md").read_text(encoding="utf-8")))
    module = tmp_path / "my_effects.py"
    module.write_text(files["my_effects.py"], encoding="utf-8")
    (effect,) = runpy.run_path(str(module))["fricmodels_effects"]()
    model = Model.only(effect())
    assert model.needs == {"position", "velocity"}
    assert model.linear == (True,)
    assert model.parameters[0].declared.unit_for(Motion.LINEAR) == "N/m"


def test_the_filter_of_the_page_runs_sample_by_sample(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = dict(FILE.findall((DOCS / "getting-started.md").read_text(encoding="utf-8")))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "joint.yaml").write_text(files["joint.yaml"].replace("10000", "2000"), encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["simulate", "joint.yaml", "--out", "joint.csv"])
    (code,) = re.findall(r"```python\n(.*?)```", (DOCS / "estimators.md").read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "online.py").write_text(code, encoding="utf-8")
    estimate = runpy.run_path(str(tmp_path / "online.py"))["estimate"]
    assert {"K_v", "K_c"} <= set(estimate)
