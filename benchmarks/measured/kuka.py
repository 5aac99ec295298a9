"""KR300: joints 1 and 6 of a large robot; fitted on trajectory A, checked on B and C."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fricmodels.readers import read
from fricmodels.recording import Recording
from measured.pictures import picture
from measured.story import (
    Story,
    blocks,
    by_hand_table,
    independent_table,
    leaderboard_table,
    parameter_table,
    summary_table,
    tell,
)

BASE = "coulomb-viscous"
RATIO = {1: 256.857, 3: 252.333, 4: 221.0, 6: 154.323}
"""Turns of the motor to a turn of the joint; motor torque × ratio is the torque at the joint."""
BY_HAND = ("asymmetry", "torque-offset", "stribeck", "nonlinear-viscous", "presliding", "joint-compliance")


def columns(joint: int) -> list[str]:
    """Return the columns of a joint; joint 1 turns about the vertical and carries no gravity."""
    own = [
        "time=t:s",
        f"torque=motor_torque{joint}_Nm:{RATIO[joint]} N*m",
        f"velocity=vel{joint}_rads:rad/s",
        f"position=pos{joint}_rad:rad",
    ]
    return own if joint == 1 else [*own, f"load_torque=model_gravity{joint}_Nm:N*m"]


def recording(data: Path, joint: int, trajectory: str) -> Recording:
    """Return a joint on a trajectory."""
    return read(data / "kuka_kr300" / f"kr300_traj{trajectory}_250Hz.csv", columns=columns(joint))


def story(data: Path, joint: int) -> Story:
    """Improve the Coulomb–viscous law on trajectory A; B and C take no part."""
    checks = {f"trajectory {t}": recording(data, joint, t) for t in "BC"}
    return tell(recording(data, joint, "A"), BASE, checks=checks)


def page(data: Path, configs: Path, pictures: Path, folder: Path, say: Callable[[str], None]) -> dict[str, str]:
    """Return the parts of the page."""
    stories = {}
    alone = {}
    hand = {}
    for joint in (1, 6):
        name = f"joint {joint}"
        say(f"improving {name}")
        stories[name] = story(data, joint)
        picture(stories[name], pictures / f"measured_kuka_joint{joint}.png")
        say(f"{name}: each trajectory by itself")
        alone[joint] = independent_table({f"trajectory {t}": recording(data, joint, t) for t in "ABC"}, BASE)
        hand[joint] = by_hand_table(stories[name], BASE, BY_HAND)
    one, six = blocks(stories["joint 1"]), blocks(stories["joint 6"])
    return {
        **{f"one_{key}": text for key, text in one.items()},
        **{f"six_{key}": text for key, text in six.items()},
        "one_base": parameter_table(stories["joint 1"].base),
        "six_base": parameter_table(stories["joint 6"].base),
        "summary": summary_table(stories),
        "alone_one": alone[1],
        "alone_six": alone[6],
        "hand_one": hand[1],
        "hand_six": hand[6],
        "leaderboard": leaderboard_table(configs / "kuka.yaml"),
    }
