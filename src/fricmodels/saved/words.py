"""A fitted model in words, as it is printed."""

from __future__ import annotations

from fricmodels.dimension import Motion
from fricmodels.recording import OTHER
from fricmodels.results.words import NORMAL_95, spread_text, value_text
from fricmodels.saved.document import ModelDocument, StoredParameter


def described(document: ModelDocument) -> str:
    """Return name, equations, parameters, ranges and the test error of a model, one a line."""
    return "\n".join([*model_lines(document), *([f"  {error_in_words(document)}"] if document.error else [])])


def model_lines(document: ModelDocument) -> list[str]:
    """Return name, equations, parameters and ranges of a model."""
    lines = [f"{document.model}  ({document.motion.value}; ± is half the 95 % interval)"]
    lines += [f"  {term.name}: {term.equation}" for term in document.terms]
    wide, motion = max(len(key) for key in document.parameters), document.motion
    lines += [f"  {key.ljust(wide)} = {_value(p)}" for key, p in document.parameters.items()]
    lines += [
        f"  fitted for {_channel(name, motion)} from {seen.least:.4g} to {seen.greatest:.4g} {seen.unit}".rstrip()
        for name, seen in document.range.items()
        if name != "time"
    ]
    if document.controller is not None:
        given = document.controller
        found = "".join(f", {symbol} = {_value(p)}" for symbol, p in given.parameters.items())
        lines.append(f"  simulated through the controller '{given.settings.get('kind')}'{found}")
    return lines


def error_in_words(document: ModelDocument) -> str:
    """Return the test error and the window over which it is averaged."""
    error = document.error
    if error is None:
        return "test error unknown"
    test = "unknown" if error.test_percent is None else f"{error.test_percent:.3g} %"
    what = "force" if document.motion is Motion.LINEAR else "motor torque"
    return f"test error {test} of the RMS {what}, averaged over {error.window_ms:.3g} ms"


def _channel(name: str, motion: Motion) -> str:
    """Return what a channel is called; a linear axis has forces."""
    plain = name if name.startswith(OTHER) else name.replace("_", " ")
    return plain.replace("torque", "force") if motion is Motion.LINEAR and plain == name.replace("_", " ") else plain


def _value(p: StoredParameter) -> str:
    unit = "" if p.unit == "1" else f" {p.unit}"
    half = None if p.standard_error is None else NORMAL_95 * p.standard_error
    spread = "" if half is None else f" ± {spread_text(half)}"
    notes = [*(["given"] if p.given else []), *([f"at its bound ({p.at_bound})"] if p.at_bound else [])]
    if not p.identified:
        notes.append(f"NOT DETERMINED: {p.reason}")
    return f"{value_text(p.value, half)}{spread}{unit}" + (f"  [{'; '.join(notes)}]" if notes else "")
