"""Reads model files: whatever is wrong with one leaves as one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from fricmodels import plugins
from fricmodels.arrays import Array
from fricmodels.documents import first_problem
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import RATE, Recording, channel_of
from fricmodels.saved.document import SCHEMA, ModelDocument, StoredTerm
from fricmodels.stored import read_results

AGAIN = "fricmodels fit DATA --model M --out FILE.model.json"
_SAMPLES = 24
"""Samples a run of the stand-in recording, enough for terms that look at the motion."""


def read_document(path: str | Path) -> ModelDocument:
    """Read a model file.

    Raises:
        InputError: when there is none, it is no JSON, of another schema, or something in it is not as it should be.
    """
    file = Path(path)
    try:
        content = read_results(file, SCHEMA, AGAIN)
    except FileNotFoundError:
        raise InputError(f"{file}: there is no such file; make a model with: {AGAIN}") from None
    try:
        return ModelDocument.model_validate_json(json.dumps(content))
    except ValidationError as error:
        raise InputError(f"{file}: {first_problem(error, ModelDocument)}; make it anew with: {AGAIN}") from None


def model_of(document: ModelDocument, place: str = "this model") -> Model:
    """Return the model that a document is of, with the units and the runs of its recording.

    Args:
        document: as read.
        place: what is to blame in errors.

    Raises:
        InputError: where a law or an effect is not installed, or has other parameters than the file.
    """
    registered = plugins.load()
    for term in document.terms:
        registry = registered.laws if term.kind == "law" else registered.effects
        name = term.name.partition("(")[0]
        if name not in registry and name != "no-friction":
            try:
                registry.entry(name)
            except InputError as error:
                why = f" ({error})" if isinstance(error, plugins.LeftOut) else ""
                raise InputError(f"{place}: {_missing(term, name)}{why}") from None
        danger = registry.danger(name)
        if danger is not None:
            raise InputError(f"{place}: {term.kind} '{name}' of {term.distribution} cannot be used here: {danger}")
    model = Model.parse(document.model).on(_stand_in(document))
    inertia = Drive(model, None, document.motion).inertia_key
    known, stored = [inertia, *(p.key for p in model.parameters)], list(document.parameters)
    if known != stored:
        missing = [key for key in known if key not in stored] or [key for key in stored if key not in known] or known
        raise InputError(
            f"{place}: '{document.model}' has the parameters {', '.join(known)}; the file and they differ in "
            f"'{missing[0]}'; fit it again with this version: {AGAIN}"
        )
    for now, then in zip(model.terms, document.terms, strict=False):
        if then.equation and now.formula != then.equation:
            raise InputError(
                f"{place}: the {then.kind} '{then.name}' is another one now: {now.formula}; the file has "
                f"{then.equation}; fit it again with this version: {AGAIN}"
            )
    return model


def _missing(term: StoredTerm, name: str) -> str:
    if not term.distribution:
        return (
            f"needs the {term.kind} '{name}', which was defined in a notebook or a script and is in no distribution; "
            f"put it into a plugin, see docs/plugins.md"
        )
    version = f" {term.version}" if term.version else ""
    return (
        f"needs the {term.kind} '{name}' of {term.distribution}{version}, which is not installed; install it with: "
        f"pip install {term.distribution}"
    )


def _stand_in(document: ModelDocument) -> Recording:
    """Return a recording with the units, the runs and the channels of the one that was fitted, in its ranges."""
    rng = np.random.default_rng(0)
    runs = np.repeat(np.array(document.runs, dtype=np.int64), _SAMPLES)
    count = len(runs)
    channels: dict[str, Array] = {"time": np.arange(count, dtype=float) * 1e-3, "torque": rng.uniform(-1.0, 1.0, count)}
    wanted = {
        channel_of(name).removeprefix(RATE) for term in Model.parse(document.model).terms for name in term.channels
    }
    for name in {*document.range, *document.units, *wanted} - {"time", "run"}:
        seen = document.range.get(name)
        low, high = (seen.least, seen.greatest) if seen is not None and seen.least < seen.greatest else (-1.0, 1.0)
        channels[name] = rng.uniform(low, high, count)
    channels["velocity"] = channels.get("velocity", rng.uniform(-1, 1, count))
    channels.pop("run", None)
    return Recording("stand-in", document.motion, channels, runs, units=dict(document.units))
