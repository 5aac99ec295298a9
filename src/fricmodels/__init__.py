"""Find out what friction really does in a drive: fit, rank and diagnose friction models on measured recordings.

Five names do the whole loop: :func:`read` a recording, :func:`compare` a model with it, :func:`diagnose` what is
missing, :func:`improve` the model, :func:`run` a tournament.

Names are imported when first used, so that ``import fricmodels`` is quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fricmodels.hookspecs import hookimpl

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import compare
    from fricmodels.diagnosis.diagnose import diagnose
    from fricmodels.diagnosis.ladder import improve
    from fricmodels.drive import Drive
    from fricmodels.estimator import Estimator
    from fricmodels.fit import Fit
    from fricmodels.model import Model
    from fricmodels.parameter import Parameter, State
    from fricmodels.readers import read
    from fricmodels.recording import Recording
    from fricmodels.term import Effect, Law
    from fricmodels.tournament import run

__version__ = "0.1.0"

_HOMES = {
    "Drive": "drive",
    "Effect": "term",
    "Estimator": "estimator",
    "Fit": "fit",
    "Law": "term",
    "Model": "model",
    "Parameter": "parameter",
    "Recording": "recording",
    "State": "parameter",
    "compare": "diagnosis",
    "diagnose": "diagnosis",
    "improve": "diagnosis",
    "read": "readers",
    "run": "tournament",
}

__all__ = [
    "Drive",
    "Effect",
    "Estimator",
    "Fit",
    "Law",
    "Model",
    "Parameter",
    "Recording",
    "State",
    "compare",
    "diagnose",
    "hookimpl",
    "improve",
    "read",
    "run",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"fricmodels.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'fricmodels' has no attribute '{name}'")
