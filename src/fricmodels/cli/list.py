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
    from fricmodels.export.columns import Column

    registered = plugins.load()
    warn(registered.failures)
    motion = Motion.LINEAR if linear else Motion.ROTARY
    if kind is Kind.DATASETS:
        rows, titles = _datasets(config), ["name", "recordings", "from"]
    elif kind in (Kind.LAWS, Kind.EFFECTS):
        registry = registered.laws if kind is Kind.LAWS else registered.effects
        rows, titles = _terms(registry, motion), ["name", "equation", "parameters", "distribution"]
    elif kind is Kind.ESTIMATORS:
        entries = [(name, registered.estimators.entry(name)) for name in registered.estimators]
        rows = [[name, e.cls.summary, ", ".join(e.cls.Settings.model_fields), e.distribution] for name, e in entries]
        titles = ["name", "what it does", "settings", "distribution"]
    elif kind is Kind.CONTROLLERS:
        rows = []
        for name in registered.controllers:
            entry = registered.controllers.entry(name)
            parameters = ", ".join(f"{p.symbol} [{p.unit_for(motion)}]" for p in entry.cls.parameters)
            rows.append([name, ", ".join(entry.cls.channels), parameters, entry.distribution])
        titles = ["name", "follows", "parameters", "distribution"]
    else:
        readers = [(name, registered.readers.entry(name)) for name in registered.readers]
        rows = [[name, " ".join(e.cls.suffixes), e.distribution] for name, e in readers]
        titles = ["name", "files", "distribution"]
    cells = list(zip(*rows, strict=True)) or [()] * len(titles)
    print_table([Column(title, tuple(column)) for title, column in zip(titles, cells, strict=True)])


def _terms(registry: Any, motion: Motion) -> list[list[str]]:
    rows = []
    for name in registry.names:
        entry = registry.entry(name)
        parameters = ", ".join(f"{p.symbol} [{p.unit_for(motion)}]" for p in entry.cls.parameters)
        rows.append([name, entry.cls.formula, parameters, entry.distribution])
    return rows


def _datasets(config: Path | None) -> list[list[str]]:
    from fricmodels.errors import InputError
    from fricmodels.tournament import load_config
    from fricmodels.tournament.sources import sources

    if config is None:
        raise InputError("to list data sets, say of which tournament: fricmodels list datasets --config CONFIG.yaml")
    listed, _ = sources(load_config(config), config.parent)
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
