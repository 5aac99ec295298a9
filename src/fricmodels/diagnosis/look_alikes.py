"""Which experiment would tell effects apart that explain the same data, as the effects themselves declare it."""

from __future__ import annotations

from itertools import combinations

from fricmodels import plugins


def experiment(first: str, second: str) -> str:
    """Return the experiment that would separate two effects, in words."""
    one, other = sorted((first, second))
    return declared(first, second) or f"a recording in which '{one}' and '{other}' vary independently"


def declared(first: str, second: str) -> str:
    """Return the experiment that either of two effects declares; empty where neither does."""
    effects = plugins.load().effects
    one, other = sorted(name.partition("(")[0] for name in (first, second))
    return effects[one].separated_from.get(other) or effects[other].separated_from.get(one, "")


def separated_by(members: list[str]) -> str:
    """Return the experiments that would separate the members of a class, at most two; empty for a class of one."""
    texts = dict.fromkeys(experiment(first, second) for first, second in combinations(members, 2))
    return "; ".join([*texts][:2])
