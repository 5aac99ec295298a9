"""The model file: ``{"schema": "fricmodels/model/1", …}``, typed. Keys are only ever added to a schema."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from fricmodels.dimension import Motion
from fricmodels.documents import Finite

SCHEMA = "fricmodels/model/1"


class _Part(BaseModel):
    """Part of a model file. Keys that this version does not know are kept: a later one may have added them."""

    model_config = ConfigDict(extra="allow", frozen=True)


class StoredTerm(_Part):
    """A law or an effect: its name, its equation, and the distribution that brings it.

    Attributes:
        name: as in the model's name. kind: ``law`` or ``effect``.
        equation: in plain text. distribution, version: what must be installed to use it; empty where nothing brings it.
    """

    name: str
    kind: Literal["law", "effect"]
    equation: str = ""
    distribution: str = "fricmodels"
    version: str | None = None


class StoredParameter(_Part):
    """One coefficient.

    Attributes:
        value: in ``unit``. unit: SI unit for the motion of the drive. meaning: in words.
        standard_error: in ``unit``; none for what was given, and for what no error is known of.
        given: whether it was given, not estimated.
        identified: whether the recording determines it. reason: why not, in words.
        at_bound: ``lower`` or ``upper`` where the value is a bound, ``at least KEY`` where another parameter is it.
    """

    value: Finite
    unit: str
    meaning: str = ""
    standard_error: Finite | None = None
    given: bool = False
    identified: bool = True
    reason: str = ""
    at_bound: str = ""


class StoredCovariance(_Part):
    """Covariance of the estimated parameters: rows and columns in the order of ``keys``, products of their units."""

    keys: tuple[str, ...]
    values: tuple[tuple[Finite, ...], ...]

    @model_validator(mode="after")
    def _square(self) -> Self:
        count = len(self.keys)
        if len(self.values) != count or any(len(row) != count for row in self.values):
            raise ValueError(f"has {count} keys and needs {count} rows of {count} numbers")
        return self


class StoredRange(_Part):
    """What the recording covered of a channel: outside of it, the model is a guess."""

    least: Finite
    greatest: Finite
    unit: str


class StoredError(_Part):
    """RMS torque error in % of the RMS motor torque, and the window over which it is averaged.

    Attributes:
        percent, test_percent: on what was fitted, and on what was kept back.
        SI, test_SI: the same in N m or N. noise_floor_percent: what noise alone would leave.
        window_ms: the window; of the error per sample, the sampling interval.
    """

    window_ms: Finite
    percent: Finite
    SI: Finite
    test_percent: Finite | None = None
    test_SI: Finite | None = None
    noise_floor_percent: Finite | None = None


class StoredProvenance(_Part):
    """Where the numbers came from.

    Attributes:
        recording: name of the recording. files: names of its files. sha256: of the file's bytes.
        checksum: of the channels that were fitted. reader: what read the file.
        samples_fitted, samples_kept_back: how many. interval: sampling interval [s].
        estimator: what found the numbers. message: why the fit did not end well; empty where it did.
        findings: what the log check said.
        versions: of this package, what it computes with, and the plugins.
    """

    recording: str
    files: tuple[str, ...] = ()
    sha256: str | None = None
    checksum: str = ""
    reader: str | None = None
    samples_fitted: int = 0
    samples_kept_back: int = 0
    interval: Finite | None = None
    estimator: str = "weak form"
    message: str = ""
    findings: tuple[str, ...] = ()
    versions: dict[str, str] = Field(default_factory=dict)


class StoredController(_Part):
    """A controller through which the motion was simulated: how it was written, and what was found of it.

    Attributes:
        settings: as in its YAML file. distribution, version: what brings it, where a plugin does.
        parameters: those that were estimated, by symbol.
    """

    settings: dict[str, Any]
    distribution: str = "fricmodels"
    version: str | None = None
    parameters: dict[str, StoredParameter] = Field(default_factory=dict)


class ModelDocument(_Part):
    """A fitted model as it stands in a file.

    Attributes:
        model: name, as :meth:`fricmodels.model.Model.parse` reads it. terms: its law, then its effects.
        motion: rotary or linear.
        parameters: by key, the inertia (``J`` or ``M``) first.
        covariance: of what was estimated, where it is known.
        rest_width: speed below which the drive counts as at rest for the slope of a law [rad/s or m/s].
        range: what the recording covered, by channel.
        units: of further channels. runs: numbers of the runs.
        run_checksums: of the torque of each of them, where parameters belong to runs; others have none.
        error: how far off it is. provenance: where it came from.
        controller: through which it was fitted to the motion; none where the recorded torque drove it.
    """

    schema_: Literal["fricmodels/model/1"] = Field("fricmodels/model/1", alias="schema")
    model: str
    terms: tuple[StoredTerm, ...]
    motion: Motion
    parameters: dict[str, StoredParameter]
    covariance: StoredCovariance | None = None
    rest_width: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    range: dict[str, StoredRange] = Field(default_factory=dict)
    units: dict[str, str] = Field(default_factory=dict)
    runs: tuple[int, ...] = (0,)
    run_checksums: tuple[str, ...] = ()
    error: StoredError | None = None
    provenance: StoredProvenance
    controller: StoredController | None = None

    def to_json(self) -> str:
        """Return the file's text; equal documents have equal texts."""
        plain: dict[str, Any] = self.model_dump(mode="json", by_alias=True)
        return json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
