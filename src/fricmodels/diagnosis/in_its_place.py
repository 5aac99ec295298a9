"""The final model of a ladder with a look-alike in the place of an effect: which values hold with that."""

from __future__ import annotations

from collections.abc import Iterator

from fricmodels import plugins
from fricmodels.diagnosis.comparison import Comparison, refitted
from fricmodels.diagnosis.ladder import Ladder, added
from fricmodels.errors import FricmodelsError
from fricmodels.once import once

_MOST = 3
"""Look-alikes of one effect that are fitted: each costs a fit."""


@once
def in_its_place(ladder: Ladder) -> dict[str, tuple[Comparison, ...]]:
    """Return by effect the final model with each of its look-alikes in its place, fitted.

    Look-alikes whose parameters have to be searched for are left out, and such as cannot be fitted there.
    """
    return {finding.names[0]: tuple(_others(ladder, *finding.names)) for finding in added(ladder)}


def _others(ladder: Ladder, name: str, *alike: str) -> Iterator[Comparison]:
    last, known = ladder.rungs[-1].comparison, plugins.load().effects
    own = {effect.name for effect in last.drive.model.effects}
    if name not in own:
        return
    for other in [one for one in alike if one in known.names and one not in own][:_MOST]:
        effect = known[other]()
        if effect.states or any(p.scan for p in effect.parameters):
            continue
        try:
            yield refitted(last, last.drive.model.minus(name).plus(effect), last.estimate.parameters)
        except FricmodelsError:
            continue
