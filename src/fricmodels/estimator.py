"""What estimators are: from a drive and a recording to a fit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.fit import Fit
from fricmodels.recording import Recording


class EstimatorSettings(BaseModel):
    """Typed settings of an estimator; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Estimator(ABC):
    """Fits a drive to a recording.

    A subclass names itself, declares its ``Settings`` and writes :meth:`fit`. An estimator that cannot give an
    answer raises :class:`fricmodels.errors.EstimationError` or returns a fit whose status says so.
    """

    name: ClassVar[str]
    summary: ClassVar[str] = ""
    Settings: ClassVar[type[EstimatorSettings]] = EstimatorSettings
    carries_states: ClassVar[bool] = False
    """Whether it can fit terms with memory."""

    def __init__(self, settings: Mapping[str, Any] | EstimatorSettings | None = None) -> None:
        if isinstance(settings, BaseModel):
            settings = settings.model_dump()
        self.settings: Any = self.Settings.model_validate(dict(settings or {}))

    @abstractmethod
    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Estimate the drive's free parameters from the recording, in SI units."""


class SequentialEstimator(Estimator):
    """An estimator that takes one sample after the other and can run beside the drive."""

    @abstractmethod
    def start(self, drive: Drive, recording: Recording) -> OnlineFilter:
        """Return a filter at its initial state, scaled for drives that move like this recording."""


class OnlineFilter(ABC):
    """A sequential estimator at work: feed it samples, read its estimate. All values are SI."""

    @abstractmethod
    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take one sample (``time``, ``torque``, ``velocity`` and what the model needs); return the parameters."""

    @property
    @abstractmethod
    def parameters(self) -> dict[str, float]:
        """The present estimate."""

    @property
    @abstractmethod
    def covariance(self) -> Array:
        """The filter's own covariance of the estimated parameters; overconfident when the law is wrong."""
