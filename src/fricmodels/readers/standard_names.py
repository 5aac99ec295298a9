"""Standard names of columns, by kind of motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fricmodels.dimension import Motion

ROTARY = {
    "time": "time_s",
    "torque": "torque_Nm",
    "velocity": "velocity_rad_s",
    "position": "position_rad",
    "acceleration": "acceleration_rad_s2",
    "load_torque": "load_torque_Nm",
    "temperature": "temperature_degC",
    "current": "current_A",
    "run": "run",
}
LINEAR = {  # what is called otherwise there
    "torque": "force_N",
    "velocity": "velocity_m_s",
    "position": "position_m",
    "acceleration": "acceleration_m_s2",
    "load_torque": "load_force_N",
}
STANDARD: Mapping[Motion, Mapping[str, str]] = {Motion.ROTARY: ROTARY, Motion.LINEAR: {**ROTARY, **LINEAR}}
"""Standard column of each channel, by kind of motion."""

ALIASES = {"force": "torque", "load_force": "load_torque"}
NAMES = (*ROTARY, *ALIASES)
"""Channel names that a mapping may use; ``force`` and ``load_force`` are those of a linear axis."""
SPOKEN = {"speed": "velocity"}
"""Other names that a column with a unit may have."""


def standard_columns(motion: Motion, present: Sequence[str]) -> dict[str, str]:
    """Return the column of each channel that has its standard name; in other letter case, if only one is called so.

    ``current_a`` may be that of a phase.
    """
    found: dict[str, str] = {}
    for channel, name in STANDARD[motion].items():
        alike = [column for column in present if column.lower() == name.lower()]
        if name in present:
            found[channel] = name
        elif len(alike) == 1 and channel != "current":
            found[channel] = alike[0]
    return found
