"""Tournaments: recordings × models × estimators, from YAML to a ranked leaderboard."""

from __future__ import annotations

from fricmodels.tournament.config import Config, load_config
from fricmodels.tournament.leaderboard import Leaderboard
from fricmodels.tournament.planning import Plan, plan
from fricmodels.tournament.running import Interrupted, run

__all__ = ["Config", "Interrupted", "Leaderboard", "Plan", "load_config", "plan", "run"]
