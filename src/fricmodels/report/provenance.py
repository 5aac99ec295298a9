"""Where a result came from, and the commands that make it again."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import Any

from fricmodels.report.page import Block, Code, Section, Table, table
from fricmodels.report.wording import number

Data = Mapping[str, Any]


def recording_section(data: Data, command: str, options: Sequence[str] = ()) -> Section:
    """Describe the recording, the versions, and how to do it again.

    Args:
        data: a diagnosis as plain data.
        command: ``compare``, ``diagnose`` or ``improve``.
        options: more options of that command.
    """
    blocks: list[Block] = [recording(data), versions(data["versions"])]
    if data["recording"]["source"]:
        blocks.append(Code("To do it again", commands(data, command, options)))
    return Section("provenance", "Where this comes from", blocks)


def recording(data: Data) -> Table:
    """Return what was recorded and how it was read."""
    known = data["recording"]
    samples = known["samples"]
    rows = [("recording", data["dataset"])]
    if known["source"]:
        rows += [("file", known["source"]), ("SHA-256 of the file", known["sha256"]), ("reader", known["reader"])]
        rows.append(("columns", ", ".join(known["columns"])))
    rows += [
        ("channels", ", ".join(name.replace("_", " ") for name in known["channels"])),
        ("derived", ", ".join(name.replace("_", " ") for name in known["derived"]) or "none"),
        ("samples", f"{samples['fitted']} fitted, {samples['kept_back']} kept back"),
        ("sampling", f"every {number(1000 * known['interval'], 4)} ms"),
        ("motion", data["motion"]),
        ("inertia", f"{number(data['inertia']['value'], 4)} {data['inertia']['unit'].replace('^2', '²')}, "
         + ("estimated" if data["inertia"]["estimated"] else "given")),
    ]  # fmt: skip
    if known["true_model"]:
        rows.append(("simulated with", known["true_model"]))
    return table("The recording", {"": False, "what": False}, rows)


def versions(known: Mapping[str, str]) -> Table:
    """Return the versions of everything that took part."""
    return table("Versions", {"program": False, "version": False}, list(known.items()))


def commands(data: Data, command: str, options: Sequence[str] = ()) -> str:
    """Return the commands that reproduce a result and its report."""
    known = data["recording"]
    parts = ["fricmodels", command, str(known["source"]), "--model", data["model"]]
    if not data["inertia"]["estimated"]:
        parts += ["--inertia", repr(data["inertia"]["value"])]
    for column in known["columns"]:
        parts += ["--column", column]
    if known["torque_constant"] is not None:
        parts += ["--torque-constant", repr(known["torque_constant"])]
    if data["motion"] == "linear":
        parts.append("--linear")
    return "\n".join([f"sha256sum {shlex.quote(str(known['source']))}", shlex.join([*parts, *options, "--report", "report.html"])])
