"""Where a result came from, and the commands that make it again."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from fricmodels.report.answer import command_line
from fricmodels.report.page import Block, Code, Fold, Section, Table, Words, table
from fricmodels.report.wording import count, unit
from fricmodels.results.words import form

if TYPE_CHECKING:
    from fricmodels.results.comparison import ComparisonDocument, RecordingFacts

_GRAVE = {"stop": "an error", "warn": "a warning", "note": "a note"}


def recording_section(data: ComparisonDocument, command: str, options: Sequence[str] = ()) -> Section:
    """Describe the recording, the versions, and how to do it again.

    Args:
        data: a comparison or a diagnosis.
        command: ``compare``, ``diagnose`` or ``improve``.
        options: more options of that command.
    """
    known = data.recording
    words = f"{count(known.samples.total)} samples of {data.dataset}, sampled {_sampling(known)}."
    blocks: list[Block] = [Words(words), Fold("Recording, channels and versions of programs", [recording(data)])]
    if known.findings:
        rows = [
            (one.kind, _GRAVE.get(one.severity, one.severity), "; ".join(filter(None, (one.text, one.remedy))))
            for one in known.findings
        ]
        blocks.append(table("What is the matter with it", {"what": False, "how grave": False, "seen": False}, rows))
    if known.source:
        blocks.append(Code("To do it again", commands(data, command, options)))
    return Section("provenance", "Data, versions, how to reproduce", blocks)


def recording(data: ComparisonDocument) -> Table:
    """Return what was recorded and how it was read."""
    known = data.recording
    samples = known.samples
    rows = [("recording", data.dataset)]
    if known.source:
        checksum, reader = known.sha256 or "–", known.reader or "–"
        rows += [("file", known.source), ("SHA-256 of the file", checksum), ("reader", reader)]
        rows.append(("columns", ", ".join(known.columns)))
    rows += [
        ("channels", ", ".join(name.replace("_", " ") for name in known.channels)),
        ("derived", ", ".join(_derived(name, known) for name in known.derived) or "none"),
        ("samples", f"{samples.fitted} fitted, {samples.in_the_test_error}"),
        ("sampling", _sampling(known)),
        ("motion", data.motion),
        ("inertia", f"{form(data.inertia.value, '.6g')} {unit(data.inertia.unit)}, "
         + ("estimated" if data.inertia.estimated else "given")),
    ]  # fmt: skip
    if known.true_model:
        rows.append(("simulated with", known.true_model))
    rows.append(("versions", versions(data.versions)))
    return table("Recording and programs", {"property": False, "value": False}, rows)


def versions(known: Mapping[str, str]) -> str:
    """Return the versions of everything that took part, in words."""
    return ", ".join(f"{name} {version}" for name, version in known.items())


def _sampling(known: RecordingFacts) -> str:
    return f"every {form(None if known.interval is None else 1000 * known.interval, '.3g')} ms"


def _derived(name: str, known: RecordingFacts) -> str:
    """Return the name of a derived channel, and why where it was measured too."""
    if name == "velocity" and any(column.partition("=")[0] == "velocity" for column in known.columns):
        return "velocity (the change of the position is more certain here than the measured velocity)"
    return name.replace("_", " ")


def commands(data: ComparisonDocument, command: str, options: Sequence[str] = ()) -> str:
    """Return the commands that reproduce a result and its report."""
    again = command_line(data, command, data.model, [*options, "--report", "report.html"])
    return "\n".join([shlex.join(["sha256sum", *data.recording.paths]), again])
