"""What a friction model is worth to a controller: simulated drives that follow a motion, with and without it."""

from __future__ import annotations

from fricmodels.tracking.compensator import Compensator
from fricmodels.tracking.experiment import Experiment, Run
from fricmodels.tracking.figures import Figures
from fricmodels.tracking.settings import Settings

__all__ = ["Compensator", "Experiment", "Figures", "Run", "Settings"]
