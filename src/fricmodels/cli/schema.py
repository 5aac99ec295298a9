"""``fricmodels schema``: what a configuration may contain, for editors."""

from __future__ import annotations


def command() -> None:
    """Print the JSON Schema of a configuration, for editors."""
    import json

    from fricmodels.tournament.config import Config

    print(json.dumps(Config.model_json_schema(), indent=1, ensure_ascii=False))
