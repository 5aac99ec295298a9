"""From a result to a model to keep: of a comparison, a ladder, a diagnosis, or an estimator's fit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

import numpy as np

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.drive import Drive, DriveParameter, rest_width
from fricmodels.errors import InputError
from fricmodels.fit import Fit
from fricmodels.fitted_runs import run_checksums
from fricmodels.parameter import Parameter
from fricmodels.recording import CHANNELS, RATE, Recording
from fricmodels.results.part import finite
from fricmodels.results.words import is_combined
from fricmodels.saved.document import (
    ModelDocument,
    StoredCovariance,
    StoredError,
    StoredParameter,
    StoredProvenance,
    StoredRange,
    StoredTerm,
)
from fricmodels.saved.fitted import FittedModel

_AT_BOUND = 1e-9


def document_of(
    drive: Drive,
    parameters: Mapping[str, float],
    standard_errors: Mapping[str, float],
    recording: Recording,
    *,
    not_identified: Mapping[str, str],
    covariance: tuple[tuple[str, ...], np.ndarray[Any, Any]] | None = None,
    kept_back: Recording | None = None,
    error: StoredError | None = None,
    estimator: str = "weak form",
    message: str = "",
) -> ModelDocument:
    """Return the document of a fitted model.

    Args:
        drive: the model as it is for the recording.
        parameters, standard_errors: by key, SI; the inertia among the parameters.
        recording: what was fitted, prepared. kept_back: what was not.
        not_identified: key → reason.
        covariance: keys and matrix, where it is known.
        error: how far off the model is.
        estimator: what found the numbers. message: why the fit did not end well.

    Raises:
        InputError: where a parameter is no number.
    """
    channels = {signal.removeprefix(RATE) for signal in drive.model.signals}
    whole = [recording] if kept_back is None else [recording, kept_back]
    listed = {p.key: p for p in drive.model_parameters}
    declared = Parameter(drive.inertia_key, "kg m^2", lower=0.0, meaning="inertia")
    stored = {}
    for key in (drive.inertia_key, *listed):
        value = float(parameters.get(key, math.nan))
        if not math.isfinite(value):
            raise InputError(f"'{drive.model.name}' has no value for '{key}': this fit cannot be kept")
        own = listed[key].declared if key in listed else declared
        given = key == drive.inertia_key and drive.inertia is not None
        spread, reason = standard_errors.get(key), str(not_identified.get(key, ""))
        # 0 of what changes nothing: it is not known, not certain.
        unknown = given or is_combined(reason) or (key in not_identified and not spread)
        stored[key] = StoredParameter(
            value=value,
            unit=own.unit_for(drive.motion),
            meaning=own.meaning,
            standard_error=None if unknown else finite(spread),
            given=given,
            identified=key not in not_identified,
            reason=reason,
            at_bound="" if given else _at_bound(value, own, listed.get(key), parameters),
        )
    checksums = _checksums_of_runs(drive, recording)
    return ModelDocument(
        schema="fricmodels/model/1",
        model=drive.model.name,
        terms=_terms(drive),
        motion=drive.motion,
        parameters=stored,
        covariance=_covariance(covariance),
        rest_width=rest_width(recording),
        range=_ranges(whole, drive.motion),
        units={name: unit for name, unit in recording.units.items() if name in channels and unit},
        runs=tuple(checksums) or tuple(np.unique(recording.signal("run")).astype(int).tolist()),
        run_checksums=tuple(checksums.values()),
        error=error,
        provenance=_provenance(recording, kept_back, estimator, message),
    )


def keep(result: object) -> FittedModel:
    """Return the model of a result, to call, to save and to export.

    Args:
        result: what :func:`fricmodels.compare`, :func:`fricmodels.diagnose` or :func:`fricmodels.improve` returned: of
            a ladder its last rung; one rung of it works too.

    Raises:
        InputError: for anything else.
    """
    if isinstance(result, FittedModel):
        return result
    for step in ("rungs", "comparison"):  # a ladder has rungs, a rung and a diagnosis have a comparison
        if hasattr(result, step):
            inner = getattr(result, step)
            return keep(inner[-1] if step == "rungs" else inner)
    if not all(hasattr(result, name) for name in ("drive", "estimate", "train", "errors")):
        raise InputError(
            f"what is given ({type(result).__name__}) cannot be kept; keep what compare, diagnose or improve returned, "
            f"and a fit of an estimator with keep_fit(fit, drive, recording)"
        )
    comparison: Any = result
    found, line = comparison.estimate, comparison.errors.headline
    keys = tuple(found.standard_errors)
    return FittedModel(
        model=comparison.drive.model,
        document=document_of(
            comparison.drive,
            found.parameters,
            found.standard_errors,
            comparison.train,
            not_identified=found.not_identified,
            covariance=None if found.covariance is None else (keys, found.covariance),
            kept_back=comparison.test,
            message=found.message,
            error=StoredError(
                window_ms=line.window_ms,
                percent=line.percent,
                SI=line.SI,
                test_percent=finite(line.held_out_percent),
                test_SI=finite(line.held_out_SI),
                noise_floor_percent=finite(line.noise_floor_percent),
            ),
        ),
    )


def keep_fit(fit: Fit, drive: Drive, recording: Recording) -> FittedModel:
    """Return the model of an estimator's fit.

    Args:
        fit: what an estimator returned. drive, recording: what it was given.

    Raises:
        InputError: where the fit did not end well.
    """
    if not fit.converged:
        raise InputError(f"the fit of '{fit.model}' by {fit.estimator} is {fit.status}: {fit.message}")
    drive = Drive(drive.model.on(recording), drive.inertia, drive.motion)
    return FittedModel(
        document_of(
            drive,
            fit.parameters,
            fit.standard_errors,
            recording,
            not_identified=fit.not_identified,
            covariance=(fit.estimated, fit.covariance),
            estimator=fit.estimator,
        )
    )


def keep_row(row: Mapping[str, Any], recording: Recording, inertia: float | None = None) -> FittedModel:
    """Return the model of a row of a leaderboard.

    Args:
        row: of :attr:`fricmodels.tournament.leaderboard.Leaderboard.rows`, or of ``leaderboard.json``.
        recording: what its parameters were fitted to. inertia: where it was given, not estimated.

    Raises:
        InputError: where the row has no result.
    """
    if row.get("status") != "ok":
        raise InputError(f"the row of '{row.get('model')}' by {row.get('estimator')} is {row.get('status')}")
    from fricmodels.model import Model

    drive = Drive(Model.parse(row["model"]).on(recording), inertia, recording.motion)
    figures = {key: row.get(f"{key}rms_torque_error_percent") for key in ("", "held_out_")}
    size = 1e-2 * recording.rms_torque
    error = None
    if row.get("rms_torque_error_band_ms") is not None and figures[""] is not None:
        error = StoredError(
            window_ms=row["rms_torque_error_band_ms"],
            percent=figures[""],
            SI=figures[""] * size,
            test_percent=finite(figures["held_out_"]),
        )
    found = document_of(
        drive,
        row["parameters"],
        row.get("standard_errors") or {},
        recording,
        not_identified=row.get("not_identified") or {},
        error=error,
        estimator=str(row.get("estimator")),
    )
    return FittedModel(found)


def _at_bound(value: float, own: Parameter, p: DriveParameter | None, values: Mapping[str, float]) -> str:
    def close(bound: float) -> bool:
        return (
            not own.constant and math.isfinite(bound) and abs(value - bound) <= _AT_BOUND * max(abs(bound), abs(value))
        )

    if p is not None and p.at_least is not None and close(values[p.at_least]):
        return f"at least {p.at_least}"
    return "lower" if close(own.lower) else "upper" if close(own.upper) else ""


def _terms(drive: Drive) -> tuple[StoredTerm, ...]:
    registered, versions = plugins.load(), plugins.versions()
    terms = []
    for term in drive.model.terms:
        kind, registry = ("law", registered.laws) if term is drive.model.law else ("effect", registered.effects)
        name = term.name.partition("(")[0]
        known = name in registry  # one of a notebook is not, and nothing else will find it
        owner = registry.entry(name).distribution if known else ""
        terms.append(
            StoredTerm(
                name=term.name,
                kind="law" if kind == "law" else "effect",
                equation=term.formula,
                distribution=owner,
                version=versions.get(owner),
            )
        )
    return tuple(terms)


def _checksums_of_runs(drive: Drive, recording: Recording) -> dict[int, str]:
    """Return the checksum of each run that parameters are of, by its number; those of the file of a held model."""
    fitted = [effect.fitted_runs for effect in drive.model.effects if effect.fitted_runs is not None]
    held = drive.model.known if drive.model.known.fixed else None
    known = run_checksums(recording) if held is None else {number: own for own, number in (held.runs or {}).items()}
    return {run: known.get(run, "") for run in sorted(frozenset().union(*fitted))} if fitted else {}


def _covariance(given: tuple[tuple[str, ...], np.ndarray[Any, Any]] | None) -> StoredCovariance | None:
    if given is None or not np.all(np.isfinite(given[1])):
        return None
    return StoredCovariance(keys=given[0], values=tuple(tuple(row) for row in np.asarray(given[1]).tolist()))


def _ranges(parts: list[Recording], motion: Motion) -> dict[str, StoredRange]:
    found = {}
    for name in parts[0].channels:
        values = np.concatenate([part[name] for part in parts if name in part])
        values = values[np.isfinite(values)]
        if len(values):
            unit = parts[0].units.get(name, "") if name not in CHANNELS else CHANNELS[name].unit(motion)
            unit = {"temperature": "degC", "current": "A"}.get(name, unit)
            found[name] = StoredRange(least=float(values.min()), greatest=float(values.max()), unit=unit)
    return found


def _provenance(recording: Recording, kept_back: Recording | None, estimator: str, message: str) -> StoredProvenance:
    known = recording.provenance
    files = list(known.get("files") or ([known["source"]] if known.get("source") else []))
    return StoredProvenance(
        recording=recording.name,
        files=tuple(PurePath(str(file)).name for file in files),
        sha256=known.get("sha256"),
        checksum=recording.checksum,
        reader=known.get("reader"),
        samples_fitted=len(recording),
        samples_kept_back=0 if kept_back is None else len(kept_back),
        interval=finite(recording.interval),
        estimator=estimator,
        message=message,
        findings=tuple(str(one.get("text", one)) for one in known.get("findings", ())),
        versions=plugins.versions(),
    )
