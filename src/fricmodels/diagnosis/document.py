"""``diagnosis.json``: what other programs read. The schema is versioned; fields are only ever added."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fricmodels import plugins
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.correlation import correlation
from fricmodels.diagnosis.diagnose import Diagnosis, Finding
from fricmodels.diagnosis.explain import explain, sentence, unknown
from fricmodels.diagnosis.floor import beyond_sampling_percent, is_above_noise
from fricmodels.diagnosis.ladder import Ladder, added
from fricmodels.dimension import Motion
from fricmodels.files import write_text

SCHEMA = "fricmodels/diagnosis/1"


def document(diagnosis: Diagnosis, ladder: Ladder | None = None) -> dict[str, Any]:
    """Return the diagnosis of a model, and the ladder that improved it, as plain data.

    With a ladder, ``effects`` lists what it added, in order; the verdict is that of the model that was given; what
    remains on the last rung that no known effect explains is ``unknown``.
    """
    comparison = diagnosis.comparison
    motion = comparison.drive.motion
    findings = diagnosis.findings if ladder is None else added(ladder)
    view = diagnosis.view if ladder is None else ladder.last.view
    data = {
        **facts(comparison),
        "verdict": diagnosis.verdict,
        "effects": [_effect(finding, motion) for finding in findings],
        "unknown": None
        if view is None
        else {"channels": view.channels, "p_value": view.p_value, "held_out_gain": view.evidence.gain},
        "remaining": _remaining(diagnosis if ladder is None else ladder.last),
        "candidates": _candidates(diagnosis),
        "correlation": _correlation(comparison if ladder is None else ladder.rungs[-1].comparison),
        "coloured_noise": _coloured_noise(diagnosis if ladder is None else ladder.last),
        "beyond_sampling_percent": _beyond_sampling(diagnosis if ladder is None else ladder.last),
        "could_have_been_seen": {
            name: {
                "smallest_percent": row.smallest_percent,
                "smallest_torque": row.smallest_torque,
                "missing": row.missing,
                **({"band": list(row.band)} if row.band else {}),
            }
            for name, row in (diagnosis if ladder is None else ladder.last).visibility.items()
        },
        "explanation": explain(diagnosis, ladder),
        "ladder": _ladder(diagnosis, ladder),
        "note": "" if ladder is None else ladder.note,
        "recording": described(comparison),
        "versions": plugins.versions(),
    }
    finite: dict[str, Any] = _finite(data)
    return finite


def facts(comparison: Comparison) -> dict[str, Any]:
    """Return a comparison as plain data: the model and its parameters, the errors, and where they lie."""
    drive = comparison.drive
    return {
        "schema": SCHEMA,
        "dataset": comparison.train.name,
        "model": drive.model.name,
        "motion": drive.motion.value,
        "inertia": {
            "value": comparison.estimate.parameters[drive.inertia_key],
            "unit": "kg m^2" if drive.motion is Motion.ROTARY else "kg",
            "estimated": drive.inertia is None,
        },
        "parameters": dict(comparison.estimate.parameters),
        "standard_errors": dict(comparison.estimate.standard_errors),
        "rms_torque_error": {
            "SI": comparison.errors.SI,
            "percent": comparison.errors.percent,
            "held_out_percent": comparison.errors.held_out_percent,
            "band_ms": comparison.errors.headline.window_ms,
            "bands": [asdict(band) for band in comparison.errors.bands],
        },
        "noise_floor_percent": comparison.noise_floor_percent,
        "where": [
            {
                "regime": row.regime,
                "share_of_squared_error": row.share_of_squared_error,
                "samples": row.samples,
                "share_of_samples": row.share_of_samples,
                "rms_torque_error": row.rms_torque_error,
            }
            for row in comparison.where
        ],
    }


def described(comparison: Comparison) -> dict[str, Any]:
    """Return what was compared: the file with its checksum and how it was read, samples, channels."""
    train, test = comparison.train, comparison.test
    known = train.provenance
    columns = known.get("columns", {})
    return {
        "source": known.get("source"),
        "files": known.get("files"),
        "sha256": known.get("sha256"),
        "reader": known.get("reader"),
        "columns": [columns[channel] for channel in sorted(columns)],
        "torque_constant": known.get("torque_constant"),
        "channels": [name for name in train.channels if name not in train.derived],
        "derived": sorted(train.derived),
        "samples": {"fitted": len(train), "kept_back": len(test)},
        "interval": train.interval,
        "true_model": known.get("true_model"),
        "findings": list(known.get("findings", ())),
    }


def _beyond_sampling(diagnosis: Diagnosis) -> float | None:
    """Return the error without what sampling hides, where it is far above noise and nothing predicts it."""
    hidden = diagnosis.verdict == "adequate" and is_above_noise(diagnosis.comparison, diagnosis.policy)
    return beyond_sampling_percent(diagnosis.comparison) if hidden else None


def _candidates(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return every effect that was tested on the given model, the one with the least error on held-out blocks first.

    ``gates`` says whether it passes all three by itself; most that do only resemble the first.
    """
    if diagnosis.result is None:
        return []
    passing = {tested.name for tested in diagnosis.passing}
    return [
        {
            "name": tested.name,
            "p_value": tested.adjusted,
            "share_of_residual": tested.evidence.explained,
            "held_out_gain": tested.evidence.gain,
            "gates": tested.name in passing,
        }
        for tested in diagnosis.result.tested
    ]


