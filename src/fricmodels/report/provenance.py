"""Where a result came from, and the commands that make it again."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import Any

from fricmodels.report.page import Block, Code, Section, Table, table

Data = Mapping[str, Any]


def recording_section(data: Data, command: str, options: Sequence[str] = ()) -> Section:
    """Describe the recording, the versions, and how to do it again.

    Args:
        data: a diagnosis as plain data.
        command: ``compare``, ``diagnose`` or ``improve``.
        options: more options of that command.
    """
    blocks: list[Block] = [recording(data)]
    if known := data["recording"].get("findings"):
        rows = [(one["kind"], one["severity"], "; ".join(filter(None, (one["text"], one["remedy"])))) for one in known]
        blocks.append(table("What is the matter with it", {"what": False, "": False, "seen": False}, rows))
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
        ("sampling", f"every {1000 * known['interval']:.6g} ms"),
        ("motion", data["motion"]),
        ("inertia", f"{data['inertia']['value']:.6g} {data['inertia']['unit'].replace('^2', '²')}, "
         + ("estimated" if data["inertia"]["estimated"] else "given")),
    ]  # fmt: skip
    if known["true_model"]:
        rows.append(("simulated with", known["true_model"]))
    rows.append(("versions", versions(data["versions"])))
    return table("Recording and programs", {"property": False, "value": False}, rows)


def versions(known: Mapping[str, str]) -> str:
    """Return the versions of everything that took part, in words."""
    return ", ".join(f"{name} {version}" for name, version in known.items())


def commands(data: Data, command: str, options: Sequence[str] = ()) -> str:
    """Return the commands that reproduce a result and its report."""
    known = data["recording"]
    files = list(known.get("files") or [known["source"]])
    parts = ["fricmodels", command, *files, "--model", data["model"]]
    if not data["inertia"]["estimated"]:
        parts += ["--inertia", repr(data["inertia"]["value"])]
    for column in known["columns"]:
        parts += ["--column", column]
    if known["torque_constant"] is not None:
        parts += ["--torque-constant", repr(known["torque_constant"])]
    if data["motion"] == "linear":
        parts.append("--linear")
    return "\n".join([shlex.join(["sha256sum", *files]), shlex.join([*parts, *options, "--report", "report.html"])])
