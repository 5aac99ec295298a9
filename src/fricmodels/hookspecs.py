"""The hooks through which laws, effects, estimators and readers register, built-in ones included.

A plugin is a distribution with an entry point in the group ``fricmodels`` that names a module with hook
implementations::

    from fricmodels import hookimpl

    @hookimpl
    def fricmodels_laws():
        return [MyLaw]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from fricmodels.estimator import Estimator
    from fricmodels.readers.base import Reader
    from fricmodels.term import Effect, Law

hookspec = pluggy.HookspecMarker("fricmodels")
hookimpl = pluggy.HookimplMarker("fricmodels")


@hookspec
def fricmodels_laws() -> list[type[Law]]:  # type: ignore[empty-body]
    """Return friction laws."""


@hookspec
def fricmodels_effects() -> list[type[Effect]]:  # type: ignore[empty-body]
    """Return effects that can be added to a law."""


@hookspec
def fricmodels_estimators() -> list[type[Estimator]]:  # type: ignore[empty-body]
    """Return estimators."""


@hookspec
def fricmodels_readers() -> list[type[Reader]]:  # type: ignore[empty-body]
    """Return readers of recordings."""
