"""``histories.json``: how the parameters of sequential estimators came about in a tournament, typed."""

from __future__ import annotations

from typing import Final, Literal

from pydantic import Field

from fricmodels.results.part import Number, Part, ResultDocument

FILE: Final = "histories.json"
SCHEMA: Final = "fricmodels/histories/1"


class Course(Part):
    """The estimates of one parameter while they come about, in its SI unit."""

    unit: str
    """Of the parameter."""
    estimates: tuple[Number, ...]
    """One for each time of the history."""
    deviations: tuple[Number, ...] | None = None
    """Standard deviation of each by the estimator's own covariance; null where it keeps none."""
    final: Number = None
    """The value that the fit gives, which may be a mean over the last part."""
    standard_error: Number = None
    """Of the value that the fit gives; null where there is none."""
    truth: Number = None
    """Of simulated recordings."""


class ParameterHistory(Part):
    """The estimates of a sequential estimator over a recording, thinned."""

    model: str
    """``LAW+EFFECT+…``."""
    estimator: str
    """Its title."""
    dataset: str
    """Name of the recording."""
    key: str = ""
    """Of the fit in ``leaderboard.json``."""
    kept: int
    """How many estimates the fit kept, before they were thinned for this history."""
    time: tuple[Number, ...]
    """Of each estimate [s]; a recording of several runs may start anew."""
    courses: dict[str, Course]
    """By key of the parameter."""


class Histories(ResultDocument):
    """The best fit of each sequential estimator on each recording of a tournament."""

    schema_: Literal["fricmodels/histories/1"] = Field(SCHEMA, validation_alias="schema", serialization_alias="schema")
    """What the document is, with its version."""
    fits: tuple[ParameterHistory, ...]
    """One for each dataset and estimator."""
