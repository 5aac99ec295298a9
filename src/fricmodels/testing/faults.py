"""What a check that fails says."""

from __future__ import annotations

from unittest import SkipTest

__all__ = ["Fault", "SkipTest"]


class Fault(AssertionError):
    """A check failed; the message says what is wrong and what to change."""
