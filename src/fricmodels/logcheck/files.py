"""What is the matter with one file of several that were read together: beside the others it may not show."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from fricmodels.logcheck.finding import GRAVEST_FIRST, Finding, Severity
from fricmodels.recording import Recording

Findings = Sequence[Finding]


def by_file(recording: Recording, found: Findings, check: Callable[[Recording], Findings]) -> list[Finding]:
    """Return what was found in a recording, and what would stop a file of it alone; each with the file it is of.

    What the whole and some of its files show is said of these files, unless only all together are certain of it.

    Args:
        recording: one that may have been read from several files.
        found: in the whole recording.
        check: finds what is the matter with one file.
    """
    parts = dict(_parts(recording))
    if len(parts) < 2:
        return [*found]
    own = {name: {(one.kind, one.channel): one for one in check(part)} for name, part in parts.items()}
    shown = {(one.kind, one.channel): one.severity for one in found}
    alone: list[Finding] = []
    told = set()
    for key in dict.fromkeys(key for of_file in own.values() for key in of_file):
        having = {name: of_file[key] for name, of_file in own.items() if key in of_file}
        least = GRAVEST_FIRST.index(shown.get(key, Severity.STOP))
        grave = {name: one for name, one in having.items() if GRAVEST_FIRST.index(one.severity) <= least}
        if grave and (key not in shown or len(grave) < len(parts)):
            told.add(key)
            alone.extend(_in(name, one) for name, one in grave.items())
    return [*(one for one in found if (one.kind, one.channel) not in told), *alone]


def _parts(recording: Recording) -> Iterator[tuple[str, Recording]]:
    """Yield each file's own recording, with its name."""
    files: dict[int, str] = recording.provenance.get("file_of_run", {})
    names = dict.fromkeys(files.get(number, "") for number in recording.run_numbers.tolist())
    for name in names:
        if name:
            own = [number for number, file in files.items() if file == name]
            yield name, recording.select(np.isin(recording.run, own))


def _in(name: str, finding: Finding) -> Finding:
    """Return a finding as one of a file: what mends it must not be done to the others."""
    remedy = f"mend that file or leave it out (on its own: {finding.remedy})" if finding.remedy else ""
    return replace(finding, text=f"in {name}, {finding.text}", remedy=remedy)
