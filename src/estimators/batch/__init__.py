"""The batch estimator."""

from __future__ import annotations

from estimators.batch.estimator import Batch, BatchSettings

__all__ = ["Batch", "BatchSettings"]
