"""``fricmodels info``: what a recording is, and what is the matter with it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer

from fricmodels.cli.measurement import Column, Data, Format, GapsOption, Inertia, Linear, Out, TorqueConstant, say_gaps

if TYPE_CHECKING:
    from fricmodels.logcheck import Summary


def command(
    data: Data,
    inertia: Inertia = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    linear: Linear = False,
    gaps: GapsOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print info.json instead.")] = False,
    out: Out = None,
) -> None:
    """Say what a recording is, and what is the matter with it, before a model is fitted to it.

    With --inertia the units of motion and torque are judged by it too. Nothing stops here: what would stop the other
    commands is printed first. With --out, info.json is written into that directory.
    """
    from fricmodels.dimension import Motion
    from fricmodels.files import write_text
    from fricmodels.logcheck import summary
    from fricmodels.readers import read_together

    motion = Motion.LINEAR if linear else None
    recording = read_together(
        data, columns=column or (), motion=motion, reader=reader, torque_constant=torque_constant, gaps=gaps
    )
    say_gaps(recording)
    found = summary(recording, inertia)
    text = json.dumps(found.to_json(), indent=2, ensure_ascii=False, allow_nan=False)
    if as_json:
        print(text)
    else:
        _show(found, dict(recording.provenance.get("columns", {})))
    if out is not None:
        path = write_text(out / "info.json", text + "\n")
        if not as_json:
            print(f"wrote {path}")


def _show(found: Summary, columns: dict[str, str]) -> None:
    from fricmodels.cli.printing import print_table
    from fricmodels.terminal import Column as Shown

    words = {"stop": "stops", "warn": "warning", "note": "note"}
    for finding in found.findings:
        print(f"{words[finding.severity]}: {finding.kind}: {finding}")
    if not found.findings:
        print("nothing is the matter")
    print()
    rows = found.rows()
    print_table([Shown(found.name, tuple(label for label, _ in rows)), Shown("", tuple(value for _, value in rows))])
    print()
    channels = found.channels
    figures = {
        "least": [f"{c.least:.5g}" for c in channels.values()],
        "greatest": [f"{c.greatest:.5g}" for c in channels.values()],
        "step": [f"{c.resolution:.3g}" if c.resolution else "–" for c in channels.values()],
        "noise": [f"{c.noise:.2g}" for c in channels.values()],
    }
    print_table(
        [
            Shown("channel", tuple(name.replace("_", " ") for name in channels)),
            Shown("unit", tuple(channel.unit for channel in channels.values())),
            *(Shown(title, tuple(cells), number=True) for title, cells in figures.items()),
            Shown("column", tuple(columns.get(name, "") for name in channels)),
        ]
    )
