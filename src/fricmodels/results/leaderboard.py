"""``leaderboard.json``: the ranked fits of a tournament, typed.

Errors in percent are RMS torque errors, of the RMS motor torque, or of its amplitude with ``score: paper``.
"""

from __future__ import annotations

from typing import Any, Final, Literal

from pydantic import Field

from fricmodels.results.comparison import Band
from fricmodels.results.part import Number, Numbers, Part, ResultDocument

SCHEMA: Final = "fricmodels/leaderboard/1"


class LeaderboardRow(Part):
    """One fit: a model, by an estimator, to a recording."""

    rank: int
    """From 1; fits without a result come last."""
    model: str
    """``LAW+EFFECT+…``."""
    estimator: str
    """Its title in the configuration."""
    dataset: str
    """Name of the recording."""
    tags: dict[str, str | bool | int | float | None]
    """What tells recordings of one name apart, such as ``noise_percent`` and ``seed``."""
    rms_torque_error_percent: Number
    """Error of what was fitted [%]."""
    held_out_rms_torque_error_percent: Number
    """Test error, on what was kept back [%]; null without such a part."""
    rms_torque_error_band_ms: Number = None
    """Window over which these are averaged [ms]; null where they are not."""
    rms_torque_error_bands: tuple[Band, ...] = ()
    """The error over every window, that per sample first."""
    parameters: Numbers
    """By key, each in its SI unit."""
    standard_errors: Numbers
    """By key, in the units of the parameters; none of what was given."""
    true_parameters: Numbers | None
    """The truth of simulated recordings, by key, each in its SI unit."""
    seconds: Number
    """That the fit took [s]."""
    status: Literal["ok", "diverged", "failed", "timeout", "crashed"]
    """How the fit ended."""
    message: str
    """Why there is no result, or what was the matter; empty where all is well."""
    not_identified: dict[str, str] = Field(default_factory=dict)
    """Parameters that the recording does not determine, each with the reason."""
    no_interval: dict[str, str] = Field(default_factory=dict)
    """Parameters without a standard error, each with the reason."""
    settings: dict[str, Any] = Field(default_factory=dict)
    """Of the estimator."""
    key: str = ""
    """Hash of all that decides the result."""
    rms_torque_error: Number = None
    """Error of what was fitted [N m or N]."""
    held_out_rms_torque_error: Number = None
    """Test error [N m or N]."""
    simulated_velocity_error: Number = None
    """RMS of recorded minus simulated velocity [rad/s or m/s]; null where nothing was simulated."""
    simulated_velocity_error_percent: Number = None
    """The same [% of the RMS velocity]."""
    aic: Number = None
    """Akaike's criterion of the torque error on what was fitted [1]."""
    bic: Number = None
    """Bayesian criterion of the torque error on what was fitted [1]."""
    effective_samples: Number = None
    """How many independent samples the torque error is worth."""
    samples: int | None = None
    """How many were fitted."""
    held_out_samples: int | None = None
    """How many were kept back."""
    measure: str | None = None
    """What the percentages are of: ``torque`` or ``paper``."""


class LeaderboardDocument(ResultDocument):
    """The fits of a tournament, the best first."""

    schema_: Literal["fricmodels/leaderboard/1"] = Field(
        SCHEMA, validation_alias="schema", serialization_alias="schema"
    )
    """What the document is, with its version."""
    rows: tuple[LeaderboardRow, ...]
    """In order of rank."""
