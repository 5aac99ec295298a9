"""Find out what friction really does in a drive: fit, rank and diagnose friction models on measured recordings.

Names are imported when first used, so that ``import fricmodels`` is quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fricmodels.hookspecs import hookimpl

if TYPE_CHECKING:
    from fricmodels.drive import Drive
    from fricmodels.estimator import Estimator
    from fricmodels.fit import Fit
    from fricmodels.model import Model
    from fricmodels.parameter import Parameter, State
    from fricmodels.recording import Recording
    from fricmodels.term import Effect, Law

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
    "hookimpl",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"fricmodels.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'fricmodels' has no attribute '{name}'")
