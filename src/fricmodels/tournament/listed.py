"""The jobs of a tournament: every recording by every model with every estimator, each made when its turn comes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from fricmodels.arrays import Index
from fricmodels.tournament.code import code_of
from fricmodels.tournament.config import Config
from fricmodels.tournament.jobs import Group, Job
from fricmodels.tournament.sources import Source, Sources


@dataclass(frozen=True)
class _Kind:
    """What all jobs of one model and one estimator have in common."""

    model: str
    estimator: str
    title: str
    settings: str
    decides: tuple[Any, ...]


class Jobs(Sequence[Job]):
    """Every combination of recording, model and estimator, those that share compiled code together.

    None is held: a job is made from its number when it is asked for.

    Args:
        config: the tournament.
        sources: its recordings.
        digests: checksum of each recording that was read from a file, by its number.
        places: numbers of the combinations that are meant, in order; all by default.
    """

    def __init__(
        self, config: Config, sources: Sources, digests: Mapping[int, str], places: Index | None = None
    ) -> None:
        self.sources = sources
        self._config, self._digests = config, digests
        self._measure = "torque" if config.score == "held-out" else config.score
        self._controller = "" if config.controller is None else config.controller.model_dump_json()
        self._kinds = [
            self._kind(model, number) for model in config.model_names for number in range(len(config.entrants))
        ]
        self._places = places

    def _kind(self, model: str, number: int) -> _Kind:
        config, entrant = self._config, self._config.entrants[number]
        settings = json.dumps(entrant.settings, sort_keys=True)
        what: tuple[Any, ...] = (model, entrant.name, settings, self._measure, config.simulate, config.decimate)
        if self._measure == "position":
            what = (*what, config.horizon, self._controller)
        return _Kind(model, entrant.name, entrant.title, settings, what)

    def __len__(self) -> int:
        return len(self._kinds) * len(self.sources) if self._places is None else len(self._places)

    @overload
    def __getitem__(self, number: int) -> Job: ...

    @overload
    def __getitem__(self, number: slice) -> list[Job]: ...

    def __getitem__(self, number: int | slice) -> Job | list[Job]:
        if isinstance(number, slice):
            return [self[each] for each in range(*number.indices(len(self)))]
        kind, place = self._found(number)
        source = self.sources[place]
        return Job(
            self._key(kind, source, place),
            source,
            kind.model,
            kind.estimator,
            kind.title,
            kind.settings,
            self._measure,
            self._config.simulate,
            self._config.decimate,
            horizon=self._config.horizon,
            controller=self._controller,
        )

    def named(self, number: int) -> dict[str, Any]:
        """Return what a job's row is called in this tournament: its estimator, dataset and tags."""
        kind, place = self._found(number)
        dataset, tags = self.sources.named(place)
        return {"estimator": kind.title, "dataset": dataset, "tags": tags}

    def only(self, places: Index) -> Jobs:
        """Return those with these numbers."""
        kept = places if self._places is None else self._places[places]
        return Jobs(self._config, self.sources, self._digests, kept)

    def groups(self) -> Iterator[tuple[Group, range]]:
        """Return the numbers of the jobs that share compiled code; a group may come more than once."""
        for number, kind in enumerate(self._kinds):
            edges = np.array([number, number + 1]) * len(self.sources)
            begin, end = edges if self._places is None else np.searchsorted(self._places, edges)
            if begin < end:
                yield (kind.model, kind.estimator, kind.settings), range(int(begin), int(end))

    def _found(self, number: int) -> tuple[_Kind, int]:
        if not -len(self) <= number < len(self):
            raise IndexError(f"there are {len(self)} jobs, none with the number {number}")
        place = number % len(self) if self._places is None else int(self._places[number])
        kind, source = divmod(place, len(self.sources))
        return self._kinds[kind], source

    def _key(self, kind: _Kind, source: Source, place: int) -> str:
        code = code_of(kind.estimator, kind.model, *source.models)
        decides = (code, *kind.decides, source.description, source.inertia, self._digests.get(place, ""))
        return hashlib.sha256(json.dumps(decides, sort_keys=True).encode()).hexdigest()
