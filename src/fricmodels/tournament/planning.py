"""What a tournament will do: every job of it, checked before anything is written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.tournament.config import Config
from fricmodels.tournament.listed import Jobs
from fricmodels.tournament.sources import Loaded, Source, load, sources
from fricmodels.tournament.told import as_keys, told_at
from fricmodels.yaml_file import Document


@dataclass(frozen=True)
class Plan:
    """All jobs of a tournament, checked against the recordings; nothing has been written yet.

    Attributes:
        config, jobs: what is run.
        left_out: one line for each optional dataset that is not there.
        digests: checksum of each recording that was read from a file, by its number.
        doubts: what is the matter with the recordings, a line each.
    """

    config: Config
    jobs: Jobs
    left_out: tuple[str, ...]
    digests: Mapping[int, str] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()


def plan(config: Config, directory: str | Path = ".", *, trust: bool = True, document: Document | None = None) -> Plan:
    """Read every file once, check that each model has the channels that it needs, and list the jobs.

    Args:
        config: the tournament.
        directory: where its relative paths start; that of its file.
        trust: go on with recordings whose units, signs or columns look so wrong that every answer would be nonsense.
        document: the file that the tournament was read from; errors name its lines.

    Raises:
        InputError: for anything that cannot be used, before anything is written.
    """
    titles: dict[str, str] = {}
    for entrant in config.entrants:
        content = entrant.model_dump_json(exclude={"label"})
        if titles.setdefault(entrant.title, content) != content:
            raise InputError(f"two estimators are called '{entrant.title}'; give one of them another 'label'")
    listed, left_out = sources(config, Path(directory), document)
    models = [model for name in config.model_names if (model := _built_in(name)) is not None]
    digests: dict[int, str] = {}
    doubts: list[str] = []
    for number, source in enumerate(listed):
        if source.values["kind"] == "files":
            with told_at(document, "datasets", listed.dataset(number)):
                loaded = _checked(source, models)
                _check_motion(config, loaded)
                if loaded.nonsense and not trust:
                    raise InputError(f"{loaded.nonsense[0]}, or go on with --trust")
            digests[number] = loaded.digest
            doubts += map(as_keys, (*loaded.nonsense, *loaded.doubts))
    if not plugins.load().estimators:
        raise InputError("no estimator is registered; install the distribution that has them")
    return Plan(config, Jobs(config, listed, digests), tuple(left_out), digests, tuple(dict.fromkeys(doubts)))


def _check_motion(config: Config, loaded: Loaded) -> None:
    """Refuse a recording without what the score of a simulated position needs."""
    from fricmodels.motion import check_controller

    if config.score != "position":
        return
    scored = loaded.prepared_test if loaded.prepared_test is not None else loaded.prepared_train
    if not scored.measures("position"):
        raise InputError(
            f"score: position needs the position, which recording '{scored.name}' does not have; "
            f"map a column under 'columns: {{position: COLUMN}}', or take score: held-out"
        )
    if config.controller is not None:
        check_controller(config.controller, frozenset(scored.channels), scored.name)


def _built_in(name: str) -> Model | None:
    """Return a model of which no part comes from a plugin, whose code runs in workers only: it may hang or crash."""
    try:
        model = Model.parse(name)
    except plugins.LeftOut:
        return None
    registered = plugins.load()
    entries: list[plugins.Registered[Any]] = [registered.laws.entry(model.law.name)]
    entries += [registered.effects.entry(effect.name) for effect in model.effects]
    return model if all(entry.distribution == "fricmodels" for entry in entries) else None


def _checked(source: Source, models: list[Model]) -> Loaded:
    loaded = load(source)
    for model in models:
        for part in (loaded.prepared_train, loaded.prepared_test):
            if part is not None:
                part.require(model.required, model.name)
    return loaded
