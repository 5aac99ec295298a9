"""Is a better friction model worth it? A controlled drive with and without compensation by it."""

from __future__ import annotations

from fricmodels.compensation.study import COULOMB, IMPROVED, NONE, TRUE, Study, Way, run_with, study

__all__ = ["COULOMB", "IMPROVED", "NONE", "TRUE", "Study", "Way", "run_with", "study"]
