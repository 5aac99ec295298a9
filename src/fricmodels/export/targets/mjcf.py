"""MuJoCo 4.0: damping, dry friction, spring and armature of a joint; cogging, constants and LuGre as ``dcmotor``.

MuJoCo's force is minus the friction torque: a cogging ``a cos kq + b sin kq`` is the ``dcmotor`` of amplitude
``hypot(a, b)``, k poles and the phase ``atan2(-a, -b)``. With ``input="none"`` and no motor constant it is purely
passive and takes no control. A spring's constant is one, too, and its ``springref`` 0: that needs no unit of angles.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from xml.sax.saxutils import quoteattr

from fricmodels.dimension import INERTIA
from fricmodels.errors import InputError, suggestion
from fricmodels.export.targets.nearest import Nearest
from fricmodels.export.targets.simple import number, xml_comment

Attributes = Mapping[str, str]
_COGGING = re.compile(r"cogging(?:\(\d\))?\.k")
_PASSIVE = {"input": "none", "motorconst": "0 0", "resistance": "1"}


def joint_attributes(found: Nearest, *, armature: float | None) -> dict[str, str]:
    """Return the attributes of the joint: ``damping``, ``frictionloss``, of a spring ``stiffness`` and ``springref``,
    and, where one is given, ``armature``."""
    p = found.parameters
    if found.drive.model.law.name == "lugre":
        values = {"damping": f"{number(p['sigma_2'])} 0 0", "frictionloss": "0"}
    else:
        polynomial = " ".join(number(p[key]) for key in ("d_1", "d_2", "d_3"))
        values = {"damping": polynomial, "frictionloss": number(p["K_c"])}
    if "stiffness.k" in p:
        values |= {"stiffness": number(p["stiffness.k"]), "springref": "0"}
    return values if armature is None else {**values, "armature": number(armature)}


def actuators(found: Nearest, joint: str) -> list[dict[str, str]]:
    """Return the attributes of every passive ``dcmotor``."""
    p, listed = found.parameters, []

    def add(name: str, **attributes: str) -> None:
        listed.append({"name": f"{joint}_{name}", "joint": joint, **_PASSIVE, **attributes})

    def wave(name: str, a: float, b: float, poles: float) -> None:
        if math.hypot(a, b) > 0:
            add(name, cogging=f"{number(math.hypot(a, b))} {number(poles)} {number(math.atan2(-a, -b))}")

    for key in [key for key in p if _COGGING.fullmatch(key)]:
        effect = key.removesuffix(".k")
        name = effect.replace("(", "_wave_").removesuffix(")")
        wave(name, p[f"{effect}.a"], p[f"{effect}.b"], p[key])
        wave(f"{name}_2", p[f"{effect}.a_2"], p[f"{effect}.b_2"], 2 * p[key])
    wave("offset", p.get("torque-offset.tau_0", 0.0) + p.get("stiffness.tau_0", 0.0), 0.0, 0.0)
    if found.drive.model.law.name == "lugre":
        five = (p["F_c"] / p["z_c"], p["sigma_1"], p["F_c"], p["r"] * p["F_c"], p["v_s"])
        add("lugre", lugre=" ".join(map(number, five)))
    return listed


def snippet(found: Nearest, notes: list[str], joint: str) -> str:
    """Return the joint's attributes and the passive motors as text to copy."""
    inertia = found.parameters[found.drive.inertia_key]
    values = joint_attributes(found, armature=inertia)
    lines = [*notes, "armature is the whole inertia of the drive: take off what the link has of it about the joint"]
    text = [xml_comment(lines), f"<joint name={quoteattr(joint)} {_attributes(values)}/>"]
    motors = actuators(found, joint)
    if motors:
        text += ["<actuator>", *(f"  <dcmotor {_attributes(motor)}/>" for motor in motors), "</actuator>"]
    return "\n".join(text) + "\n"


