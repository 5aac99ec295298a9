"""What a diagnosis leaves behind: ``diagnosis.json``, ``overlay.csv``, words for people, tables for a terminal."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from pydantic import BaseModel
from rich.console import Console

from fricmodels.diagnosis import Diagnosis, Ladder, improve
from fricmodels.diagnosis.comparison import SlidingErrors
from fricmodels.diagnosis.document import added, comparison_document, document, write
from fricmodels.diagnosis.explain import explain, sentence, unknown
from fricmodels.diagnosis.floor import is_above_noise
from fricmodels.diagnosis.overlay import write_overlay
from fricmodels.diagnosis.present import show_comparison, show_diagnosis, show_ladder
from fricmodels.model import Model
from fricmodels.progress import Progress
from fricmodels.recording import Recording
from fricmodels.results.comparison import SCHEMA
from fricmodels.results.diagnosis import DiagnosisDocument

Made = Callable[..., Recording]


@pytest.fixture(scope="module")
def ladder(made: Made) -> Ladder:
    values = {"cogging.a": 0.8, "cogging.b": 0.3, "cogging.k": 7.3}
    lines: list[Progress] = []
    found = improve(made("coulomb-viscous+cogging", values), Model.parse("coulomb-viscous"), 2.0, progress=lines.append)
    assert lines[0].stage == "fitting coulomb-viscous"
    assert "adding cogging" in [line.stage for line in lines]
    return found


@pytest.fixture(scope="module")
def diagnosis(ladder: Ladder) -> Diagnosis:
    return ladder.first


def numbers(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [n for item in value.values() for n in numbers(item)]
    if isinstance(value, list):
        return [n for item in value for n in numbers(item)]
    return [value] if isinstance(value, float) else []


@pytest.mark.parametrize("with_ladder", [False, True])
def test_the_document_has_the_keys_of_the_design(diagnosis: Diagnosis, ladder: Ladder, with_ladder: bool) -> None:
    data = document(diagnosis, ladder if with_ladder else None).plain()
    assert data["schema"] == SCHEMA == "fricmodels/diagnosis/1"
    designed = {"schema", "dataset", "model", "rms_torque_error", "noise_floor_percent", "where", "verdict"}
    assert designed | {"effects", "ladder"} <= set(data)
    errors = data["rms_torque_error"]
    assert {"SI", "percent", "held_out_percent", "band_ms", "bands"} <= set(errors)
    ranking = next(band for band in errors["bands"] if band["window_ms"] == errors["band_ms"])
    assert [ranking[key] for key in ("SI", "percent", "held_out_percent")] == list(errors.values())[:3]
    assert ranking["noise_floor_percent"] == data["noise_floor_percent"]
    assert all({"regime", "share_of_squared_error", "samples"} <= set(row) for row in data["where"])
    assert data["verdict"] in {"adequate", "missing-effect", "undecided", "unknown-effect"}
    keys = {"name", "class", "p_value", "share_of_residual", "held_out_gain", "parameters", "separated_by"}
    assert all(keys <= set(effect) for effect in data["effects"])
    rungs = {"model", "rms_percent", "held_out_rms_percent", "added"}
    assert all(rungs <= set(rung) for rung in data["ladder"])


def test_the_document_says_what_was_found(diagnosis: Diagnosis, ladder: Ladder) -> None:
    data = document(diagnosis, ladder)
    assert (data.dataset, data.model, data.inertia.estimated) == ("made", "coulomb-viscous", False)
    (effect, *_) = data.effects
    assert effect.name == "cogging"
    assert effect.names[0] == "cogging"
    assert effect.parameters["k"] == pytest.approx(7.3, rel=0.01)
    assert effect.units == dict.fromkeys(("a", "b", "a_2", "b_2"), "N m") | {"k": "1/rad"}
    assert [step.added for step in data.ladder][:2] == ["", "cogging"]
    before, after = (step.held_out_rms_percent or 0.0 for step in (data.ladder[0], data.ladder[-1]))
    assert after < 0.8 * before
    assert data.ladder[-1].parameters["cogging.k"] == pytest.approx(7.3, rel=0.005)
    assert added(ladder)[0].tested.name == "cogging"


def test_numbers_are_those_that_json_has(diagnosis: Diagnosis, tmp_path: Path) -> None:
    errors = diagnosis.comparison.errors
    headline = replace(errors.headline, noise_floor_percent=float("nan"))
    broken = replace(diagnosis.comparison, errors=replace(errors, headline=headline))
    data = document(replace(diagnosis, comparison=broken))
    assert data.noise_floor_percent is None
    assert all(np.isfinite(numbers(data.plain())))
    path = write(data, tmp_path / "new" / "folder")
    assert path.name == "diagnosis.json"
    assert json.loads(path.read_text(encoding="utf-8")) == data.plain()
    assert "NaN" not in path.read_text(encoding="utf-8")
    assert [p.name for p in path.parent.iterdir()] == ["diagnosis.json"], "nothing half-written stays behind"


def unknown_keys(value: object) -> list[str]:
    """Return the keys of a document that have no field, however deep."""
    if isinstance(value, BaseModel):
        return [*(value.model_extra or {}), *unknown_keys([getattr(value, name) for name in type(value).model_fields])]
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    return [key for item in inner for key in unknown_keys(item)]


@pytest.mark.parametrize("with_ladder", [False, True])
def test_the_document_comes_back_as_it_was_written(
    diagnosis: Diagnosis, ladder: Ladder, with_ladder: bool, tmp_path: Path
) -> None:
    data = document(diagnosis, ladder if with_ladder else None)
    path = write(data, tmp_path)
    again = DiagnosisDocument.read(path, "")
    assert again == data
    assert again.to_json() == path.read_text(encoding="utf-8")
    assert unknown_keys(again) == []
    assert list(again.plain())[-2:] == ["recording", "versions"]


def test_a_comparison_is_the_beginning_of_its_diagnosis(diagnosis: Diagnosis) -> None:
    own, whole = comparison_document(diagnosis.comparison).plain(), document(diagnosis).plain()
    assert own.items() <= whole.items()
    (step,) = comparison_document(diagnosis.comparison).steps
    assert step == document(diagnosis).steps[0]


def test_the_overlay_adds_up(diagnosis: Diagnosis, tmp_path: Path) -> None:
    comparison = diagnosis.comparison
    table = pd.read_csv(write_overlay(comparison, tmp_path))
    assert list(table.columns) == ["time_s", "measured_Nm", "modelled_Nm", "error_Nm", "kept_back"]
    np.testing.assert_allclose(table.measured_Nm - table.modelled_Nm, table.error_Nm, atol=1e-9)
    assert len(table) == len(comparison.train) + len(comparison.test)
    assert table.kept_back.mean() == pytest.approx(0.3, abs=0.03)
    assert table.time_s.is_monotonic_increasing
    rms = float(np.sqrt(np.mean(table.error_Nm[~table.kept_back] ** 2)))
    assert rms == pytest.approx(comparison.errors.SI, rel=1e-6)


def test_words_name_physics_equation_evidence_and_what_would_tell(diagnosis: Diagnosis) -> None:
    finding = diagnosis.findings[0]
    text = sentence(finding)
    for part in (
        "'cogging' is missing",
        "poles, slots or teeth",
        "a·cos kq + b·sin kq",
        "periodic in position",
        "p < 1e-06 after correction",
    ):
        assert part in text
    several = replace(finding, names=("cogging", "gravity"), separated_by="a full turn")
    assert "cannot tell it from 'gravity'; what would: a full turn." in sentence(several)


def test_words_for_every_verdict(diagnosis: Diagnosis, ladder: Ladder) -> None:
    assert "'coulomb-viscous' leaves an RMS torque error of" in explain(diagnosis)
    adequate = replace(diagnosis, verdict="adequate", findings=())
    assert "adequate for this recording" in explain(adequate)
    assert "does not exclude" in explain(adequate)
    told = explain(diagnosis, ladder)
    assert f"With '{ladder.rungs[-1].model}' the test error falls to" in told
    assert "it was late." in explain(diagnosis, replace(ladder, note="it was late"))
    assert unknown(adequate) == ""
    assert "\n" not in told


def test_an_error_that_nothing_predicts_is_told(diagnosis: Diagnosis) -> None:
    comparison = diagnosis.comparison
    silent = replace(diagnosis, verdict="unknown-effect", findings=(), view=None)
    for fitted, held_out in ((40.0, 1.0), (1.0, 40.0)):
        spoilt = replace(comparison, sliding=SlidingErrors(fitted, held_out, 0.2, 0.2))
        assert is_above_noise(spoilt)
        told = explain(replace(silent, comparison=spoilt))
        assert "far above the noise" in told
        assert f"lies in '{comparison.where[0].regime}'" in told
    for fitted, noise in ((1.0, 0.2), (40.0, 39.8)):
        assert not is_above_noise(replace(comparison, sliding=SlidingErrors(fitted, 1.0, noise, noise)))


def test_tables_hold_no_colours_where_they_are_piped(diagnosis: Diagnosis, ladder: Ladder) -> None:
    stream = io.StringIO()
    console = Console(file=stream, width=120)
    show_comparison(console, diagnosis.comparison)
    show_diagnosis(console, diagnosis, ladder)
    show_ladder(console, ladder)
    text = stream.getvalue()
    assert "\x1b" not in text
    for part in (
        "K_v",
        "N m s/rad",
        "given",
        "Where it fails",
        "Verdict: ",
        "cogging",
        "The ladder",
        "coulomb-viscous+cogging",
    ):
        assert part in text
    assert "Could not have been seen" in text


def test_parameters_are_printed_with_their_standard_errors(diagnosis: Diagnosis) -> None:
    estimate = diagnosis.comparison.estimate
    for key, truth in {"K_v": 0.5, "K_c": 3.0}.items():
        assert abs(estimate.parameters[key] - truth) < 5 * estimate.standard_errors[key] + 0.02 * truth
