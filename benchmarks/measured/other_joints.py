"""What the other joints explain: arms of a TIAGo, the wrist of a TX40, a KR300 on three trajectories together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from fricmodels.diagnosis import compare
from fricmodels.readers import read, read_together
from fricmodels.recording import Recording
from fricmodels.signals import best_half_width, lanczos_derivative
from measured import kuka, tx40
from measured.story import Story, blocks, parameter_table, summary_table, table, tell

BASE = "coulomb-viscous"
TIAGO = {1: 100 * 0.136, 2: 100 * 0.136, 3: -100 * 0.087, 4: -100 * 0.087}
"""Reduction × motor constant [N m/A] of the arm's joints, with the source's signs."""


def arm(data: Path, joint: int, others: bool) -> Recording:
    """Return a joint of TIAGo's arm, with position and velocity of the others, and the velocity of the torso."""
    columns = [
        "time=t:s",
        f"torque=arm_{joint}_effort:{TIAGO[joint]} N*m",
        f"position=arm_{joint}_position:rad",
        f"velocity=arm_{joint}_velocity:rad/s",
    ]
    for other in (i for i in range(1, 8) if others and i != joint):
        columns.append(f"other.j{other}_velocity=arm_{other}_velocity:rad/s")
        columns.append(f"other.j{other}_position=arm_{other}_position:rad")
    if others:
        columns.append("other.torso_velocity=torso_lift_velocity:m/s")
    return read(data / "tiago" / "tiago_torso_arm_100Hz.csv", columns=columns)


def wrist(folder: Path, joint: int, others: bool) -> Recording:
    """Return joint 5 or 6 of the TX40, with the velocity of the other one, derived from its position."""
    own, beside = (read(folder / f"tx40_joint{i}.csv") for i in (joint, 11 - joint))
    if not others:
        return own
    angle, name = beside["position"], f"other.j{11 - joint}_velocity"
    velocity = lanczos_derivative(own.time, angle, best_half_width(own.time, angle, own.run), own.run)[1]
    return replace(own, channels={**own.channels, name: velocity}, units={name: "rad/s"})


def by_sum(folder: Path, joint: int) -> str:
    """Return the test error of joint 5 or 6 of the TX40 with the sum of both velocities as the further channel."""
    beside, own = wrist(folder, joint, True), wrist(folder, 11 - joint, True)
    velocity = beside[f"other.j{11 - joint}_velocity"] + own[f"other.j{joint}_velocity"]
    channels = {name: values for name, values in beside.channels.items() if not name.startswith("other.")}
    channels["other.sum_velocity"] = velocity
    summed = replace(beside, channels=channels, units={"other.sum_velocity": "rad/s"})
    errors = compare(summed, f"{BASE}+other-friction(sum_velocity)", tx40.INERTIA).errors
    return f"{errors.held_out_percent:.1f} %"


def robot(data: Path, joint: int, others: bool) -> Recording:
    """Return a joint of the KR300 on all three trajectories, with position and velocity of the others."""
    columns = kuka.columns(joint)
    for other in (i for i in range(1, 7) if others and i != joint):
        columns.append(f"other.j{other}_velocity=vel{other}_rads:rad/s")
        columns.append(f"other.j{other}_position=pos{other}_rad:rad")
    files = [data / "kuka_kr300" / f"kr300_traj{trajectory}_250Hz.csv" for trajectory in "ABC"]
    return read_together(files, columns=columns)


def models_table(stories: dict[str, Story]) -> str:
    """Return the last model of each joint without and with the others, and its errors."""
    rows = []
    for name, story in stories.items():
        errors = story.final.errors
        rows.append(
            [name, f"`{story.final.drive.model.name}`", f"{errors.percent:.1f} %", f"{errors.held_out_percent:.1f} %"]
        )
    return table(["", "model at the end", "fit error", "test error"], rows)


def page(data: Path, configs: Path, pictures: Path, folder: Path, say: Callable[[str], None]) -> dict[str, str]:
    """Return the parts of the page."""
    if not (folder / "tx40_joint5.csv").exists():
        tx40.prepare(data, folder)
    made: dict[str, Callable[[bool], Recording]] = {
        **{f"TIAGo arm {i}": lambda others, i=i: arm(data, i, others) for i in TIAGO},
        **{f"TX40 joint {i}": lambda others, i=i: wrist(folder, i, others) for i in (5, 6)},
        **{f"KR300 joint {i}": lambda others, i=i: robot(data, i, others) for i in (1, 3, 4, 6)},
    }
    stories: dict[str, Story] = {}
    for name, make in made.items():
        for others in (False, True):
            title = f"{name}, with the others" if others else f"{name}, alone"
            say(title)
            stories[title] = tell(make(others), BASE, tx40.INERTIA if name.startswith("TX40") else None)
    return {
        "models": models_table(stories),
        "named": summary_table({name: story for name, story in stories.items() if name.endswith("others")}),
        "arm3_words": blocks(stories["TIAGo arm 3, with the others"])["words"],
        "arm3_parameters": parameter_table(stories["TIAGo arm 3, with the others"].final),
        "five_words": blocks(stories["TX40 joint 5, with the others"])["words"],
        "five_parameters": parameter_table(stories["TX40 joint 5, with the others"].final),
        "six_parameters": parameter_table(stories["TX40 joint 6, with the others"].final),
        "five_by_sum": by_sum(folder, 5),
        "six_by_sum": by_sum(folder, 6),
        "robot3_parameters": parameter_table(stories["KR300 joint 3, with the others"].final),
    }
