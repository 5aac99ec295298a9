"""The JSON Schema of a configuration accepts what the parser accepts, and refuses what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator

from fricmodels.cli import main
from fricmodels.documents import read_yaml, validate
from fricmodels.errors import InputError
from fricmodels.tournament.config import Config

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FILES = sorted(path for path in (ROOT / "configs").rglob("*.yaml") if "datasets:" in path.read_text(encoding="utf-8"))


def on_pages() -> dict[str, str]:
    """Return every tournament that stands in the documents, by page and number."""
    found = {}
    for page in PAGES:
        fences = re.findall(r"```yaml.*?\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
        heredocs = re.findall(r"<<\s*'?(\w+)'?\n(.*?)\n\1\n", page.read_text(encoding="utf-8"), re.DOTALL)
        for number, text in enumerate([*fences, *(text for _, text in heredocs)]):
            if re.search(r"^datasets:", text, re.MULTILINE):
                found[f"{page.name} {number}"] = text
    return found


DOCUMENTED = on_pages()


@pytest.fixture
def schema(capsys: pytest.CaptureFixture[str]) -> Draft202012Validator:
    with pytest.raises(SystemExit) as done:
        main(["schema"])
    assert done.value.code == 0
    content: dict[str, Any] = json.loads(capsys.readouterr().out)
    Draft202012Validator.check_schema(content)
    return Draft202012Validator(content)


def problems(schema: Draft202012Validator, content: object) -> list[str]:
    return [f"{list(each.path)}: {each.message}" for each in schema.iter_errors(content)]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_configuration_of_the_project_fits(path: Path, schema: Draft202012Validator) -> None:
    assert problems(schema, read_yaml(path).content) == []


@pytest.mark.parametrize("name", DOCUMENTED)
def test_every_configuration_of_the_documents_fits(name: str, schema: Draft202012Validator) -> None:
    assert problems(schema, yaml.safe_load(DOCUMENTED[name])) == []


def test_there_are_such_documents() -> None:
    assert len(FILES) > 8
    assert any(name.startswith("README") for name in DOCUMENTED)
    assert any(name.startswith("getting-started") for name in DOCUMENTED)


WHOLE: dict[str, Any] = {
    "model": "coulomb-viscous",
    "parameters": {"K_v": 1.0, "K_c": 1.0},
    "inertia": 1.0,
    "amplitude": 1.0,
    "frequency": [1.0, 2.0],
}
WRITTEN: list[dict[str, Any]] = [
    {"datasets": [{"files": "a.csv"}]},
    {"datasets": [{"files": ["a.csv", "b.csv"], "runs": 1}]},
    {"datasets": [{"files": "a.csv", "runs": ["one", 2]}]},
    {"datasets": [{"simulate": {**WHOLE, "seeds": 3, "noise_percent": 2}}]},
    {"datasets": [{"simulate": {**WHOLE, "seeds": [1, 5], "noise_percent": [0, 2]}}]},
    {"datasets": [{"files": "a.csv"}], "models": "coulomb-viscous", "estimators": "rls"},
    {"datasets": [{"files": "a.csv"}], "estimators": {"name": "rls", "label": "mine"}},
    {"datasets": [{"files": "a.csv"}], "estimators": ["rls", {"name": "ekf", "settings": {}}]},
    {"datasets": [{"files": []}]},
    {"datasets": [{"files": 3}]},
    {"datasets": [{"files": "a.csv", "runs": []}]},
    {"datasets": [{"simulate": {**WHOLE, "seeds": -1}}]},
    {"datasets": [{"simulate": {**WHOLE, "amplitude": 0}}]},
    {"datasets": [{"simulate": {**WHOLE, "amplitude": []}}]},
    {"datasets": [{"files": "a.csv"}], "estimators": []},
    {"datasets": [{"files": "a.csv"}], "estimators": [3]},
    {"datasets": [{"files": "a.csv"}], "estimators": {"label": "mine"}},
    {"datasets": [{"files": "a.csv"}], "models": [["coulomb-viscous"]]},
]


@pytest.mark.parametrize("content", WRITTEN, ids=json.dumps)
def test_schema_and_parser_agree(content: dict[str, Any], schema: Draft202012Validator, tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    try:
        validate(read_yaml(path), Config)
        refused = False
    except InputError:
        refused = True
    assert bool(problems(schema, content)) == refused
