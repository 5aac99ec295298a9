"""What estimators are: from a drive and a recording to a fit."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError, InputError
from fricmodels.fit import Fit, Status
from fricmodels.interval import about
from fricmodels.parameter import outside_bounds
from fricmodels.recording import Recording
from fricmodels.signals.coasting import coasting
from fricmodels.signals.integrated import with_integrated_position

if TYPE_CHECKING:
    import pandas as pd

_LEAST = 20


class EstimatorSettings(BaseModel):
    """Typed settings of an estimator; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


@dataclass(frozen=True)
class Solution:
    """What :meth:`Estimator.solve` finds, in SI units.

    Attributes:
        parameters: estimated values by key; an inertia that is given need not be there.
        covariance: of the estimated parameters, in the order of :attr:`estimated`; ``None`` where the estimator does
            not know how far it is off: the distance to an unbiased fit then says it, see :mod:`fricmodels.interval`.
        estimated: keys of the parameters that were estimated; all of ``drive.keys`` by default.
        no_interval: key → reason, of parameters of which it is known that no interval about them means anything.
        status, message, not_identified, history: as in :class:`fricmodels.fit.Fit`.
        notes: what the provenance says besides settings, recording and versions.
    """

    parameters: Mapping[str, float] = field(default_factory=dict)
    covariance: Array | None = None
    estimated: tuple[str, ...] | None = None
    status: Status = Status.OK
    message: str = ""
    no_interval: Mapping[str, str] = field(default_factory=dict)
    not_identified: Mapping[str, str] = field(default_factory=dict)
    history: pd.DataFrame | None = None
    notes: Mapping[str, Any] = field(default_factory=dict)


class Estimator(ABC):
    """Fits a drive to a recording.

    A subclass names itself, declares its ``Settings`` and writes :meth:`solve`; names, time, provenance and, where it
    has none, the covariance are added to what that returns.
    """

    name: ClassVar[str]
    summary: ClassVar[str] = ""
    Settings: ClassVar[type[EstimatorSettings]] = EstimatorSettings
    carries_states: ClassVar[bool] = False
    """Whether it can fit terms with memory."""
    exam: ClassVar[Mapping[str, Any]] = {}
    """What its exam needs beside it, such as ``{"tolerance": 0.05}``; see :class:`fricmodels.testing.EstimatorExam`."""

    def __init__(self, settings: Mapping[str, Any] | EstimatorSettings | None = None) -> None:
        if isinstance(settings, BaseModel):
            settings = settings.model_dump()
        self.settings: Any = self.Settings.model_validate(dict(settings or {}))

    @abstractmethod
    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        """Estimate the drive's free parameters from the usable samples of a recording, see :func:`usable`.

        Raises:
            EstimationError: where no answer can be given.
        """

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Estimate the drive's free parameters from the recording, in SI units; see :meth:`solve`."""
        began = time.perf_counter()
        if "position" in drive.model.required:
            recording = with_integrated_position(recording)
        kept = usable(drive, recording)
        found = self.solve(drive, kept, seed)
        keys = drive.keys if found.estimated is None else found.estimated
        given = {} if drive.inertia is None else {drive.inertia_key: drive.inertia}
        parameters = {**given, **dict.fromkeys(drive.keys, float("nan")), **found.parameters}
        covariance, no_interval, far = found.covariance, dict[str, str](), dict[str, str]()
        if found.status is not Status.OK:
            covariance = np.full((len(keys), len(keys)), np.nan)
        elif covariance is None:
            compared = about(drive, kept, parameters, keys)
            covariance, no_interval, far = compared.covariance, dict(compared.reasons), dict(compared.far)
        silent = [key for key, own in zip(keys, np.diag(covariance), strict=True) if own == 0.0]
        unknown = {key: found.not_identified[key] for key in silent if key in found.not_identified}
        no_interval = {**no_interval, **unknown, **found.no_interval}
        without = np.array([key in no_interval for key in keys], dtype=bool)
        covariance = np.where(without | without[:, None], np.nan, covariance)
        doubtful = _may_be_zero(drive, parameters, covariance) if keys == drive.keys else {}
        constant = {p.key for p in drive.model.parameters if p.declared.constant}
        free = [i for i, key in enumerate(keys) if key not in constant]
        keys, covariance = tuple(keys[i] for i in free), covariance[np.ix_(free, free)]
        no_interval = {key: reason for key, reason in no_interval.items() if key in keys}
        declared = {p.key: p.declared for p in drive.parameters}
        outside = outside_bounds(declared, parameters) if found.status is Status.OK else {}
        return Fit(
            model=drive.model.name,
            estimator=self.name,
            dataset=recording.name,
            parameters=parameters,
            covariance=covariance,
            estimated=keys,
            status=found.status,
            message=found.message,
            not_identified={**doubtful, **far, **outside, **found.not_identified},
            no_interval=no_interval,
            history=found.history,
            seconds=time.perf_counter() - began,
            provenance={
                "settings": self.settings.model_dump(mode="json"),
                "recording": recording.checksum,
                "versions": dict(_versions()),
                **found.notes,
            },
        )


