"""The tables of each kind of result, as DataFrames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import singledispatch
from typing import Any

import numpy as np
import pandas as pd

from fricmodels.arrays import rms
from fricmodels.diagnosis import Comparison, Diagnosis, Ladder
from fricmodels.diagnosis.diagnose import Finding
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.ladder import added
from fricmodels.diagnosis.remarks import remarks_on
from fricmodels.dimension import DIMENSIONLESS, FORCE, INERTIA
from fricmodels.export.columns import frame
from fricmodels.fit import Fit
from fricmodels.recording import CHANNELS, Recording
from fricmodels.results.diagnosis import DiagnosisDocument
from fricmodels.results.words import FOUND, NOT_FOUND, NOT_SEEN, SIZE, in_percent
from fricmodels.tournament import Leaderboard

Tables = dict[str, pd.DataFrame]

_OTHER_UNITS = {"current": "A", "temperature": "°C"}


@singledispatch
def tables(result: object) -> Tables:
    """Return the tables of a result by title, the one that sums it up first.

    Raises:
        TypeError: for what is no result.
    """
    raise TypeError(f"{type(result).__name__} has no tables")


@tables.register
def _(recording: Recording) -> Tables:
    rows = {
        name: {
            "unit": _OTHER_UNITS.get(name)
            or recording.units.get(name)
            or CHANNELS.get(name, DIMENSIONLESS).unit(recording.motion),
            "least": float(np.min(values)),
            "greatest": float(np.max(values)),
            "RMS": rms(values),
            "derived": name in recording.derived,
        }
        for name, values in recording.channels.items()
    }
    return {"Channels": _frame(rows, "channel")}


@tables.register
def _(fit: Fit) -> Tables:
    errors, remarks = fit.standard_errors, {**fit.no_interval, **fit.not_identified}
    rows = {
        key: {
            "value": value,
            "standard error": errors.get(key, float("nan")),
            "remark": remarks.get(key, "" if key in errors else "given"),
        }
        for key, value in fit.parameters.items()
    }
    return {"Parameters": _frame(rows, "parameter", ("value", "standard error", "remark"))}


@tables.register
def _(comparison: Comparison) -> Tables:
    drive, unit = comparison.drive, FORCE.unit(comparison.drive.motion)
    units = {p.key: p.declared.unit_for(drive.motion) for p in drive.parameters}
    units.setdefault(drive.inertia_key, INERTIA.unit(drive.motion))
    own, said = comparison.estimate.own_errors, remarks_on(comparison)
    parameters = {
        key: {
            "value": value,
            "standard error": own.get(key, float("nan")),
            "unit": units[key],
            "remark": said.get(key, "" if key in own else "given"),
        }
        for key, value in comparison.estimate.parameters.items()
    }
    error = {
        band.window_ms: {
            f"fit error [{unit}]": band.SI,
            f"test error [{unit}]": band.held_out_SI,
            "fit error [%]": band.percent,
            "noise alone, fit [%]": band.fit_noise_percent,
            "test error [%]": band.held_out_percent,
            "noise alone [%]": band.noise_floor_percent,
        }
        for band in comparison.errors.bands
    }
    where = {
        row.regime: {
            "share of squared error [%]": 100 * row.share_of_squared_error,
            "share of samples [%]": 100 * row.share_of_samples,
            "samples": row.samples,
            f"RMS error [{unit}]": row.rms_torque_error,
        }
        for row in comparison.where
    }
    return {
        "Parameters": _frame(parameters, "parameter"),
        "Torque error": _frame(error, "averaged over [ms]"),
        "Where it fails": _frame(where, "regime"),
    }


@tables.register
def _(diagnosis: Diagnosis) -> Tables:
    return _of_diagnosis(document(diagnosis), diagnosis.findings)


@tables.register
def _(ladder: Ladder) -> Tables:
    steps = {
        number: {
            "model": rung.model,
            "added": rung.added,
            "removed": rung.removed,
            "fit error [%]": rung.comparison.errors.percent,
            "test error [%]": rung.comparison.errors.held_out_percent,
        }
        for number, rung in enumerate(ladder.rungs)
    }
    estimates = [rung.comparison.estimate for rung in ladder.rungs]
    keys = dict.fromkeys(key for estimate in estimates for key in estimate.parameters)
    parameters = {
        key: {f"step {number}": estimate.parameters.get(key) for number, estimate in enumerate(estimates)}
        for key in keys
    }
    return {
        "The ladder": _frame(steps, "step"),
        "Parameters from step to step": _frame(parameters, "parameter").astype(float),
        **_of_diagnosis(document(ladder.first, ladder), added(ladder)),
    }


@tables.register
def _(board: Leaderboard) -> Tables:
    return {"Leaderboard": frame(board)}


def _of_diagnosis(data: DiagnosisDocument, findings: Sequence[Finding]) -> Tables:
    found = {
        effect.name: {
            "explains of the residual [%]": in_percent(effect.share_of_residual),
            "lowers it on other blocks [%]": in_percent(effect.held_out_gain),
            "p value, corrected": effect.p_value,
            "cannot be told from": ", ".join(effect.names[1:]),
            "equation": effect.equation,
        }
        for effect in data.effects
    }
    headings = ("explains of the residual [%]", "lowers it on other blocks [%]", "p value, corrected")
    sizes = {
        f"{finding.tested.name}.{p.symbol}": {
            "value": finding.tested.parameters[p.symbol],
            "unit": p.unit_for(data.motion),
            "meaning": p.meaning,
        }
        for finding in findings
        for p in finding.tested.effect.parameters
    }
    seen = {
        name: {"% of RMS torque": row.smallest_percent, f"RMS torque [{data.unit}]": row.smallest_torque}
        for name, row in data.seen.items()
    }
    blind = {name: {"why": reason} for name, reason in data.not_seen.items()}
    return {
        FOUND: _frame(found, "effect", headings),
        **({SIZE: _frame(sizes, "parameter")} if sizes else {}),
        **({NOT_FOUND: _frame(seen, "effect")} if seen else {}),
        **({NOT_SEEN: _frame(blind, "effect")} if blind else {}),
    }


def _frame(rows: Mapping[Any, Mapping[str, Any]], index: str, columns: Sequence[str] = ()) -> pd.DataFrame:
    table = pd.DataFrame.from_dict(dict(rows), orient="index") if rows else pd.DataFrame(columns=list(columns))
    table.index.name = index
    return table
