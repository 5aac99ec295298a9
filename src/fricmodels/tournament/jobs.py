"""One job of a tournament: fit one model to one recording with one estimator, and score it."""

from __future__ import annotations

import json
import math
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.drive import Drive, rest_width
from fricmodels.errors import FricmodelsError, InputError
from fricmodels.estimator import Estimator
from fricmodels.fit import Fit, Status
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.results.part import finite
from fricmodels.tournament.sources import Loaded, Source, load
from fricmodels.tournament.told import as_keys

Row = dict[str, Any]
Group = tuple[str, str, str]
"""Model, estimator and its settings: jobs that share compiled code."""
HISTORY = "history"
"""What a kept row has beside what stands in a leaderboard: how the parameters of a sequential estimator came about."""


def as_shown(row: Mapping[str, Any]) -> Row:
    """Return a kept row as it stands in a leaderboard."""
    return {name: value for name, value in row.items() if name != HISTORY}


@dataclass(frozen=True)
class Job:
    """What one worker does at a time; all plain values, so that it can be sent anywhere.

    Attributes:
        key: hash of all that decides the result, the code included; equal keys, equal results.
        source: the recording and what is known of its drive.
        model, estimator: by name.
        title: what the estimator is called in the leaderboard.
        settings: of the estimator, as JSON.
        measure: what the score's percentages are of.
        simulate: whether the simulated velocity is scored.
        decimate: score every so many-th sample.
        seed: of the estimator.
        horizon, controller: of a simulated position; the controller as JSON, empty where the recorded torque drives.
    """

    key: str
    source: Source
    model: str
    estimator: str
    title: str
    settings: str
    measure: str
    simulate: bool
    decimate: int
    seed: int = field(default=0)
    horizon: int | None = field(default=None)
    controller: str = field(default="")

    @property
    def group(self) -> Group:
        """Jobs of one group share compiled code and run on one worker where possible."""
        return (self.model, self.estimator, self.settings)

    def row(self, status: Status, message: str = "", seconds: float = math.nan) -> Row:
        """Return the row of the leaderboard for a job that gave no fit."""
        return {
            "model": self.model,
            "estimator": self.title,
            "dataset": self.source.dataset,
            "tags": dict(self.source.tags),
            "rms_torque_error_percent": None,
            "held_out_rms_torque_error_percent": None,
            "rms_torque_error_band_ms": None,
            "rms_torque_error_bands": [],
            "parameters": {},
            "standard_errors": {},
            "true_parameters": self.source.true_parameters,
            "seconds": None if math.isnan(seconds) else seconds,
            "status": status.value,
            "message": " ".join(message.split()),
            "not_identified": {},
            "no_interval": {},
            "settings": json.loads(self.settings),
            "key": self.key,
        }


@lru_cache(maxsize=64)
def _drive(model: str, inertia: float | None, motion: Motion) -> Drive:
    return Drive(Model.parse(model), inertia, motion)


@lru_cache(maxsize=256)
def check_plugins(model: str) -> None:
    """Refuse a term of a plugin whose torque cannot be evaluated, or is not true in the units that it declares.

    Estimators scale by these units: one that is wrong does not fail, it gives other numbers.

    Raises:
        FricmodelsError: saying what to change, as the exam does.
    """
    from fricmodels.testing.faults import Fault
    from fricmodels.testing.subject import subject
    from fricmodels.testing.term_checks import check_finite
    from fricmodels.testing.units import check_units

    registered = plugins.load()
    parsed = Model.parse(model)
    for term in parsed.terms:
        registry = registered.laws if term is parsed.law else registered.effects
        if registry.entry(term.name).distribution == "fricmodels":
            continue
        try:
            made = subject(type(term))
            try:
                check_units(made)
            except Fault:
                check_finite(made)  # what is no number is never the same in other units
                raise
        except Fault as fault:
            raise FricmodelsError(f"'{term.name}': {fault}") from None


def execute(job: Job) -> Row:
    """Do one job and return its row. An estimator that fails gives a row that says so; it never raises for that."""
    begin = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        try:
            row = _fit_and_score(job)
        except FricmodelsError as error:
            row = job.row(Status.FAILED, as_keys(str(error)), time.perf_counter() - begin)
        except (Exception, SystemExit) as error:
            row = job.row(Status.FAILED, f"{type(error).__name__}: {error}", time.perf_counter() - begin)
    if caught and not row["message"]:
        row["message"] = f"warned: {' '.join(str(caught[0].message).split())}"
    return row


