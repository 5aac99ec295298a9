"""``fricmodels list``: what is registered, and who provides it."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from fricmodels.dimension import Motion


class Kind(StrEnum):
    """What can be listed."""

    LAWS = "laws"
    EFFECTS = "effects"
    ESTIMATORS = "estimators"
    READERS = "readers"
    CONTROLLERS = "controllers"
    DATASETS = "datasets"


def command(
    kind: Annotated[Kind, typer.Argument(help="What to list.", show_default=False)],
    config: Annotated[Path | None, typer.Option(help="The tournament whose data sets are listed.")] = None,
    linear: Annotated[bool, typer.Option("--linear", help="Units of a linear axis instead of a rotary drive.")] = False,
) -> None:
    """List laws, effects, estimators, readers, controllers of plugins, or the data sets of a run.

    Each with its equation, its parameters with units, and the distribution that it comes from.
    """
    from fricmodels import plugins
    from fricmodels.cli.printing import print_table, warn
    from fricmodels.dimension import Motion
    from fricmodels.errors import InputError
    from fricmodels.export.columns import Column

    if config is not None and kind is not Kind.DATASETS:
        raise InputError(f"--config goes with 'list datasets'; leave it out to list {kind.value}")
    registered = plugins.load()
    warn(registered.failures)
    motion = Motion.LINEAR if linear else Motion.ROTARY
    registry: Any = getattr(registered, kind.value, None)
    entries = [] if registry is None else [(name, registry.entry(name)) for name in registry.names]
    if kind is Kind.DATASETS:
        rows, titles = _datasets(config), ["name", "recordings", "from"]
    elif kind in (Kind.LAWS, Kind.EFFECTS):
        rows = [[name, e.cls.formula, _parameters(e.cls, motion), e.distribution] for name, e in entries]
        titles = ["name", "equation", "parameters", "distribution"]
    elif kind is Kind.ESTIMATORS:
        rows = [[name, e.cls.summary, ", ".join(e.cls.Settings.model_fields), e.distribution] for name, e in entries]
        titles = ["name", "what it does", "settings", "distribution"]
    elif kind is Kind.CONTROLLERS:
        rows = [[name, ", ".join(e.cls.channels), _parameters(e.cls, motion), e.distribution] for name, e in entries]
        titles = ["name", "follows", "parameters", "distribution"]
    else:
        rows = [[name, " ".join(e.cls.suffixes), e.distribution] for name, e in entries]
        titles = ["name", "files", "distribution"]
    cells = list(zip(*rows, strict=True)) or [()] * len(titles)
    print_table([Column(title, tuple(column)) for title, column in zip(titles, cells, strict=True)])


def _parameters(cls: Any, motion: Motion) -> str:
    return ", ".join(f"{p.symbol} [{p.unit_for(motion)}]" for p in cls.parameters)


def _datasets(config: Path | None) -> list[list[str]]:
    from fricmodels.errors import InputError
    from fricmodels.tournament.config import read_config
    from fricmodels.tournament.sources import sources

    if config is None:
        raise InputError("to list data sets, say of which tournament: fricmodels list datasets --config CONFIG.yaml")
    read, document = read_config(config)
    listed, _ = sources(read, config.parent, document)
    first: dict[str, int] = {}
    counts: dict[str, int] = {}
    for number in range(len(listed)):
        name, _ = listed.named(number)
        first.setdefault(name, number)
        counts[name] = counts.get(name, 0) + 1
    rows = []
    for name, number in first.items():
        values = listed[number].values
        what = ", ".join(values.get("files", [])) or values.get("file") or f"simulated {values['model']}"
        rows.append([name, str(counts[name]), what])
    return rows
