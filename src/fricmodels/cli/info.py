"""``fricmodels info``: what a recording is, and what is the matter with it."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from fricmodels.cli.measurement import (
    Column,
    Data,
    Format,
    GapsOption,
    Inertia,
    Linear,
    Out,
    Reading,
    TorqueConstant,
    say_gaps,
)

if TYPE_CHECKING:
    from fricmodels.logcheck import Summary
    from fricmodels.recording import Recording

_LONG = 200_000
"""Samples from which on the stretches are not counted: it would take seconds."""


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

    With --inertia it is judged too, by the one that the recording tells, and by it the units. What would stop the other
    commands by what the recording means is printed first, and does not stop here; a file that cannot be read as a
    recording (values that are no numbers, a clock that goes back, a missing column, nothing that moves) is an error
    here too. With --out, info.json is written into that directory.
    """
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.cli.printing import working
    from fricmodels.files import write_text
    from fricmodels.logcheck import summary
    from fricmodels.progress import watched

    check_outputs([] if out is None else [out / "info.json"], data)
    with working(f"reading {data[0].name}") as say, watched(say):
        recording = Reading(column, torque_constant, reader, linear, gaps).read(data)
        say(f"looking at {len(recording)} samples")
        found = _with_clear_motion(summary(recording, inertia), recording, inertia)
    say_gaps(recording)
    text = json.dumps(found.to_json(), indent=2, ensure_ascii=False, allow_nan=False)
    if as_json:
        print(text)
    else:
        _show(found, dict(recording.provenance.get("columns", {})))
    if out is not None:
        path = write_text(out / "info.json", text + "\n")
        if not as_json:
            print(f"wrote {path}")


def _with_clear_motion(found: Summary, recording: Recording, inertia: float | None) -> Summary:
    """Add to what was found whether there is enough motion for the simplest model, as the other commands count it.

    Not of a long recording, nor of one that stops anyway.
    """
    from fricmodels.cli.answers import FEWEST
    from fricmodels.diagnosis import kept_back, ready
    from fricmodels.drive import Drive
    from fricmodels.errors import InputError
    from fricmodels.logcheck import Finding, Severity
    from fricmodels.model import Model
    from fricmodels.weakform.fit import clear_stretches

    stops = any(one.severity is Severity.STOP for one in found.findings)
    if stops or not FEWEST <= len(recording) <= _LONG:
        return found
    try:
        fitted, _ = kept_back(ready(recording))
        few = clear_stretches(Drive(Model.parse("coulomb-viscous"), inertia, recording.motion), fitted)
    except InputError as error:
        little = Finding("too-little-motion", Severity.WARN, "velocity", str(error), "")
    else:
        if few is None:
            return found
        clear, asked, way_out = few
        little = Finding(
            "too-little-motion",
            Severity.WARN,
            "velocity",
            f"what is fitted has {clear}, where the simplest model asks for {asked}",
            way_out,
        )
    warnings = sum(one.severity is Severity.WARN for one in found.findings)
    return replace(found, findings=(*found.findings[:warnings], little, *found.findings[warnings:]))


def _answer(found: Summary) -> str:
    """Return in one sentence whether a recording can be used, and what to do next."""
    from fricmodels.cli.answers import FEWEST
    from fricmodels.logcheck import Severity

    counted = {severity: sum(finding.severity == severity for finding in found.findings) for severity in Severity}
    if counted[Severity.STOP]:
        return "not usable as it is: every answer would be nonsense. What stops it stands first, with the way out."
    if found.samples < FEWEST:
        return f"{found.samples} samples are too few to fit a model to; record {FEWEST} at least."
    if any(one.kind == "too-little-motion" for one in found.findings):
        return "too little clear motion to fit a model to: see below."
    if counted[Severity.WARN]:
        return "usable, with what is warned of below in mind. Next: fricmodels diagnose, with the same options."
    return "nothing is the matter. Next: fricmodels diagnose, with the same options."


def _show(found: Summary, columns: dict[str, str]) -> None:
    from fricmodels.cli.printing import print_line, print_table
    from fricmodels.dimension import Motion
    from fricmodels.recording import word
    from fricmodels.terminal import Column as Shown

    words = {"stop": "stops", "warn": "warning", "note": "note"}
    print_line(f"{found.name}: {_answer(found)}")
    for finding in found.findings:
        print(f"{words[finding.severity]}: {finding.kind}: {finding}")  # not folded: options in it are copied
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
            Shown("channel", tuple(word(name, Motion(found.motion)) for name in channels)),
            Shown("unit", tuple(channel.unit for channel in channels.values())),
            *(Shown(title, tuple(cells), number=True) for title, cells in figures.items()),
            Shown("column", tuple(columns.get(name, "") for name in channels)),
        ]
    )
