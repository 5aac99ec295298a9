"""Several recordings as one: each file a run of it, or several where it has runs of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels.errors import InputError
from fricmodels.progress import each
from fricmodels.readers.reading import read
from fricmodels.recording import Recording


def read_together(paths: Sequence[str | Path], *, name: str | None = None, **how: Any) -> Recording:
    """Read one file, or several as one recording; see :func:`fricmodels.readers.read` for how.

    Raises:
        InputError: for a file that cannot be used, or that does not have the same columns as the first.
    """
    files = [Path(path).resolve() for path in paths]
    twice = next((path for number, path in enumerate(paths) if files[number] in files[:number]), None)
    if twice is not None:
        raise InputError(f"{twice}: is named twice, and its samples would count twice; name it once")
    if len(paths) == 1:
        return together([read(paths[0], name=name, **how)], name)
    return together([read(path, **how) for path in each("reading files", paths)], name)


def together(recordings: Sequence[Recording], name: str | None = None) -> Recording:
    """Return recordings as the runs of one; the time may begin anew in each.

    Runs are numbered from 0 on in the order that is given. ``provenance["files"]`` lists the files, ``["runs"]`` what
    each run is called: its file, and its own name there; ``["file_of_run"]`` the file alone.

    Raises:
        InputError: when they do not have the same channels, in the same units, of the same kind of motion.
    """
    first, *others = recordings
    if not others:
        return first
    for other in others:
        _check_alike(first, other)
    channels = {key: np.concatenate([one[key] for one in recordings]) for key in first.channels}
    runs: list[Any] = []
    names: dict[int, str] = {}
    file_of_run: dict[int, str] = {}
    labels = [Path(_source(one)).name for one in recordings]
    labels = [
        label if labels.count(label) == 1 else _source(one) for label, one in zip(labels, recordings, strict=True)
    ]
    for one, label in zip(recordings, labels, strict=True):
        numbers, place = np.unique(one.run, return_inverse=True)
        runs.append(place + len(names))
        own = one.provenance.get("runs", {})
        for number in numbers.tolist():
            file_of_run[len(names)] = label
            names[len(names)] = one.name if len(numbers) == 1 else f"{one.name}, {own.get(number, number)}"
    known = [one.provenance for one in recordings]
    left = [f"{_source(one)}: {one.provenance['gaps']}" for one in recordings if "gaps" in one.provenance]
    checksums = "".join(str(each.get("sha256", "")) for each in known)
    return Recording(
        name or f"{first.name} and {len(others)} more",
        first.motion,
        channels,
        np.concatenate(runs).astype(np.int64),
        derived=first.derived,
        provenance={
            **first.provenance,
            "source": ", ".join(_source(one) for one in recordings),
            "files": [_source(one) for one in recordings],
            "sha256": hashlib.sha256(checksums.encode()).hexdigest(),
            "runs": names,
            "file_of_run": file_of_run,
            **({"gaps": "; ".join(left)} if left else {}),
        },
        units=first.units,
    )


def _check_alike(first: Recording, other: Recording) -> None:
    if other.motion is not first.motion:
        raise InputError(
            f"{_source(other)}: a {other.motion} drive, {_source(first)} a {first.motion} one; read each on its own"
        )
    for lacks, has in ((other, first), (first, other)):
        missing = [channel for channel in has.channels if channel not in lacks]
        if missing:
            raise InputError(
                f"{_source(lacks)}: has no {missing[0].replace('_', ' ')}, which {_source(has)} has; files that are "
                f"read together need the same columns"
            )
    for channel, unit in first.units.items():
        if other.units[channel] != unit:
            raise InputError(
                f"{_source(other)}: {channel} is in {other.units[channel] or 'no unit'}, in {_source(first)} in "
                f"{unit or 'no unit'}; give both the same with --column {channel}=COLUMN:UNIT"
            )


def _source(recording: Recording) -> str:
    return str(recording.provenance.get("source", recording.name))
