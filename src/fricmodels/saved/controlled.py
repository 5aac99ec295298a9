"""The controller in a model's file: put there by a fit to the motion, taken from there to simulate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.loop import PREFIX, Loop
from fricmodels.motion import Controller, MotionFit, PluginController, Simulator, check_controller, stored_controller
from fricmodels.recording import Recording
from fricmodels.results.part import finite
from fricmodels.saved.document import StoredController, StoredParameter
from fricmodels.saved.fitted import FittedModel


def with_controller(model: FittedModel, controller: Controller | PluginController, fit: MotionFit) -> FittedModel:
    """Return a model that carries the controller through which it was fitted, with what was found of it.

    Args:
        model: the model. controller: as it was written. fit: to the motion, through it.
    """
    loop, errors = controller.loop(), fit.standard_errors
    found = {
        p.symbol: StoredParameter(
            value=fit.parameters[f"{PREFIX}{p.symbol}"],
            unit=p.unit_for(model.motion),
            meaning=p.meaning,
            standard_error=finite(errors.get(f"{PREFIX}{p.symbol}")),
        )
        for p in loop.free
    }
    distribution, version = _brought_by(controller)
    stored = StoredController(
        settings=controller.model_dump(mode="json", exclude_none=True, exclude_defaults=True),
        distribution=distribution,
        version=version,
        parameters=found,
    )
    return FittedModel(model.document.model_copy(update={"controller": stored}), model=model.model)


def controller_of(model: FittedModel) -> Controller | PluginController | None:
    """Return the controller that a model carries, or ``None``.

    Raises:
        InputError: where the plugin that brings it is not installed, or does not know it any more.
    """
    stored = model.document.controller
    if stored is None:
        return None
    try:
        return stored_controller(stored.settings)
    except InputError as error:
        version = f" {stored.version}" if stored.version else ""
        raise InputError(
            f"'{model.name}' was fitted through a controller of {stored.distribution}{version}: {error}"
        ) from None


def found_of(model: FittedModel) -> dict[str, float]:
    """Return what was found of the controller that a model carries, by key (``loop.k_t``)."""
    stored = model.document.controller
    return {} if stored is None else {f"{PREFIX}{symbol}": p.value for symbol, p in stored.parameters.items()}


def closed_loop(model: FittedModel, recording: Recording) -> Recording:
    """Return the motion of a model under the controller that it carries, from the reference of a recording.

    Each run starts from its own first state.

    Raises:
        InputError: where the model carries none, or the recording lacks a channel that it follows.
    """
    from fricmodels.weakform.prepared import ready

    controller = controller_of(model)
    if controller is None:
        raise InputError(
            f"'{model.name}' carries no controller; fit it through one: fricmodels fit DATA --objective position "
            f"--controller FILE.yaml"
        )
    whole = ready(recording)
    check_controller(controller, frozenset(whole.channels), whole.name)
    loop: Loop = controller.loop()
    values: Mapping[str, float] = {**model.parameters, **found_of(model)}
    position, velocity = Simulator(model.drive, whole, loop=loop)(values)
    kept = {name: np.asarray(whole[name]) for name in ("time", *loop.channels) if name in whole}
    channels = {**kept, "torque": whole.torque, "velocity": velocity, "position": position}
    return Recording("simulated", whole.motion, channels, whole.run, units=whole.units)


def _brought_by(controller: Controller | PluginController) -> tuple[str, str | None]:
    if isinstance(controller, Controller):
        return "fricmodels", None
    distribution = plugins.load().controllers.entry(controller.kind).distribution
    return distribution, plugins.version_of(distribution)
