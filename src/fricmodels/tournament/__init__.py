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
    "fricmodels.tournament.config": ("Config", "load_config"),
    "fricmodels.tournament.leaderboard": ("Leaderboard",),
    "fricmodels.tournament.planning": ("Plan", "plan"),
    "fricmodels.tournament.running": ("Interrupted", "run"),
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
