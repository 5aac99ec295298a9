"""Which runs of a recording are those that a model was fitted to: told by their torque, not by their number."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fricmodels.arrays import Index
from fricmodels.model import Model
from fricmodels.recording import Recording


def run_checksums(recording: Recording) -> dict[int, str]:
    """Return the SHA-256 of the torque of each run [N m or N], by the number of the run.

    Args:
        recording: as read or as prepared, which changes no torque; of one that was cut, what it was cut from counts.
    """
    whole = recording if recording.origin is None else recording.origin.whole
    return {
        int(number): hashlib.sha256(
            np.ascontiguousarray(whole.torque[whole.run == number], "<f8").tobytes()
        ).hexdigest()
        for number in whole.run_numbers
    }


def numbered_as_fitted(recording: Recording, model: Model) -> Recording:
    """Return a recording whose runs have the numbers that a model knows them by; no others have such a number.

    A recording of another day has runs 0 and 1 as well, and they are other runs. A model of which no parameter belongs
    to a run, and one that knows no checksums at all (:attr:`fricmodels.model.Known.runs`), takes a recording as it is.

    Args:
        recording: as read or as prepared.
        model: with what is known of it.
    """
    known = model.known.runs
    if known is None or all(effect.fitted_runs is None for effect in model.effects):
        return recording
    free = 1 + max((number for effect in model.effects for number in effect.fitted_runs or ()), default=-1)
    return _numbered(recording, known, free)


def numbered_beside(recording: Recording, other: Recording) -> Recording:
    """Return a recording in which those runs that another one has too have the same numbers, and no other run has one.

    Args:
        recording, other: as read.
    """
    known = {checksum: number for number, checksum in run_checksums(other).items()}
    return _numbered(recording, known, 1 + int(other.run_numbers.max()))


def _numbered(recording: Recording, known: Mapping[str, int], free: int) -> Recording:
    numbers: dict[int, int] = {}
    for number, checksum in run_checksums(recording).items():
        own = known.get(checksum)
        numbers[number] = free + len(numbers) if own is None or own in numbers.values() else own
    if all(number == new for number, new in numbers.items()):
        return recording
    if recording.origin is not None:
        whole = replace(recording.origin.whole, run=_renumbered(recording.origin.whole.run, numbers))
        return replace(recording, origin=replace(recording.origin, whole=whole))
    return replace(recording, run=_renumbered(recording.run, numbers))


def _renumbered(run: Index, numbers: Mapping[int, int]) -> Index:
    found, place = np.unique(run, return_inverse=True)
    return np.array([numbers[int(number)] for number in found], dtype=np.int64)[place]
