"""The hooks through which laws, effects, estimators, readers and controllers register, built-in ones included.

A plugin is a distribution with an entry point in the group ``fricmodels`` that names a module with hook
implementations::

    from fricmodels import hookimpl

    @hookimpl
    def fricmodels_laws():
        return [MyLaw]

A module may say for which version of the interface it is written: ``fricmodels_interface = 1``.
"""

from __future__ import annotations

import pluggy

INTERFACE = 1
"""Version of the plugin interface: it goes up when a plugin that follows ``docs/plugin-interface.md`` has to change."""

hookspec = pluggy.HookspecMarker("fricmodels")
hookimpl = pluggy.HookimplMarker("fricmodels")


@hookspec
def fricmodels_laws() -> list[type]:  # type: ignore[empty-body]
    """Return friction laws: subclasses of :class:`fricmodels.Law`."""


@hookspec
def fricmodels_effects() -> list[type]:  # type: ignore[empty-body]
    """Return effects that can be added to a law: subclasses of :class:`fricmodels.Effect`."""


@hookspec
def fricmodels_estimators() -> list[type]:  # type: ignore[empty-body]
    """Return estimators: subclasses of :class:`fricmodels.Estimator`."""


@hookspec
def fricmodels_readers() -> list[type]:  # type: ignore[empty-body]
    """Return readers of recordings: subclasses of :class:`fricmodels.readers.base.Reader`."""


@hookspec
def fricmodels_controllers() -> list[type]:  # type: ignore[empty-body]
    """Return controllers that drive a simulation: subclasses of :class:`fricmodels.loop.Loop`."""
