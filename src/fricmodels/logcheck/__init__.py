"""Look at the log first: what is wrong with a recording, by statistics, before a model is fitted to it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from fricmodels.errors import InputError
from fricmodels.logcheck.check import findings
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.summary import Summary, summary
from fricmodels.recording import Recording

__all__ = ["Finding", "Severity", "Summary", "checked", "findings", "summary"]

_TRUST = "or go on with --trust"


def checked(
    recording: Recording,
    inertia: float | None = None,
    *,
    trust: bool = False,
    warn: Callable[[Iterable[str]], None] = lambda lines: None,
) -> Recording:
    """Return the recording with what is the matter with it in its provenance, as ``findings``.

    Args:
        recording: as read.
        inertia: the stated one [kg m² or kg], by which units are judged.
        trust: go on where every answer would be nonsense.
        warn: is given one line for each finding that is worth one.

    Raises:
        InputError: where every answer would be nonsense; one line with the likely cause and what mends it.
    """
    found = findings(recording, inertia)
    source = recording.provenance.get("source", recording.name)
    stops = [finding for finding in found if finding.severity is Severity.STOP]
    if stops and not trust:
        raise InputError(f"{source}: {stops[0]}, {_TRUST}")
    warn(f"{source}: {finding}" for finding in found if finding.severity is not Severity.NOTE)
    known = {**recording.provenance, "findings": [finding.to_json() for finding in found]}
    return replace(recording, provenance=known)
