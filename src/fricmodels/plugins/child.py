"""The process that tries a plugin; see :mod:`fricmodels.plugins.probe`."""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress

from fricmodels.plugins.loading import survive
from fricmodels.plugins.probe import SURVIVED
from fricmodels.processes import end_with_parent

_MEMORY = 8 << 30
"""Bytes of addresses that it may take; libraries reserve much and use little."""


def run(name: str, value: str, skip: str, parent: str) -> None:
    """Try a plugin in this process; its exit code says whether it came to the end, its output what it did last."""
    end_with_parent(int(parent))
    heard = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    with suppress(ImportError):  # not on Windows
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))

    def doing(*what: str) -> None:
        os.write(heard, json.dumps(what).encode() + b"\n")

    survive(name, value, [(kind, of) for kind, of in json.loads(skip)], doing)
    sys.exit(SURVIVED)
