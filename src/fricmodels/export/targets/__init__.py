"""A fitted model for another program: C, MuJoCo, URDF, Isaac Lab, Drake, ROS 2, JSON."""

from __future__ import annotations

from fricmodels.export.targets.targets import TARGETS, Exported, export_model

__all__ = ["TARGETS", "Exported", "export_model"]
