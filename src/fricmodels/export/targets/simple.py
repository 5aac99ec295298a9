"""URDF, Isaac Lab, Drake and ROS 2: targets that take a few numbers for each joint."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.drive import Drive
from fricmodels.export.targets.nearest import Nearest
from fricmodels.export.targets.validity import motion_over
from fricmodels.saved import FittedModel


def number(value: float) -> str:
    """Return a number as it is read back, to the last bit."""
    return repr(float(value))


def xml_comment(lines: list[str]) -> str:
    """Return lines as a comment of XML; nothing in them ends it."""
    text = "\n".join(f"  {line}" for line in lines).replace("--", "- -")
    return f"<!--\n{text}\n-->"


def urdf_values(found: Nearest) -> dict[str, str]:
    """Return the attributes of ``<dynamics>``: ``damping`` [N m s/rad or N s/m] and ``friction`` [N m or N]."""
    return {"damping": number(found.parameters["K_v"]), "friction": number(found.parameters["K_c"])}


def urdf(found: Nearest, notes: list[str], joint: str) -> str:
    """Return a snippet of URDF for a joint."""
    values = " ".join(f'{key}="{value}"' for key, value in urdf_values(found).items())
    return f"{xml_comment([*notes, f'for joint {joint}:'])}\n<dynamics {values}/>\n"


def ros2(found: Nearest, notes: list[str], joint: str) -> str:
    """Return the joint's ``<dynamics>`` and its parameters for ros2_control, as XML.

    ros2_control has no friction of its own: a hardware or a controller that compensates reads them as parameters.
    """
    lines = [*notes, "ros2_control reads no friction by itself; hardware or controller take it from <param>"]
    values = {
        "friction_viscous": found.parameters["K_v"],
        "friction_coulomb": found.parameters["K_c"],
        "inertia": found.parameters[found.drive.inertia_key],
    }
    params = "\n".join(f'  <param name="{key}">{number(value)}</param>' for key, value in values.items())
    dynamics = " ".join(f'{key}="{value}"' for key, value in urdf_values(found).items())
    return f'{xml_comment(lines)}\n<dynamics {dynamics}/>\n<joint name="{joint}">\n{params}\n</joint>\n'


def drake(found: Nearest, notes: list[str], joint: str) -> str:
    """Return a snippet of URDF for Drake, which has damping and a rotor's inertia, and no dry friction at joints."""
    lines = [
        *notes,
        "Drake ignores dry friction of joints",
        f"for joint {joint}; the rotor's inertia belongs into its <transmission>/<actuator>, less what the link has",
    ]
    inertia = number(found.parameters[found.drive.inertia_key])
    return (
        f'{xml_comment(lines)}\n<dynamics damping="{number(found.parameters["K_v"])}"/>\n'
        f'<drake:rotor_inertia value="{inertia}"/>\n<drake:gear_ratio value="1"/>\n'
    )


def isaac(found: Nearest, notes: list[str], joint: str, model: FittedModel) -> str:
    """Return arguments of an Isaac Lab actuator: static, dynamic and viscous friction, armature."""
    dynamic = found.parameters["K_c"]
    values: Mapping[str, float] = {
        "friction": max(dynamic, breakaway(model)),
        "dynamic_friction": dynamic,
        "viscous_friction": found.parameters["K_v"],
        "armature": found.parameters[found.drive.inertia_key],
    }
    lines = [
        *notes,
        "friction and dynamic_friction are efforts [N m or N]: Isaac Sim 5.0 or newer; 4.5 takes coefficients",
        "friction is half the torque between the two ends of sticking in the whole model",
        "armature is the whole inertia of the drive: take off what the link has of it about the joint",
    ]
    text = "".join(f"# {line}\n" for line in lines)
    return text + f"friction_of_{_python(joint)} = dict(\n" + "".join(
        f"    {key}={{{joint!r}: {number(value)}}},\n" for key, value in values.items()
    ) + ")\n"  # fmt: skip


def breakaway(model: FittedModel) -> float:
    """Return half the torque between the two ends of sticking, the mean over the range of validity [N m or N]."""
    motion = motion_over(model)
    drive = Drive(model.model, model.inertia, model.motion)
    low, high = drive.sticking_interval(motion, model.parameters)
    return float(np.mean(high - low) / 2)


def _python(name: str) -> str:
    return "".join(c if c.isalnum() and c.isascii() else "_" for c in name) or "joint"
