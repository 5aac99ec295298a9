"""``fricmodels schema``: what a configuration may contain, for editors, and what stands in files of results."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer


class Kind(StrEnum):
    """Files that have a schema."""

    CONFIG = "config"
    DIAGNOSIS = "diagnosis"
    LEADERBOARD = "leaderboard"


def command(
    kind: Annotated[Kind, typer.Argument(help="Of a configuration, of diagnosis.json or of leaderboard.json.")] = (
        Kind.CONFIG
    ),
) -> None:
    """Print the JSON Schema of a configuration, for editors, or of a file of results, for other programs."""
    import json

    from pydantic import BaseModel

    document: type[BaseModel]
    if kind is Kind.DIAGNOSIS:
        from fricmodels.results.diagnosis import DiagnosisDocument as document
    elif kind is Kind.LEADERBOARD:
        from fricmodels.results.leaderboard import LeaderboardDocument as document
    else:
        from fricmodels.tournament.config import Config as document
    print(json.dumps(document.model_json_schema(), indent=1, ensure_ascii=False))
