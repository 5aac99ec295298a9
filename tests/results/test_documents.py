"""Typed documents of results come back as they were written, of earlier versions too; what is broken is refused."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from fricmodels.cli import main
from fricmodels.errors import InputError
from fricmodels.report import of_run
from fricmodels.report.answer import answer
from fricmodels.report.error_words import window
from fricmodels.report.page import Words
from fricmodels.results.comparison import Band, ComparisonDocument, Step
from fricmodels.results.diagnosis import DiagnosisDocument
from fricmodels.results.leaderboard import LeaderboardDocument

EARLIER = Path(__file__).with_name("earlier_diagnosis.json")
"""Of the first version that said where a recording came from; the recording is no longer there."""
AGAIN = "fricmodels improve"


@pytest.fixture(scope="module")
def earlier() -> DiagnosisDocument:
    return DiagnosisDocument.read(EARLIER, AGAIN)


def changed(*path: Any, to: Any) -> str:
    content = json.loads(EARLIER.read_text(encoding="utf-8"))
    inner = content
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = to
    return json.dumps(content)


def test_a_file_of_an_earlier_version_is_read_and_written_as_it_was(earlier: DiagnosisDocument) -> None:
    assert earlier.to_json() == EARLIER.read_text(encoding="utf-8")
    assert (earlier.remaining, earlier.correlation, earlier.coloured_noise) == (None, None, None)
    assert (earlier.candidates, earlier.note, earlier.recording.findings) == ((), "", ())
    assert window(earlier) == ""


def test_a_file_of_an_earlier_version_is_shown(earlier: DiagnosisDocument, tmp_path: Path) -> None:
    (tmp_path / "diagnosis.json").write_bytes(EARLIER.read_bytes())
    page = of_run(tmp_path)
    assert page.verdict.sentence == answer(earlier).sentence == "The model coulomb-viscous lacks one effect: gravity."
    note = page.sections[0].blocks[0]
    assert isinstance(note, Words)
    assert "There are no figures" in note.text


def test_the_models_on_the_way_have_parameters_wherever_these_stand(earlier: DiagnosisDocument) -> None:
    assert earlier.steps == earlier.ladder
    bare = earlier.ladder[0].model_copy(update={"parameters": {}, "standard_errors": {}})
    (alone,) = earlier.model_copy(update={"ladder": (bare,)}).steps
    assert alone == earlier.ladder[0]
    (given,) = ComparisonDocument.steps.fget(earlier)  # type: ignore[attr-defined]
    assert given == earlier.ladder[0].model_copy(update={"noise_floor_percent": earlier.noise_floor_percent})
    assert earlier.last_noise_floor_percent == earlier.noise_floor_percent, "its ladder has no noise of its own"


def test_keys_that_a_later_version_adds_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    path.write_text(changed("effects", 0, "later", to={"x": [1]}), encoding="utf-8")
    assert DiagnosisDocument.read(path, AGAIN).plain()["effects"][0]["later"] == {"x": [1]}


def test_a_document_does_not_change(earlier: DiagnosisDocument) -> None:
    with pytest.raises(ValidationError):
        earlier.model = "other"  # type: ignore[misc]


def test_numbers_that_json_lacks_are_none() -> None:
    nan, endless = float("nan"), float("inf")
    step = Step(model="m", rms_percent=nan, held_out_rms_percent=endless, added="", parameters={"a": -1.5, "b": nan})
    assert (step.rms_percent, step.held_out_rms_percent, step.parameters) == (None, None, {"a": -1.5, "b": None})
    assert Band.model_validate_json(json.dumps(dict.fromkeys(Band.model_fields))).SI is None


def fields(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for part in (schema, *schema["$defs"].values()):
        for key, field in part.get("properties", {}).items():
            yield f"{part['title']}.{key}", field


@pytest.mark.parametrize("model", [DiagnosisDocument, LeaderboardDocument])
def test_every_field_is_described_in_a_line(model: type[BaseModel]) -> None:
    schema = model.model_json_schema()
    described = {name: field.get("description", "") for name, field in fields(schema)}
    assert len(described) > 20
    assert not [name for name, text in described.items() if not text or "\n" in text]
    assert {"schema", "class"} & {name.partition(".")[2] for name in described}
    assert set(schema["required"]) <= set(schema["properties"])


@pytest.mark.parametrize(
    ("path", "value", "named"),
    [
        (("verdict",), "splendid", "verdict"),
        (("effects",), None, "effects"),
        (("effects", 0, "class"), "gravity", "class"),
        (("effects", 0, "p_value"), "small", "p_value"),
        (("ladder",), [], "ladder"),
        (("ladder", 0, "held_out_rms_percent"), "5", "held_out_rms_percent"),
        (("recording",), {}, "recording"),
        (("recording", "samples", "fitted"), 1.5, "fitted"),
        (("motion",), "sideways", "motion"),
        (("noise_floor_percent",), True, "noise_floor_percent"),
        (("schema",), "other/1", "schema"),
    ],
)
def test_what_was_changed_is_named_in_one_line(
    path: tuple[Any, ...], value: Any, named: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "diagnosis.json").write_text(changed(*path, to=value), encoding="utf-8")
    with pytest.raises(InputError, match=named):
        DiagnosisDocument.read(tmp_path / "diagnosis.json", AGAIN)
    with pytest.raises(SystemExit) as stopped:
        main(["report", str(tmp_path)])
    assert stopped.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert named in line
    assert "make it anew with: fricmodels improve" in line


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("ladder", -1, "held_out_rms_percent"), None),
        (("noise_floor_percent",), None),
        (("effects", 0, "p_value"), None),
        (("effects", 0, "held_out_gain"), None),
        (("recording", "interval"), None),
        (("inertia", "value"), None),
        (("recording", "source"), None),
        (("ladder", -1, "parameters"), {"K_v": None}),
        (("effects", 0, "name"), "an-effect-of-another-plugin"),
    ],
)
def test_a_number_that_is_none_is_a_dash(path: tuple[Any, ...], value: Any, tmp_path: Path) -> None:
    (tmp_path / "diagnosis.json").write_text(changed(*path, to=value), encoding="utf-8")
    assert of_run(tmp_path).verdict.sentence.startswith("The model coulomb-viscous lacks")
