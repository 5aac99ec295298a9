"""Where a tournament's recordings come from: files, simulations and rigs, each described by plain values.

A source is small and can be sent to another process, which loads the recording itself and keeps the last few.
"""

from __future__ import annotations

import glob
import hashlib
import json
import math
import os
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import Any, overload

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.fitted_runs import numbered_beside
from fricmodels.recording import Recording
from fricmodels.signals import Preparation, prepare
from fricmodels.signals.coasting import coasting
from fricmodels.split import Split, split
from fricmodels.tournament.config import Config, Dataset, Simulate
from fricmodels.tournament.simulated import simulated
from fricmodels.tournament.told import error_at, told_at
from fricmodels.weakform.prepared import prepared
from fricmodels.yaml_file import Document


@dataclass(frozen=True)
class Source:
    """One recording of a tournament, before it is loaded.

    Attributes:
        dataset: its name in the leaderboard.
        tags: what tells it from the other recordings of the same dataset: noise, seed, amplitude, …
        inertia: given inertia, or ``None`` to estimate it.
        description: all that decides its content, as JSON: file, mapping, true parameters, preparation, split.
    """

    dataset: str
    tags: Mapping[str, Any] = field(hash=False)
    inertia: float | None
    description: str

    @property
    def values(self) -> dict[str, Any]:
        """The description as plain values."""
        return dict(json.loads(self.description))

    @property
    def true_parameters(self) -> dict[str, float] | None:
        """What a simulated drive was simulated with; ``None`` for measurements."""
        values = self.values
        if values["kind"] != "simulate":
            return None
        key = "J" if values["motion"] == Motion.ROTARY else "M"
        return {key: values["inertia"], **values["parameters"]}

    @property
    def models(self) -> list[str]:
        """Name of the model that it is simulated with; none for measurements."""
        values = self.values
        return [values["model"]] if values["kind"] == "simulate" else []


@dataclass(frozen=True)
class Loaded:
    """A recording, split into what is fitted and what is scored.

    ``train`` is as measured, with the velocity derived where it was not; the others are prepared for the score.
    ``nonsense`` and ``doubts`` are lines on what is the matter with a file, see :func:`fricmodels.logcheck.findings`:
    with the former every answer would be nonsense.
    """

    train: Recording
    prepared_train: Recording
    prepared_test: Recording | None
    true_parameters: Mapping[str, float] | None
    digest: str
    nonsense: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()


class Sources(Sequence[Source]):
    """The recordings of a tournament in order, each made when it is asked for: how many there are takes no memory."""

    def __init__(self, parts: Sequence[_Part]) -> None:
        self._parts = tuple(parts)
        self._ends = tuple(accumulate(part.count for part in parts))

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @overload
    def __getitem__(self, number: int) -> Source: ...

    @overload
    def __getitem__(self, number: slice) -> list[Source]: ...

    def __getitem__(self, number: int | slice) -> Source | list[Source]:
        if isinstance(number, slice):
            return [self[each] for each in range(*number.indices(len(self)))]
        part, place = self._found(number)
        return Source(*part.named(place), part.inertia, part.described(place))

    @property
    def files(self) -> list[str]:
        """All files that are read for them."""
        return [file for part in self._parts for file in part.files]

    def named(self, number: int) -> tuple[str, dict[str, Any]]:
        """Return the dataset and the tags of a recording."""
        part, place = self._found(number)
        return part.named(place)

    def dataset(self, number: int) -> int:
        """Return the place in the configuration of the dataset that a recording is of."""
        return self._found(number)[0].place

    def _found(self, number: int) -> tuple[_Part, int]:
        place = number + len(self) if number < 0 else number
        if not 0 <= place < len(self):
            raise IndexError(f"there are {len(self)} recordings, none with the number {number}")
        which = bisect_right(self._ends, place)
        return self._parts[which], place - (self._ends[which - 1] if which else 0)


@dataclass(frozen=True)
class _Part:
    """The recordings of one dataset.

    Attributes:
        count: how many.
        named: from the number of one: its name in the leaderboard, and its tags.
        inertia: given, or ``None``.
        described: from the number of one: its description.
        files: all that are read for them.
        place: of the dataset in the configuration.
    """

    count: int
    named: Callable[[int], tuple[str, dict[str, Any]]]
    inertia: float | None
    described: Callable[[int], str]
    files: tuple[str, ...] = ()
    place: int = 0


