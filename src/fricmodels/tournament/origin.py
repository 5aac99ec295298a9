"""What a tournament was made of: configuration, recordings with their checksums, versions; the file ``run.json``."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmodels import plugins
from fricmodels.files import write_listed
from fricmodels.stored import as_written, read_results
from fricmodels.tournament.sources import Source

if TYPE_CHECKING:
    from fricmodels.tournament.planning import Plan

SCHEMA = "fricmodels/run/1"
FILE = "run.json"


@dataclass(frozen=True)
class Origin:
    """What a run was made of.

    Attributes:
        config: the configuration, as it was given.
        config_file: where it was read from; empty where it was made in a program.
        sources: every recording.
        digests: checksum of each recording that was read from a file.
        versions: of all programs that took part.
        left_out: optional datasets that were not there.
    """

    config: Mapping[str, Any]
    config_file: str
    sources: tuple[Source, ...]
    digests: Mapping[Source, str]
    versions: Mapping[str, str]
    left_out: tuple[str, ...]


def write_origin(directory: Path, plan: Plan, config_file: str | Path | None) -> Path:
    """Write ``run.json`` beside the leaderboard."""
    content = {
        "schema": SCHEMA,
        "config": plan.config.model_dump(mode="json", exclude_unset=True, by_alias=True),
        "config_file": "" if config_file is None else str(config_file),
        "working_directory": str(Path.cwd()),
        "versions": plugins.versions(),
        "left_out": list(plan.left_out),
    }
    sources = (
        {
            "dataset": source.dataset,
            "tags": dict(source.tags),
            "inertia": source.inertia,
            "description": source.description,
            "digest": plan.digests.get(number, ""),
        }
        for number, source in enumerate(plan.jobs.sources)
    )
    write_listed(directory / FILE, content, "sources", sources)
    return directory / FILE


def read_origin(directory: Path) -> Origin | None:
    """Read ``run.json`` of a finished run; ``None`` where there is none, as in runs of old versions.

    Relative paths of recordings are taken from where the run was started, unless they are there from here.

    Raises:
        InputError: when the file cannot be read, or is of another kind.
    """
    path = directory / FILE
    again = "fricmodels run CONFIG.yaml --out DIR"
    try:
        content = read_results(path, SCHEMA, again)
    except FileNotFoundError:
        return None
    with as_written(path, again):
        return _origin(content)


def _origin(content: Mapping[str, Any]) -> Origin:
    started = Path(content["working_directory"])
    sources, digests = [], {}
    for each in content["sources"]:
        source = Source(each["dataset"], dict(each["tags"]), each["inertia"], _found(each["description"], started))
        sources.append(source)
        if each["digest"]:
            digests[source] = each["digest"]
    return Origin(
        dict(content["config"]),
        content["config_file"],
        tuple(sources),
        digests,
        dict(content["versions"]),
        tuple(content["left_out"]),
    )


def _found(description: str, started: Path) -> str:
    """Return a description whose files are looked for where the run was started."""
    values = json.loads(description)

    def place(file: str) -> str:
        return file if Path(file).exists() else str(started / file)

    if "file" in values:
        values["file"] = place(values["file"])
    for files in ("files", "test_files"):
        if files in values:
            values[files] = [place(file) for file in values[files]]
    return json.dumps(values, sort_keys=True)