class SequentialEstimator(Estimator):
    """An estimator that takes one sample after the other and can run beside the drive."""

    @abstractmethod
    def start(self, drive: Drive, recording: Recording) -> OnlineFilter:
        """Return a filter at its initial state, scaled for drives that move like this recording."""

    def resume(self, state: Mapping[str, Any]) -> OnlineFilter:
        """Return a filter that goes on where one was saved, to the last bit; no recording is needed.

        Args:
            state: what :attr:`OnlineFilter.state` gave, perhaps through JSON.

        Raises:
            InputError: where the state is of another estimator, or its model is not as it was.
            EstimationError: where this estimator cannot.
        """
        raise EstimationError(f"'{self.name}' cannot go on from a saved state; start it from a recording")


class OnlineFilter(ABC):
    """A sequential estimator at work: feed it samples, read its estimate. All values are SI."""

    @abstractmethod
    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take one sample (``time``, ``torque``, ``velocity`` and what the model needs); return the parameters."""

    @property
    def state(self) -> dict[str, Any]:
        """All that it knows and remembers, as plain data: ``json.dumps`` keeps every number to the last bit.

        Raises:
            EstimationError: where this filter cannot be saved.
        """
        raise EstimationError(f"a {type(self).__name__} cannot be saved")

    @property
    @abstractmethod
    def parameters(self) -> dict[str, float]:
        """The present estimate."""

    @property
    @abstractmethod
    def covariance(self) -> Array:
        """The filter's own covariance of the estimated parameters; overconfident when the law is wrong."""


def _may_be_zero(drive: Drive, parameters: Mapping[str, float], covariance: Array) -> dict[str, str]:
    """Return key → reason of each parameter whose 95 % interval contains zero, whichever estimator it comes from."""
    from fricmodels.weakform.identification import not_identified

    values = np.array([parameters[key] for key in drive.keys])
    known = np.where(np.isfinite(covariance), covariance, 0.0)
    anywhere = np.full(len(values), -np.inf), np.full(len(values), np.inf)
    found = not_identified(drive, values, known, np.zeros((len(values), 0)), anywhere)
    with_interval = [key for key, own in zip(drive.keys, np.diag(known), strict=True) if own > 0.0]
    return {key: found[key] for key in with_interval if key in found}


@cache
def _versions() -> Mapping[str, str]:
    return {name: version(name) for name in ("casadi", "llvmlite", "numba", "filterpy")}


def usable(drive: Drive, recording: Recording) -> Recording:
    """Return the samples at which everything that the drive needs, and that cannot be derived, is finite.

    Raises:
        InputError: when a channel is missing.
        EstimationError: when fewer than 20 samples are left, or the drive does not move, or coasts without
            a known inertia.
    """
    derived = {"acceleration"}
    if "position" in recording and "velocity" not in recording:
        derived.add("velocity")
    recording.require(drive.model.required - derived, drive.model.name)
    signals = {"motor_torque", "time", "velocity", *drive.model.needs} - derived
    finite = np.all([np.isfinite(recording.signal(name)) for name in signals], axis=0)
    kept = recording if finite.all() else recording.select(finite)
    where = f"recording '{recording.name}'"
    if len(kept) < _LEAST:
        raise EstimationError(f"{where} has {len(kept)} usable samples; at least {_LEAST} are needed")
    if "velocity" in kept and not np.ptp(kept.velocity) > 0:
        raise EstimationError(f"{where} has a constant velocity; friction and inertia need a motion that changes")
    try:
        return coasting(kept, drive.inertia)
    except InputError as error:
        raise EstimationError(str(error)) from None
