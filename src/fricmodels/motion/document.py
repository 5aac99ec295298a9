"""What the simulated motion of models says, in sentences and as ``motion.json``."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fricmodels.dimension import DISPLACEMENT, Motion
from fricmodels.files import write_text
from fricmodels.motion.choose import Judged
from fricmodels.motion.errors import MotionErrors
from fricmodels.results.part import finite

SCHEMA = "fricmodels/motion/1"


def how(horizon: int | None, interval: float, *, closed: bool = False, held: bool = False) -> str:
    """Say how a motion was simulated."""
    what = "through the controller, from the reference" if closed else "from the measured torque"
    what += ", held between samples" if held else ""
    if horizon is None:
        return f"{what}, each piece in one go from its measured state"
    return f"{what}, anew from the measured state every {horizon} samples ({horizon * interval:.3g} s)"


def motion_words(errors: MotionErrors, motion: Motion) -> str:
    """Say how far off a simulated motion is."""
    unit = DISPLACEMENT.unit(motion)
    if not math.isfinite(errors.velocity):
        return "the simulation ended before the recording did"
    if not math.isfinite(errors.position):
        return f"RMS velocity error {errors.velocity:.3g} {unit}/s"
    text = (
        f"RMS position error {errors.position:.3g} {unit} ({errors.position_percent:.3g} % of how far it moves), "
        f"velocity {errors.velocity:.3g} {unit}/s"
    )
    if abs(errors.drift) > errors.position / 2:
        text += (
            f"; mostly a drift, of {errors.drift:+.3g} {unit} on average: a force that is wrong by a constant adds up"
        )
    return text


def motion_document(found: Sequence[Judged], horizon: int | None, motion: Motion, *, closed: bool) -> dict[str, Any]:
    """Return the document: one row for each model, in their order."""
    rows = []
    for each in found:
        fit = each.fit
        rows.append(
            {
                "model": each.rung.name,
                "by_torque": _finite(each.by_torque.as_dict()),
                "fitted": None if fit is None else _finite(fit.errors.as_dict()),
                "test": None if each.test is None else _finite(each.test.as_dict()),
                "parameters": None if fit is None else _finite(dict(fit.parameters)),
                "standard_errors": None if fit is None else _finite(fit.standard_errors),
                "behind_best": finite(each.behind[0]),
                "behind_best_standard_error": finite(each.behind[1]),
                "chosen": each.chosen,
            }
        )
    return {
        "schema": SCHEMA,
        "unit": DISPLACEMENT.unit(motion),
        "horizon": horizon,
        "loop": "closed" if closed else "open",
        "between_samples": found[0].kept.between_samples,
        "rows": rows,
    }


def write_motion(document: dict[str, Any], directory: Path) -> Path:
    """Write ``motion.json``, whole or not at all."""
    return write_text(directory / "motion.json", json.dumps(document, indent=2, allow_nan=False) + "\n")


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    return {key: finite(value) for key, value in values.items()}
