"""What an estimator returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array, deviations
from fricmodels.display import Displayed
from fricmodels.results.history import Course, ParameterHistory

if TYPE_CHECKING:
    import pandas as pd

HISTORY_POINTS = 120
"""Estimates of a parameter that a thinned history keeps."""


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
        spread = deviations(self.covariance)
        return {
            key: float(value) for key, value in zip(self.estimated, spread, strict=True) if key not in self.no_interval
        }

    def parameter_history(
        self, units: Mapping[str, str], truth: Mapping[str, float] | None = None, points: int = HISTORY_POINTS
    ) -> ParameterHistory | None:
        """Return how the estimates came about, as plain data; ``None`` where the estimator keeps no history.

        Half of the points are spread evenly, half are the denser the earlier, where estimates change most.

        Args:
            units: unit of each parameter, by key.
            truth: values by key, where they are known.
            points: at most so many estimates of each parameter.
        """
        if self.history is None or not len(self.history):
            return None
        last = len(self.history) - 1
        even = np.linspace(0, last, points // 2)
        early = np.geomspace(1, last + 1, points - points // 2) - 1
        place = np.unique(np.concatenate([even, early]).round().astype(np.int64))
        columns = {name: _short(self.history[name].to_numpy(dtype=float)[place]) for name in self.history}
        known, errors = truth or {}, self.standard_errors
        courses = {
            key: Course(
                unit=units.get(key, "1"),
                estimates=columns[key],
                deviations=columns.get(f"sd({key})"),
                final=self.parameters.get(key),
                standard_error=errors.get(key),
                truth=known.get(key),
            )
            for key in self.estimated
            if key in columns
        }
        return ParameterHistory(
            model=self.model,
            estimator=self.estimator,
            dataset=self.dataset,
            kept=last + 1,
            time=columns["time"],
            courses=courses,
        )

    @property
    def converged(self) -> bool:
        """Whether the estimator ended well; it says nothing of whether the parameters are identified."""
        return self.status is Status.OK

    @property
    def identified(self) -> bool:
        """Whether the recording determines every parameter."""
        return self.converged and not self.not_identified


def _short(values: Array) -> tuple[float | None, ...]:
    """Return numbers in seven figures, as a picture needs them; ``None`` for what is not finite."""
    return tuple(float(f"{value:.7g}") if np.isfinite(value) else None for value in values.tolist())
