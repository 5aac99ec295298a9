"""Which effect a model is missing: compare, diagnose, improve."""

from __future__ import annotations

from fricmodels.diagnosis.comparison import Comparison, compare, compare_fit, compare_model, kept_back
from fricmodels.diagnosis.diagnose import Diagnosis, diagnose, examine
from fricmodels.diagnosis.improve import improve
from fricmodels.diagnosis.ladder import Ladder
from fricmodels.weakform.prepared import ready

__all__ = [
    "Comparison",
    "Diagnosis",
    "Ladder",
    "compare",
    "compare_fit",
    "compare_model",
    "diagnose",
    "examine",
    "improve",
    "kept_back",
    "ready",
]
