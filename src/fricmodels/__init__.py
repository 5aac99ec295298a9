"""Find out what friction really does in a drive: fit, rank and diagnose friction models on measured recordings.

Five names do the whole loop: :func:`read` a recording, :func:`compare` a model with it, :func:`diagnose` what is
missing, :func:`improve` the model, :func:`run` a tournament. Two more make it last: :func:`keep` the model of a result,
:func:`load` it from its file.

Names are imported when first used, so that ``import fricmodels`` is quick.
"""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

from fricmodels.display import Displayed
from fricmodels.hookspecs import hookimpl
from fricmodels.lazy import first_use

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import compare
    from fricmodels.diagnosis.diagnose import diagnose
    from fricmodels.diagnosis.improve import improve
    from fricmodels.display import Display
    from fricmodels.drive import Drive
    from fricmodels.estimator import Estimator, Solution
    from fricmodels.fit import Fit
    from fricmodels.model import Model
    from fricmodels.parameter import Parameter, State
    from fricmodels.readers import read
    from fricmodels.recording import Recording
    from fricmodels.saved import FittedModel, keep, keep_fit, keep_row, load
    from fricmodels.term import Effect, Law
    from fricmodels.tournament import run

__version__ = "0.1.0"

_HOMES = {
    "fricmodels.diagnosis": ("compare", "diagnose", "improve"),
    "fricmodels.drive": ("Drive",),
    "fricmodels.estimator": ("Estimator", "Solution"),
    "fricmodels.fit": ("Fit",),
    "fricmodels.model": ("Model",),
    "fricmodels.parameter": ("Parameter", "State"),
    "fricmodels.readers": ("read",),
    "fricmodels.recording": ("Recording",),
    "fricmodels.saved": ("FittedModel", "keep", "keep_fit", "keep_row", "load"),
    "fricmodels.term": ("Effect", "Law"),
    "fricmodels.tournament": ("run",),
}

__all__ = [
    "Drive",
    "Effect",
    "Estimator",
    "Fit",
    "FittedModel",
    "Law",
    "Model",
    "Parameter",
    "Recording",
    "Solution",
    "State",
    "compare",
    "diagnose",
    "hookimpl",
    "improve",
    "keep",
    "keep_fit",
    "keep_row",
    "load",
    "read",
    "run",
]


def _display() -> Display:
    from fricmodels import notebook

    return notebook


Displayed.display = _display


__getattr__ = first_use(__name__, _HOMES)


def __dir__() -> list[str]:
    own = {name for name, value in globals().items() if name.startswith("__") or _is_module_of_this(value)}
    return sorted({*own, *__all__})


def _is_module_of_this(value: object) -> bool:
    return isinstance(value, ModuleType) and value.__name__.startswith("fricmodels.")