def sources(config: Config, directory: Path, document: Document | None = None) -> tuple[Sources, list[str]]:
    """List the recordings of a tournament.

    Args:
        config: the tournament.
        directory: where relative paths start.
        document: the file that the tournament was read from; errors name its lines.

    Returns:
        The sources, and one line for each optional dataset that is left out because it is not there.

    Raises:
        InputError: when no file matches, or two datasets have one name.
    """
    parts, left_out = list[_Part](), list[str]()
    for place, dataset in enumerate(config.datasets):
        common = {
            "preparation": (dataset.preparation or config.preparation).model_dump(mode="json"),
            "split": None if config.score == "paper" else (dataset.split or config.split).model_dump(mode="json"),
        }
        number = place + 1
        if dataset.simulate is not None:
            part = _simulated(dataset, dataset.simulate, dataset.name or f"simulated-{number}", common)
        elif dataset.rig is not None:
            with told_at(document, "datasets", place, "rig"):
                part = _rigs(dataset, dataset.rig, directory, common)
        else:
            try:
                with told_at(document, "datasets", place, "test_files"):
                    part = _files(dataset, directory, common)
            except FileNotFoundError as error:
                if not dataset.optional:
                    raise error_at(
                        document, ("datasets", place, "files"), f"{error}; correct the path under 'files'"
                    ) from None
                left_out.append(f"dataset '{dataset.name or number}' is left out: {error}")
                continue
        parts.append(replace(part, place=place))
    listed = Sources(parts)
    _refuse_equal_names(document, listed)
    return listed, left_out


def _refuse_equal_names(document: Document | None, listed: Sources) -> None:
    def identity(number: int) -> tuple[str, str]:
        dataset, tags = listed.named(number)
        return dataset, json.dumps(tags, sort_keys=True)

    hashes = np.fromiter((hash(identity(number)) for number in range(len(listed))), np.int64, len(listed))
    if len(np.unique(hashes)) == len(listed):
        return
    seen: set[tuple[str, str]] = set()
    for number in range(len(listed)):
        if identity(number) in seen:
            message = f"two datasets are called '{identity(number)[0]}'; give each another 'name'"
            raise error_at(document, ("datasets", listed.dataset(number), "name"), message)
        seen.add(identity(number))


def _describe(kind: str, common: Mapping[str, Any], **values: Any) -> str:
    return json.dumps({"kind": kind, **common, **values}, sort_keys=True)


def _simulated(dataset: Dataset, simulate: Simulate, name: str, common: Mapping[str, Any]) -> _Part:
    several = {key for key in ("amplitude", "frequency") if len(getattr(simulate, key)) > 1}
    fixed = simulate.model_dump(mode="json", exclude={"amplitude", "frequency", "noise_percent", "seeds"})
    fixed["motion"] = (dataset.motion or Motion.ROTARY).value
    lists: dict[str, list[Any]] = {
        "amplitude": simulate.amplitude,
        "frequency": simulate.frequency,
        "noise_percent": simulate.noise_percent,
        "seed": simulate.seeds,
    }
    shape = tuple(len(values) for values in lists.values())
    given = dataset.inertia if dataset.inertia is not None else simulate.inertia

    def varied(number: int) -> dict[str, Any]:
        places = np.unravel_index(number, shape)
        return {key: values[int(place)] for (key, values), place in zip(lists.items(), places, strict=True)}

    def named(number: int) -> tuple[str, dict[str, Any]]:
        tags = varied(number)
        return name, {key: value for key, value in tags.items() if key in several or key in ("noise_percent", "seed")}

    def described(number: int) -> str:
        return _describe("simulate", common, **fixed, **varied(number))

    return _Part(math.prod(shape), named, None if dataset.estimate_inertia else given, described)


def _rigs(dataset: Dataset, rig: str, directory: Path, common: Mapping[str, Any]) -> _Part:
    from fricmodels.rig.file import load_rig

    path = directory / rig
    if not os.path.isfile(path):  # not an error where the name is too long for one
        raise InputError(f"{path}: there is no such rig file")
    load_rig(path)
    checksum = hashlib.sha256(path.read_bytes()).hexdigest()

    def named(number: int) -> tuple[str, dict[str, Any]]:
        return dataset.name or path.stem, {"seed": dataset.seeds[number]}

    def described(number: int) -> str:
        return _describe("rig", common, file=str(path), checksum=checksum, seed=dataset.seeds[number])

    return _Part(len(dataset.seeds), named, dataset.inertia, described, (str(path),))


