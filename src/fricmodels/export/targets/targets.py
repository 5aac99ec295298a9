"""The targets by name, and what each is given."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from fricmodels.dimension import FORCE
from fricmodels.errors import InputError, suggestion
from fricmodels.export.targets import mjcf, simple
from fricmodels.export.targets.c_header import c_header
from fricmodels.export.targets.nearest import COULOMB_VISCOUS, MUJOCO, VISCOUS, Dialect, Nearest, nearest, undetermined
from fricmodels.export.targets.validity import doubtful
from fricmodels.filtering.problem import FilterProblem
from fricmodels.filtering.windowed import WindowedRegression
from fricmodels.recording import Recording
from fricmodels.saved import FittedModel

_DIALECTS: Mapping[str, Dialect] = {
    "mjcf": MUJOCO,
    "urdf": COULOMB_VISCOUS,
    "isaac": COULOMB_VISCOUS,
    "drake": VISCOUS,
    "ros2": COULOMB_VISCOUS,
}
TARGETS = ("c", *_DIALECTS, "json")
"""What a model can be exported to."""
_ROOTS = {"mjcf": "mujoco", "urdf": "robot"}


@dataclass(frozen=True)
class Exported:
    """A model for another program.

    Attributes:
        text: what goes into the file.
        notes: what was left out, what it costs, and what the recording did not determine, one sentence each.
        nearest: the model that is in the text, where it is not the whole one.
    """

    text: str
    notes: tuple[str, ...]
    nearest: Nearest | None = None


def export_model(
    model: FittedModel,
    target: str,
    *,
    name: str = "joint",
    recording: Recording | None = None,
    into: str | None = None,
    armature: float | None = None,
    online: str | None = None,
) -> Exported:
    """Return a fitted model for another program.

    What the target cannot express is left out, and what it can is refitted to the recording, or projected over the
    range of validity where none is given; the notes say what that costs.

    Args:
        model: the fitted model.
        target: one of :data:`TARGETS`.
        name: of the joint; in C, what every name begins with.
        recording: to refit to, as read.
        into: MJCF or URDF in which the joint of this name is changed; a snippet without it.
        armature: to write into that MJCF; the joint's own stays without it.
        online: in C, a filter that runs beside the drive: ``ekf``, ``detchmendy-sridhar`` or ``rls``; the recording
            scales it.

    Raises:
        InputError: for an unknown target, or XML that has no such joint.
    """
    if target not in TARGETS:
        raise InputError(f"unknown target '{target}'{suggestion(target, TARGETS)}")
    if into is not None and target not in _ROOTS:
        raise InputError(f"only {' and '.join(_ROOTS)} are written into a given file; leave --into out for '{target}'")
    if online is not None and target != "c":
        raise InputError(f"a filter on line is written in C only; leave --online out for '{target}'")
    vague = tuple(f"NOT DETERMINED by the recording: {k}: {why}" for k, why in doubtful(model).items())
    vague += (model.of_the_clock,) if model.of_the_clock else ()
    if target == "c":
        return Exported(c_header(model, name, _filter(model, online, recording)), vague)
    if target == "json":
        return Exported(_json(model), vague)
    found = nearest(model, _DIALECTS[target], recording)
    notes = [f"{model.name}, fitted to {model.document.provenance.recording}", *found.notes(FORCE.unit(model.motion))]
    if target == "mjcf":
        notes += mjcf.of_the_offset(found, name)
        if into is None:
            text = mjcf.snippet(found, notes, name)
        else:
            notes += mjcf.of_the_joint(into, found, name, armature)
            text = mjcf.into_xml(into, found, notes, name, armature)
    elif target == "isaac":
        notes += [f"NOT DETERMINED by the recording, behind 'friction': {key}" for key in undetermined(model)]
        text = simple.isaac(found, notes, name, model)
    elif into is not None:
        text = _into_urdf(into, found, notes, name)
    else:
        write: Callable[[Nearest, list[str], str], str] = getattr(simple, target)
        text = write(found, notes, name)
    return Exported(text, tuple(notes[1:]), found)


def _filter(
    model: FittedModel, online: str | None, recording: Recording | None
) -> FilterProblem | WindowedRegression | None:
    if online is None:
        return None
    if recording is None:
        raise InputError(f"'{online}' is scaled and started with a recording; give one with --data")
    from fricmodels.export.targets.c_filter import started

    return started(model, online, recording)


def _into_urdf(text: str, found: Nearest, notes: list[str], joint: str) -> str:
    root = mjcf.parsed(text, "robot")
    chosen = mjcf.named_joint(root.findall("joint"), joint)
    dynamics = chosen.find("dynamics")
    if dynamics is None:
        dynamics = ET.SubElement(chosen, "dynamics")
    for key, value in simple.urdf_values(found).items():
        dynamics.set(key, value)
    root.insert(0, ET.Comment("\n" + "\n".join(f"  {line}".replace("--", "- -") for line in notes) + "\n"))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _json(model: FittedModel) -> str:
    """Return equations and numbers in plain JSON, without what only this package needs."""
    document = model.document
    content = {
        "schema": "fricmodels/export/1",
        "model": model.name,
        "motion": document.motion.value,
        "equations": {term.name: term.equation for term in document.terms},
        "parameters": {
            key: {"value": p.value, "unit": p.unit, "identified": p.identified, "reason": p.reason}
            for key, p in document.parameters.items()
        },
        "signals": sorted(model.needs),
        "states": [state.symbol for state in model.model.states],
        "range": {name: seen.model_dump() for name, seen in document.range.items()},
        "test_error_percent": None if document.error is None else document.error.test_percent,
        "window_ms": None if document.error is None else document.error.window_ms,
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
