"""A filter's problem as plain data: a filter goes on after a restart, without the recording that it began with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from fricmodels.dimension import Motion, Scales
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.filtering.normalisation import NormalisedSpace, normalised_space
from fricmodels.filtering.problem import FilterProblem
from fricmodels.kernels import Scan
from fricmodels.model import Model

_ARRAYS = (
    "known", "walk", "lower", "upper", "initial_states", "initial_parameters", "initial_covariance"
)  # fmt: skip
SCHEMA = "fricmodels/online/1"


def drive_document(drive: Drive) -> dict[str, Any]:
    """Return a drive as plain data: its model by name, the keys of what is estimated, inertia and motion."""
    return {
        "model": drive.model.name,
        "keys": list(drive.keys),
        "inertia": drive.inertia,
        "motion": drive.motion.value,
    }


def drive_of(document: Mapping[str, Any]) -> Drive:
    """Return the drive of a document.

    Raises:
        InputError: where the model is not installed, or has other parameters now.
    """
    drive = Drive(Model.parse(document["model"]), document["inertia"], Motion(document["motion"]))
    if list(drive.keys) != list(document["keys"]):
        raise InputError(
            f"the filter was saved with the parameters {', '.join(document['keys'])}, '{drive.model.name}' has "
            f"{', '.join(drive.keys)}; start it anew from a recording"
        )
    return drive


def problem_document(problem: FilterProblem) -> dict[str, Any]:
    """Return a problem as plain data; JSON keeps every number to the last bit."""
    return {
        **drive_document(problem.drive),
        "scales": asdict(problem.scales),
        "measurement": float(problem.measurement),
        "substeps": problem.substeps,
        "hold": problem.hold,
        **{name: np.asarray(getattr(problem, name)).tolist() for name in _ARRAYS},
    }


def problem_of(document: Mapping[str, Any], step: Callable[[NormalisedSpace, Drive], Any]) -> FilterProblem:
    """Return the problem of a document.

    Args:
        document: see :func:`problem_document`.
        step: builds the filter's step for :class:`fricmodels.kernels.Scan`.
    """
    drive = drive_of(document)
    space = normalised_space(drive)
    arrays = {name: np.array(document[name], dtype=float) for name in _ARRAYS}
    return FilterProblem(
        drive=drive,
        scales=Scales(**document["scales"]),
        space=space,
        scan=Scan(step(space, drive)),
        measurement=float(document["measurement"]),
        substeps=int(document["substeps"]),
        hold=document["hold"],
        **arrays,
    )


def checked_state(state: Mapping[str, Any], estimator: str) -> Mapping[str, Any]:
    """Return a state that is an estimator's own.

    Raises:
        InputError: where it is another one's, or none.
    """
    if state.get("schema") != SCHEMA or state.get("estimator") != estimator:
        found = state.get("estimator") or "nothing"
        raise InputError(f"this is no state of '{estimator}' ({found}); save one with online.state")
    return state