def _files(dataset: Dataset, directory: Path, common: Mapping[str, Any]) -> _Part:
    found = _matching(dataset.files or [], directory)
    tests = _matching(dataset.test_files, directory) if dataset.test_files is not None else []
    groups = 1 if dataset.together else len(found)
    if tests and groups > 1:
        raise InputError(
            "'test_files' goes with one training file, or with several that say 'together: true'; "
            "list the others as datasets of their own"
        )
    if tests and {*map(os.path.realpath, tests)} <= {*map(os.path.realpath, found)}:
        raise InputError("every one of 'test_files' is fitted, too; name a file that takes no part in the fit")
    reading = {
        "reader": dataset.reader,
        "columns": dataset.columns,
        "motion": dataset.motion.value if dataset.motion else None,
        "torque_constant": dataset.torque_constant,
        "runs": dataset.runs,
        "gaps": dataset.gaps,
    }

    def group(number: int) -> list[str]:
        return found if dataset.together else [found[number]]

    def named(number: int) -> tuple[str, dict[str, Any]]:
        paths = group(number)
        own = Path(paths[0]).stem + (f" and {len(paths) - 1} more" if len(paths) > 1 else "")
        return own if dataset.name is None else dataset.name if groups == 1 else f"{dataset.name}/{own}", {}

    def described(number: int) -> str:
        return _describe("files", common, files=group(number), test_files=tests, **reading)

    return _Part(groups, named, dataset.inertia, described, (*found, *tests))


def _matching(patterns: list[str], directory: Path) -> list[str]:
    found: dict[str, None] = {}
    for pattern in patterns:
        whole = str(directory / pattern)
        matches = [whole] if os.path.isfile(whole) else sorted(glob.glob(whole, recursive=True))
        files = [str(Path(match)) for match in matches if Path(match).is_file()]
        if not files:
            raise FileNotFoundError(f"there is no file '{pattern}' in {directory}")
        found.update(dict.fromkeys(files))
    return list(found)


@lru_cache(maxsize=8)
def load(source: Source) -> Loaded:
    """Read or simulate a recording, split it and prepare both parts.

    Raises:
        InputError: for anything in the file that cannot be used.
    """
    from fricmodels.readers import together

    values = source.values
    recording, tests = recordings_of(source)
    recording, *tests = (coasting(each, source.inertia) for each in (recording, *tests))
    preparation = Preparation.model_validate(values["preparation"])
    test: Recording | None
    if tests:
        train, test = recording, numbered_beside(together(tests), recording)
    elif values["split"] is None:
        train, test = recording, None
    else:
        train, test = split(recording.remembering(), Split.model_validate(values["split"]))
    usual = preparation == Preparation()
    score_as: Callable[[Recording], Recording] = prepared if usual else lambda part: prepare(part, preparation)
    measured = train
    if "velocity" not in measured:
        train = prepared(measured) if usual else prepare(measured, preparation.model_copy(update={"decimate": 1}))
    checksums = train.checksum + (test.checksum if test is not None else "")
    return Loaded(
        train,
        score_as(measured),
        score_as(test) if test is not None else None,
        recording.provenance.get("true_parameters"),
        hashlib.sha256(checksums.encode()).hexdigest(),
        *(_matters(source, (recording, *tests)) if values["kind"] == "files" else ((), ())),
    )


def _matters(source: Source, recordings: Sequence[Recording]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return what makes every answer nonsense, and what is worth a warning, a line each."""
    from fricmodels.logcheck import Severity, findings

    lines: dict[Severity, list[str]] = {severity: [] for severity in Severity}
    for recording in recordings:
        for finding in findings(recording, source.inertia):
            lines[finding.severity].append(f"{recording.provenance.get('source', recording.name)}: {finding}")
    return tuple(lines[Severity.STOP]), tuple(lines[Severity.WARN])


def recordings_of(source: Source) -> tuple[Recording, list[Recording]]:
    """Return a whole recording as it is read or simulated, and those that it is tested on, if they are others.

    Raises:
        InputError: for anything in a file that cannot be used.
    """
    values = source.values
    if values["kind"] == "simulate":
        return simulated(source.dataset, values), []
    if values["kind"] == "rig":
        from fricmodels.rig.file import load_rig

        rig = load_rig(values["file"]).model_copy(update={"seed": values["seed"]})
        return replace(rig.simulate(), name=source.dataset), []
    tests = [_read([file], values, f"{source.dataset}/{Path(file).stem}") for file in values["test_files"]]
    return _read(values["files"], values, source.dataset), tests


def _read(files: list[str], values: Mapping[str, Any], name: str) -> Recording:
    from fricmodels import readers

    recording = readers.read_together(
        files,
        columns=values["columns"],
        motion=Motion(values["motion"]) if values["motion"] else None,
        name=name,
        reader=values["reader"],
        torque_constant=values["torque_constant"],
        gaps=values.get("gaps"),
    )
    wanted = values["runs"]
    if wanted is None:
        return recording
    names = {str(number): int(number) for number in recording.run_numbers}
    names.update({str(name): int(number) for number, name in recording.provenance.get("runs", {}).items()})
    for name_of_run in wanted:
        if name_of_run not in names:
            raise InputError(
                f"{', '.join(files)}: there is no run '{name_of_run}'; it has {', '.join(list(names)[:20])}"
            )
    return recording.select(np.isin(recording.run, [names[name_of_run] for name_of_run in wanted]))
