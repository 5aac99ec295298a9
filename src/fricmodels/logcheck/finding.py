"""What a check finds in a recording: of which kind, how grave, in which channel, and what mends it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Severity(StrEnum):
    """``stop``: every answer would be nonsense. ``warn``: answers may suffer. ``note``: what the recording is."""

    STOP = "stop"
    WARN = "warn"
    NOTE = "note"


GRAVEST_FIRST = (Severity.STOP, Severity.WARN, Severity.NOTE)


@dataclass(frozen=True)
class Finding:
    """One thing that is the matter with a recording.

    Attributes:
        kind: what, in one or two words, such as ``torque-sign``.
        severity: how grave it is.
        channel: where.
        text: what was seen and the likely cause, in one sentence without a full stop.
        remedy: what mends it, an option if there is one; empty where nothing is to be done.
    """

    kind: str
    severity: Severity
    channel: str
    text: str
    remedy: str = ""

    def __str__(self) -> str:
        return f"{self.text}; {self.remedy}" if self.remedy else self.text

    def to_json(self) -> dict[str, Any]:
        """Return plain texts."""
        return asdict(self) | {"severity": str(self.severity)}
