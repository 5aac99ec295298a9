"""The import directions, the length of files, and what must not stand in the repository."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SOURCES = ROOT / "src"

# The way of the data: a layer imports those above it in this list, and itself.
LAYERS = (
    {
        "arrays",
        "errors",
        "display",
        "documents",
        "files",
        "gaps",
        "lazy",
        "once",
        "processes",
        "progress",
        "stored",
        "terminal",
        "yaml_file",
    },
    {"dimension"},
    {"results"},
    {"expressions", "parameter", "kernels"},
    {"hookspecs", "past", "term", "recording"},
    {"plugins"},
    {"beginning", "fitted_runs", "memory", "model", "state_space"},
    {"drive"},
    {"fit"},
    {"signals", "loop", "simulation", "stick_slip", "readers", "split", "laws", "effects", "rig"},
    {"logcheck"},
    {"score", "tracking"},
    {"weakform"},
    {"interval", "motion", "sums"},
    {"estimator"},
    {"filtering"},
    {"tournament", "diagnosis", "testing"},
    {"saved"},
    {"compensation", "export", "report"},
    {"notebook"},
    {"scaffold"},
    {"cli", "__main__"},
)
LEVEL = {room: level for level, rooms in enumerate(LAYERS) for room in rooms}


def modules() -> list[Path]:
    return sorted(SOURCES.rglob("*.py"))


def dotted(file: Path) -> str:
    return ".".join(file.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")


FILES = {dotted(file): file for file in modules()}


@cache
def read(file: Path) -> tuple[list[str], list[tuple[str, int]]]:
    """Return what `imports` does of a file, and the plain names that it calls, with their lines."""
    nodes = list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
    calls = [(n.func.id, n.lineno) for n in nodes if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)]
    return list(imported(file, nodes)), calls


def imports(file: Path) -> list[str]:
    """Return the dotted names that a file imports, wherever in it: when it runs, for type checkers, or as a string."""
    return read(file)[0]


def imported(file: Path, nodes: list[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: imports are absolute"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and "." in node.value:
            yield from [node.value] * (node.value in FILES)
        elif isinstance(node, ast.JoinedStr) and isinstance(node.values[0], ast.Constant):
            start = str(node.values[0].value)  # f"fricmodels.cli.{name}" may be any module of that room
            yield from (name for name in FILES if start.endswith(".") and name.startswith(start) and name != start)


def imported_files(file: Path) -> set[Path]:
    """Return the files that a file imports, itself left out."""
    names = (name if name in FILES else name.rpartition(".")[0] for name in imports(file))
    return {FILES[name] for name in names if name in FILES} - {file}


def test_no_files_import_each_other_in_a_circle() -> None:
    """Imports for type checkers and those by a string count: a circle hidden from the interpreter is one."""
    left = {file: imported_files(file) for file in modules()}
    while free := {file for file, targets in left.items() if not targets & set(left)}:
        left = {file: targets for file, targets in left.items() if file not in free}
    assert not left, f"these import each other, or what does: {sorted(map(dotted, left))}"


def room(name: str) -> str | None:
    """Return the part of ``fricmodels`` that a dotted name belongs to."""
    parts = name.split(".")
    return parts[1] if parts[0] == "fricmodels" and len(parts) > 1 and parts[1] in LEVEL else None


def own_room(file: Path) -> str:
    return file.relative_to(SOURCES / "fricmodels").parts[0].removesuffix(".py")


@pytest.mark.parametrize("file", modules(), ids=lambda file: str(file.relative_to(SOURCES)))
def test_imports_go_one_way(file: Path) -> None:
    inside = file.relative_to(SOURCES).parts[0]
    for name in imports(file):
        assert name.split(".")[0] != "fricmodels_makkar", "plugins are found, not imported"
        if inside == "estimators":
            target = room(name)
            assert target is None or LEVEL[target] < LEVEL["tournament"], f"estimators do not import {name}"
            assert target not in {"laws", "effects"}, f"estimators know no particular law: {name}"
            continue
        assert name.split(".")[0] != "estimators", f"fricmodels does not import estimators: {name}"
        own, target = own_room(file), room(name)
        if target is None or own == "__init__" or target == own:
            continue
        assert LEVEL[target] <= LEVEL[own], f"{own} stands above {target} in the way of the data: {name}"


def test_every_room_has_its_place() -> None:
    rooms = {own_room(file) for file in modules() if file.relative_to(SOURCES).parts[0] == "fricmodels"}
    assert rooms - {"__init__"} <= set(LEVEL), "a new room takes its place in LAYERS"


@pytest.mark.parametrize("consumer", ["tournament", "diagnosis", "score", "drive", "model", "cli", "export"])
def test_laws_and_effects_come_through_the_plugin_manager_alone(consumer: str) -> None:
    for file in modules():
        if file.relative_to(SOURCES).parts[0] != "fricmodels" or own_room(file) != consumer:
            continue
        for name in imports(file):
            assert room(name) not in {"laws", "effects"}, f"{file.relative_to(ROOT)} imports {name}"


def test_the_rig_is_independent_of_the_effects() -> None:
    for file in modules():
        if file.relative_to(SOURCES).parts[0] == "fricmodels" and own_room(file) == "rig":
            found = {room(name) for name in imports(file)}
            assert not found & {"effects", "laws", "model", "drive", "simulation", "term"}, file.name


def tracked() -> list[Path]:
    """Return the files under version control, or all that could be where there is none."""
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("this is no clone of the repository")
    return [ROOT / line for line in listed.stdout.splitlines() if (ROOT / line).is_file()]


def test_no_file_is_longer_than_400_lines() -> None:
    long = {
        str(file.relative_to(ROOT)): count
        for file in tracked()
        if file.suffix == ".py" and (count := len(file.read_text(encoding="utf-8").splitlines())) > 400
    }
    assert not long


def test_no_machine_stands_in_the_repository() -> None:
    """No absolute path of a machine, no address of a package index."""
    home = re.compile(r"(?<![\w.])/(?:home|Users|root|work|mnt|tmp/v)/\w|[A-Z]:\\\\Users")
    index = re.compile(r"(?:--(?:extra-)?index-url|--find-links|index_url|pypi\.org/simple|://[^\s/]*:\d+/simple)")
    found = []
    for file in tracked():
        if file == Path(__file__) or file.suffix in {".png", ".parquet", ".mat", ".svg"}:
            continue
        text = file.read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), start=1):
            if home.search(line) or index.search(line):
                found.append(f"{file.relative_to(ROOT)}:{number}: {line.strip()[:80]}")
    assert not found


def test_no_pickle_no_eval() -> None:
    forbidden = {"eval", "exec"}
    for file in modules():
        assert not {name.split(".")[0] for name in imports(file)} & {"pickle", "dill", "cloudpickle", "marshal"}, file
        for called, line in read(file)[1]:
            assert called not in forbidden, f"{file}:{line}"