def _correlation(comparison: Comparison) -> dict[str, Any] | None:
    known = correlation(comparison)
    return None if known is None else {"parameters": list(known[0]), "matrix": known[1].tolist()}


def _remaining(diagnosis: Diagnosis) -> dict[str, Any] | None:
    rest = diagnosis.remaining
    return None if rest is None else {**asdict(rest), "text": unknown(diagnosis)}


def _effect(finding: Finding, motion: Motion) -> dict[str, Any]:
    tested = finding.tested
    units = {p.symbol: p.unit_for(motion) for p in tested.effect.parameters}
    return {
        "name": tested.name,
        "class": list(finding.names),
        "p_value": tested.adjusted,
        "share_of_residual": tested.evidence.explained,
        "held_out_gain": tested.evidence.gain,
        "parameters": dict(tested.parameters),
        "standard_errors": dict(tested.standard_errors),
        "units": units,
        "separated_by": finding.separated_by,
        "equation": tested.effect.formula,
        "explanation": sentence(finding, motion),
    }


def _coloured_noise(diagnosis: Diagnosis) -> dict[str, float] | None:
    """Return what is left as noise of the torque that lasts, in SI units; ``None`` where it is not that."""
    noise = diagnosis.noise
    if noise is None:
        return None
    return {"SI": noise.deviation, "percent": noise.percent, "correlation_time_s": noise.lasts}


def _ladder(diagnosis: Diagnosis, ladder: Ladder | None) -> list[dict[str, Any]]:
    if ladder is None:
        errors = diagnosis.comparison.errors
        name = diagnosis.comparison.drive.model.name
        return [
            {"model": name, "rms_percent": errors.percent, "held_out_rms_percent": errors.held_out_percent, "added": ""}
        ]
    return [
        {
            "model": rung.model,
            "rms_percent": rung.comparison.errors.percent,
            "held_out_rms_percent": rung.comparison.errors.held_out_percent,
            "added": rung.added,
            "removed": rung.removed,
            "parameters": dict(rung.comparison.estimate.parameters),
            "standard_errors": dict(rung.comparison.estimate.standard_errors),
        }
        for rung in ladder.rungs
    ]


def _finite(value: Any) -> Any:
    """Replace numbers that JSON does not have by null."""
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def write(data: Mapping[str, Any], directory: Path) -> Path:
    """Write ``diagnosis.json`` into a directory, whole or not at all."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return write_text(directory / "diagnosis.json", text)
