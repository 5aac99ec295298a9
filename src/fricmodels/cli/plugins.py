"""``fricmodels plugins``: installed distributions, what they give, and their state."""

from __future__ import annotations


def command() -> None:
    """List installed distributions with their version, what they give, and their state."""
    from fricmodels import plugins
    from fricmodels.cli.printing import print_table
    from fricmodels.export.columns import Column

    registered = plugins.load()
    gives: dict[str, list[str]] = {}
    for kind, registry in registered.registries.items():
        for name in registry.names:
            gives.setdefault(registry.entry(name).distribution, []).append(f"{kind} {name}")
    problems = [*registered.failures, *registered.unsafe]
    for failure in problems:
        gives.setdefault(failure.distribution, [])
    rows = [
        (
            distribution,
            plugins.version_of(distribution) or "?",
            _given(distribution, names),
            "; ".join(f.reason for f in problems if f.distribution == distribution) or "ok",
        )
        for distribution, names in sorted(gives.items())
    ]
    titles = ("distribution", "version", "gives", "state")
    print_table([Column(title, cells) for title, cells in zip(titles, zip(*rows, strict=True), strict=True)])


def _given(distribution: str, names: list[str]) -> str:
    kinds = dict.fromkeys(name.partition(" ")[0] for name in names)
    if distribution != "fricmodels":
        own = {kind: [name.removeprefix(f"{kind} ") for name in names if name.startswith(f"{kind} ")] for kind in kinds}
        return ", ".join(f"{kind}{'s' * (len(all_) > 1)} {', '.join(all_)}" for kind, all_ in own.items()) or "nothing"
    counts = {kind: sum(name.startswith(f"{kind} ") for name in names) for kind in kinds}
    return ", ".join(f"{count} {kind}s" for kind, count in counts.items())
