"""From sums to a model to keep."""

from __future__ import annotations

import numpy as np

from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.saved.document import StoredProvenance
from fricmodels.saved.fitted import FittedModel
from fricmodels.saved.results import document_of
from fricmodels.sums import Sums, solved

_NAMED = 100
"""Files that are named at most."""


def keep_sums(sums: Sums, inertia: float | None = None) -> FittedModel:
    """Return the model that sums of recordings give, to call, to save and to export.

    Args:
        sums: of one file or of many, see :func:`fricmodels.sums.added`.
        inertia: where it was given [kg m² or kg].

    Raises:
        InputError: where they do not determine it.
    """
    found = solved(sums, inertia)
    plan = sums.plan
    drive = Drive(plan.drive.model, inertia, plan.motion)
    limits = {"velocity": (-plan.peak, plan.peak), **sums.range}
    ends = {name: np.array(values) for name, values in limits.items()}
    names = sorted(sums.files.values())
    provenance = {"files": names[:_NAMED], "reader": None}
    name = names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"
    seen = Recording(name, plan.motion, ends, np.zeros(2, dtype=np.int64), provenance=provenance)
    document = document_of(
        drive,
        found.parameters,
        found.standard_errors,
        seen,
        not_identified=found.not_identified,
        covariance=None if found.covariance is None else (drive.keys, found.covariance),
        estimator="sums",
    )
    stored: StoredProvenance = document.provenance.model_copy(
        update={"samples_fitted": sums.samples, "interval": plan.interval, "checksum": "+".join(sorted(sums.files)[:4])}
    )
    return FittedModel(document.model_copy(update={"provenance": stored}), model=drive.model)
