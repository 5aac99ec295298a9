"""A fitted model as a file and as an object: fit once, then call, simulate, compensate, export.

:func:`keep` makes the object of a result, :func:`load` of a file; :class:`FittedModel` says what it can do.
"""

from __future__ import annotations

from fricmodels.saved.document import SCHEMA, ModelDocument
from fricmodels.saved.fitted import FittedModel
from fricmodels.saved.results import keep, keep_fit, keep_row
from fricmodels.saved.states import Along, Moving

load = FittedModel.load

__all__ = ["SCHEMA", "Along", "FittedModel", "ModelDocument", "Moving", "keep", "keep_fit", "keep_row", "load"]