def into_xml(text: str, found: Nearest, notes: list[str], joint: str, armature: float | None) -> str:
    """Return a model in MJCF with a joint's friction in it; its comments stay, and so do its other actuators.

    Args:
        text: the MJCF. found: what is written. notes: what stands in a comment beside it.
        joint: name of the joint. armature: to write; the joint's own stays where it is ``None``.

    Raises:
        InputError: where the text is no MJCF, or has no such joint.
    """
    root = parsed(text, "mujoco")
    chosen = named_joint(_joints(root), joint)
    for key, value in joint_attributes(found, armature=armature).items():
        chosen.set(key, value)
    motors = actuators(found, joint)
    section = root.find("actuator")
    if section is not None:
        ours = re.compile(rf"{re.escape(joint)}_(?:cogging(?:_wave_\d)?(?:_2)?|offset|lugre)")
        for old in [e for e in section if e.tag == "dcmotor" and ours.fullmatch(e.get("name") or "")]:
            section.remove(old)
    if motors:
        section = ET.SubElement(root, "actuator") if section is None else section
        for motor in motors:
            ET.SubElement(section, "dcmotor", motor)
    root.insert(0, ET.Comment("\n" + "\n".join(f"  {line}".replace("--", "- -") for line in notes) + "\n"))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def of_the_offset(found: Nearest, joint: str) -> list[str]:
    """Return what to know of a constant torque that is written: MuJoCo has the weight of links by itself."""
    written = any(motor["name"] == f"{joint}_offset" for motor in actuators(found, joint))
    return [f"{joint}_offset: leave it out where it is the weight of the links, which MuJoCo computes"] * written


def of_the_joint(text: str, found: Nearest, joint: str, armature: float | None) -> list[str]:
    """Return what to know of a joint that friction is written into: whose inertia it has, and at which side of a gear.

    Args:
        text: the MJCF. found, joint, armature: see :func:`into_xml`.
    """
    root, inertia = parsed(text, "mujoco"), found.parameters[found.drive.inertia_key]
    unit, lines = INERTIA.unit(found.drive.motion), []
    if armature is None:
        own = named_joint(_joints(root), joint).get("armature", "0")
        lines.append(
            f"the joint keeps its armature of {own} {unit}: the drive's whole inertia is {inertia:.4g} {unit}; give "
            "what the links do not have of it with --armature"
        )
    motors = [motor for section in root.findall("actuator") for motor in section if motor.get("joint") == joint]
    for motor in motors:
        gear = (motor.get("gear", "1").split() or ["1"])[0]
        if gear not in ("1", "1.0"):
            lines.append(
                f"the actuator '{motor.get('name', motor.tag)}' has a gear of {gear}: friction is written as it was "
                "fitted; if the recording is of the motor's side of that gear, scale both to the joint first"
            )
    return lines


def parsed(text: str, kind: str) -> ET.Element:
    """Return the root of an XML document, with its comments.

    Raises:
        InputError: where it is none, or of another kind.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InputError("the XML declares entities, which are not read; take the DOCTYPE out")
    try:
        root = ET.fromstring(text, ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    except ET.ParseError as error:
        raise InputError(f"the XML cannot be read: {error}") from None
    if root.tag != kind:
        raise InputError(f"the XML begins with <{root.tag}>, not with <{kind}>; give a file of the target's kind")
    return root


def _joints(root: ET.Element) -> list[ET.Element]:
    """Return the joints of the bodies; others, of equalities and tendons, only name one."""
    return [joint for body in root.findall("worldbody") for joint in body.iter("joint")]


def named_joint(joints: Iterable[ET.Element], joint: str) -> ET.Element:
    """Return the joint of a name.

    Raises:
        InputError: naming the nearest one there is.
    """
    named = {str(element.get("name")): element for element in joints if element.get("name")}
    if joint not in named:
        raise InputError(f"the XML has no joint '{joint}'{suggestion(joint, list(named))}")
    return named[joint]


def _attributes(values: Attributes) -> str:
    return " ".join(f"{key}={quoteattr(value)}" for key, value in values.items())
