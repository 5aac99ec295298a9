"""The rig: a simulated drive with known truth, hidden effects and real sensors.

Its physics is written apart from the laws and effects that are identified, with finer steps and exact sticking, so
that finding a hidden effect is no tautology.
"""

from __future__ import annotations

from fricmodels.rig.rig import Friction, Load, Rig
from fricmodels.rig.sensors import Sensors

__all__ = ["Friction", "Load", "Rig", "Sensors"]
