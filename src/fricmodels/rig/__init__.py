"""The rig: a simulated drive with known truth, hidden effects and real sensors.

Its physics is written apart from the laws and effects that are identified, with finer steps and exact sticking, so
that finding a hidden effect is no tautology.
"""

from __future__ import annotations

from fricmodels.rig.draw import SCALES, random_rig, strength, with_size
from fricmodels.rig.file import load_rig
from fricmodels.rig.rig import Friction, Load, Rig
from fricmodels.rig.sensors import Sensors
from fricmodels.rig.write import write

__all__ = ["SCALES", "Friction", "Load", "Rig", "Sensors", "load_rig", "random_rig", "strength", "with_size", "write"]
