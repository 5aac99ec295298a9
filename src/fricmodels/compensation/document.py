"""A study of compensation as plain data: ``{"schema": "fricmodels/compensation/1", …}`` and a table."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fricmodels.compensation.study import NONE, Study, Way
from fricmodels.errors import InputError
from fricmodels.files import write_text

SCHEMA = "fricmodels/compensation/1"
SUFFIXES = (".json", ".csv")


def document(studies: Sequence[Study]) -> dict[str, Any]:
    """Return studies as plain data; what is not finite is ``None``."""
    return {"schema": SCHEMA, "rigs": [_one(study) for study in studies]}


def _one(study: Study) -> dict[str, Any]:
    rig, settings = study.rig, study.experiments[0].settings
    return {
        "rig": rig.name,
        "motion": rig.motion.value,
        "true_model": rig.true_model,
        "named": list(study.named),
        "verdict": study.verdict,
        "seed": rig.seed,
        "settings": settings.model_dump(mode="json"),
        "motions": [
            {
                "bandwidth_Hz": one.bandwidth,
                "proportional": one.control.proportional,
                "derivative": one.control.derivative,
                "delay_s": one.control.delay,
                "encoder_step": one.encoder_step,
                "peak_velocity": one.reference.peak,
                "duration_s": one.reference.duration,
            }
            for one in study.experiments
        ],
        "models": {name: {"model": model.name, "parameters": model.parameters} for name, model in study.models.items()},
        "ways": [_way(way, study.way(NONE)) for way in study.ways],
    }


def _way(way: Way, none: Way) -> dict[str, Any]:
    share, least, most = way.over(none) if way.figures else (math.inf,) * 3
    return {
        "way": way.name,
        "model": way.model,
        "rms_error": _number(way.rms_error),
        "percent_of_none": _number(100 * share),
        "percent_of_none_range": [_number(100 * least), _number(100 * most)],
        "largest_error": _number(way.largest_error),
        "limit_cycle": way.limit_cycle,
        "each": [{k: v if isinstance(v, bool) else _number(v) for k, v in vars(one).items()} for one in way.figures],
        "message": way.message,
    }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def check_name(out: Path) -> None:
    """Refuse a file whose name says no format.

    Raises:
        InputError: for another suffix than .json or .csv.
    """
    if out.suffix not in SUFFIXES:
        raise InputError(f"cannot write '{out}': the name must end in {' or '.join(SUFFIXES)}")


def write(studies: Sequence[Study], out: Path) -> Path:
    """Write studies as JSON, or a row for each way of each rig as CSV; whole or not at all.

    Raises:
        InputError: for another suffix, or a folder that cannot be written.
    """
    check_name(out)
    data = document(studies)
    if out.suffix == ".json":
        return write_text(out, json.dumps(data, indent=2, ensure_ascii=False) + "\n")
    table = io.StringIO()
    fields = ["rig", "true_model", "way", "model", "rms_error", "percent_of_none", "largest_error", "limit_cycle"]
    writer = csv.DictWriter(table, [*fields, "message"], extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    for rig in data["rigs"]:
        writer.writerows({**rig, **way} for way in rig["ways"])
    return write_text(out, table.getvalue())
