"""Simulated motion: how far a model's motion goes from the measured one, and the parameters that bring it nearest.

Names are imported when first used: a part of this package needs few of the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.lazy import first_use

if TYPE_CHECKING:
    from fricmodels.motion.between import torque_between_samples
    from fricmodels.motion.choose import Judged, Rung, judged
    from fricmodels.motion.controllers import (
        AnyController,
        Controller,
        Motor,
        PluginController,
        check_controller,
        read_controller,
        stored_controller,
    )
    from fricmodels.motion.errors import MotionErrors, motion_errors
    from fricmodels.motion.fit import MotionFit, fit_motion
    from fricmodels.motion.replay import Replay, Replays, Stretch, replayed, stretch_of, undetermined
    from fricmodels.motion.simulator import Simulator
    from fricmodels.motion.start import state_at

_HOMES = {
    "fricmodels.motion.between": ("torque_between_samples",),
    "fricmodels.motion.choose": ("Judged", "Rung", "judged"),
    "fricmodels.motion.controllers": (
        "AnyController",
        "Controller",
        "Motor",
        "PluginController",
        "check_controller",
        "read_controller",
        "stored_controller",
    ),
    "fricmodels.motion.errors": ("MotionErrors", "motion_errors"),
    "fricmodels.motion.fit": ("MotionFit", "fit_motion"),
    "fricmodels.motion.replay": ("Replay", "Replays", "Stretch", "replayed", "stretch_of", "undetermined"),
    "fricmodels.motion.simulator": ("Simulator",),
    "fricmodels.motion.start": ("state_at",),
}

__all__ = [
    "AnyController",
    "Controller",
    "Judged",
    "MotionErrors",
    "MotionFit",
    "Motor",
    "PluginController",
    "Replay",
    "Replays",
    "Rung",
    "Simulator",
    "Stretch",
    "check_controller",
    "fit_motion",
    "judged",
    "motion_errors",
    "read_controller",
    "replayed",
    "state_at",
    "stored_controller",
    "stretch_of",
    "torque_between_samples",
    "undetermined",
]


__getattr__ = first_use(__name__, _HOMES)
