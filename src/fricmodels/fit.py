"""What an estimator returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
import pandas as pd

from fricmodels.arrays import Array
from fricmodels.display import Displayed


class Status(StrEnum):
    """How a fit ended."""

    OK = "ok"
    DIVERGED = "diverged"
    FAILED = "failed"
    TIMEOUT = "timeout"
    CRASHED = "crashed"


@dataclass(frozen=True, repr=False)
class Fit(Displayed):
    """Estimated parameters of a drive, in SI units.

    Attributes:
        model, estimator, dataset: names.
        parameters: value by key (``K_v``, ``cogging.a``, ``J``); the inertia is there whether given or estimated.
        covariance: of the estimated parameters, rows and columns in the order of :attr:`estimated`, in SI units.
        estimated: keys of the parameters that were estimated.
        status, message: how it ended, and why if not well.
        not_identified: keys of parameters that the recording does not determine, with the reason in words.
        no_interval: keys of estimated parameters without a standard error, with the reason in words; their rows and
            columns of the covariance are NaN.
        history: for sequential estimators, one row per (kept) sample: ``time`` and each parameter.
        seconds: duration of the fit.
        provenance: settings, versions, checksum of the recording.
    """

    model: str
    estimator: str
    dataset: str
    parameters: Mapping[str, float]
    covariance: Array
    estimated: tuple[str, ...]
    status: Status = Status.OK
    message: str = ""
    not_identified: Mapping[str, str] = field(default_factory=dict)
    no_interval: Mapping[str, str] = field(default_factory=dict)
    history: pd.DataFrame | None = None
    seconds: float = float("nan")
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each estimated parameter that has one."""
        spread = np.sqrt(np.clip(np.diag(self.covariance), 0.0, None))
        return {
            key: float(value) for key, value in zip(self.estimated, spread, strict=True) if key not in self.no_interval
        }

    @property
    def converged(self) -> bool:
        """Whether the estimator ended well; it says nothing of whether the parameters are identified."""
        return self.status is Status.OK

    @property
    def identified(self) -> bool:
        """Whether the recording determines every parameter."""
        return self.converged and not self.not_identified