def _fit_and_score(job: Job) -> Row:
    from fricmodels.score import score

    check_plugins(job.model)
    loaded = load(job.source)
    drive = _drive(job.model, job.source.inertia, loaded.train.motion)
    model = drive.model.on(loaded.train)
    if model is not drive.model:
        drive = Drive(model, drive.inertia, drive.motion)
    estimator: Estimator = plugins.load().estimators[job.estimator](json.loads(job.settings))
    begin = time.perf_counter()
    fit = estimator.fit(drive, loaded.train, seed=job.seed)
    row = job.row(fit.status, fit.message, time.perf_counter() - begin)
    _describe(row, fit)
    if loaded.true_parameters is not None:
        row["true_parameters"] = dict(loaded.true_parameters)
    history = fit.parameter_history(drive.units, row["true_parameters"])
    if history is not None:
        row[HISTORY] = history.model_dump(mode="json")
    if fit.status is not Status.OK:
        return row
    figures = score(
        drive,
        fit,
        loaded.prepared_train,
        loaded.prepared_test,
        measure="paper" if job.measure == "paper" else "torque",
        simulate=job.simulate and job.measure != "position",
        decimate=job.decimate,
    )
    row.update(_number(figures.as_dict()))
    if job.measure == "tracking":
        row.update(_number(_tracked(job.source, drive, fit, loaded.train)))
    decisive, what = "rms_torque_error" if loaded.prepared_test is None else "held_out_rms_torque_error", "torque error"
    if job.measure == "position":
        row.update(_number(_motion(job, drive, fit, loaded)))
        decisive, what = "simulated_position_error", "simulated motion"
    if row[decisive] is None:
        row["status"] = Status.DIVERGED.value
        row["message"] = f"the {what} of this fit is not a finite number"
    return row


def _tracked(source: Source, drive: Drive, fit: Fit, recording: Recording) -> dict[str, float]:
    """Return what the fit is worth to the controller of its rig."""
    from fricmodels.rig.file import load_rig
    from fricmodels.tracking.scoring import tracking_errors

    rig = load_rig(source.values["file"]).model_copy(update={"seed": source.values["seed"]})
    return tracking_errors(rig, drive, fit.parameters, rest_width(recording))


def _motion(job: Job, drive: Drive, fit: Fit, loaded: Loaded) -> Row:
    """Return the errors of the simulated motion, on what was kept back where there is such a part."""
    from fricmodels.motion import (
        Simulator,
        check_controller,
        motion_errors,
        stored_controller,
        torque_between_samples,
    )

    scored = loaded.prepared_test if loaded.prepared_test is not None else loaded.prepared_train
    if not scored.measures("position"):
        raise InputError(f"score: position needs the position, which recording '{scored.name}' does not have")
    loop = None
    if job.controller:
        controller = stored_controller(json.loads(job.controller))
        check_controller(controller, frozenset(scored.channels), scored.name)
        loop = controller.loop()
    between = torque_between_samples(drive, fit.parameters, loaded.prepared_train, loop=loop)
    simulator = Simulator(drive, scored, loop=loop, horizon=job.horizon, between_samples=between)
    errors = motion_errors(simulator, fit.parameters)
    return {
        "simulated_position_error": errors.position,
        "simulated_position_error_percent": errors.position_percent,
        "simulated_position_error_mean_absolute": errors.position_mean_absolute,
        "simulated_velocity_error": errors.velocity,
        "simulated_velocity_error_percent": errors.velocity_percent,
        "simulated_horizon": job.horizon,
        "simulated_between_samples": between,
    }


def _describe(row: Row, fit: Fit) -> None:
    row["parameters"] = {key: _number(value) for key, value in fit.parameters.items()}
    row["standard_errors"] = {key: _number(value) for key, value in fit.standard_errors.items()}
    row["not_identified"] = dict(fit.not_identified)
    row["no_interval"] = dict(fit.no_interval)


def _number(value: Any) -> Any:
    """Return plain numbers; what is not finite becomes ``None``, which JSON can hold."""
    if isinstance(value, dict):
        return {key: _number(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_number(item) for item in value]
    if isinstance(value, str | bool) or value is None:
        return value
    if isinstance(value, int | np.integer):
        return int(value)
    return finite(float(value))
