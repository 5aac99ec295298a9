"""Tournaments: recordings × models × estimators, from YAML to a ranked leaderboard.

Names are imported when first used: a part of this package needs few of the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.lazy import first_use

if TYPE_CHECKING:
    from fricmodels.tournament.config import Config, load_config
    from fricmodels.tournament.leaderboard import Leaderboard
    from fricmodels.tournament.planning import Plan, plan
    from fricmodels.tournament.running import Interrupted, run

_HOMES = {
    "Config": "fricmodels.tournament.config",
    "Interrupted": "fricmodels.tournament.running",
    "Leaderboard": "fricmodels.tournament.leaderboard",
    "Plan": "fricmodels.tournament.planning",
    "load_config": "fricmodels.tournament.config",
    "plan": "fricmodels.tournament.planning",
    "run": "fricmodels.tournament.running",
}

__all__ = [
    "Config",
    "Interrupted",
    "Leaderboard",
    "Plan",
    "load_config",
    "plan",
    "run",
]


__getattr__ = first_use(__name__, _HOMES)
