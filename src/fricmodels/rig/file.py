"""Rig files: YAML in, errors that name file, line and key."""

from __future__ import annotations

from pathlib import Path

from fricmodels.rig.rig import Rig


def load_rig(path: str | Path) -> Rig:
    """Read a rig file.

    Raises:
        InputError: for a file that is not there, is not YAML, or does not describe a rig; names line and key.
    """
    from fricmodels.documents import read_yaml, validate

    document = read_yaml(path)
    if isinstance(document.content, dict):
        document.content.setdefault("name", document.file.stem)
    return validate(document, Rig)
