"""TX40: six joints of a robot arm; the rigid-body torque, inertia included, is the known load."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from fricmodels.diagnosis import compare_model, kept_back, ready
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.readers import read
from fricmodels.recording import Recording
from measured.pictures import picture
from measured.story import Story, blocks, independent_table, parameter_table, summary_table, table, tell

Array = NDArray[np.float64]
BASE = "coulomb-viscous"
INERTIA = 1e-9
"""[kg m²]: the load torque already holds the inertia torque, so nothing is left to accelerate."""
PUBLISHED = {1: (8.05, 7.14), 2: (5.53, 8.26), 3: (1.97, 6.34), 4: (1.11, 2.48), 5: (1.86, 3.03), 6: (0.65, 0.282)}
"""Published F_v [N m s/rad] and F_s [N m]; motor 6 has another 0.616 and 1.95 on the sum of joints 5 and 6."""
AVERAGED = 5
"""Samples of the 5 kHz recording that are averaged into one."""
RATIOS = np.diag([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
RATIOS[5, 4] = 32.0
"""Motor angles = RATIOS · joint angles: motor 6 sits before joint 5 and turns with the sum of joints 5 and 6."""


def prepare(data: Path, folder: Path) -> list[Path]:
    """Write every joint, and the wrist by motor, from the raw recording: 1 kHz means, rigid-body torque as load.

    Joint angles are R⁻¹ times the motors', joint torques Rᵀ times theirs. The rigid-body torque that comes with the
    data at 200 Hz is interpolated. Motor 5 drives joint 5 alone: its torque is the difference of the joints' torques.
    Motor 6 turns with the sum of both joints.
    """
    raw = pd.read_parquet(data / "tx40" / "tx40_raw_5kHz.parquet")
    derived = pd.read_csv(data / "tx40" / "tx40_joint_200Hz_with_derived_rigid.csv")
    known = derived["t"].to_numpy()
    time = raw["t"].to_numpy()
    inside = (time >= known[0]) & (time <= known[-1])
    motor_angle = raw[[f"motor_pos{i}_rad" for i in range(1, 7)]].to_numpy()[inside]
    motor_torque = raw[[f"motor_torque{i}" for i in range(1, 7)]].to_numpy()[inside]
    angle, torque = motor_angle @ np.linalg.inv(RATIOS).T, motor_torque @ RATIOS
    rigid = np.column_stack(
        [CubicSpline(known, derived[f"torque_rigid{i}_Nm_derived"])(time[inside]) for i in range(1, 7)]
    )
    drives = {f"joint{i + 1}": (angle[:, i], torque[:, i], rigid[:, i]) for i in range(6)}
    drives["motor5"] = (angle[:, 4], torque[:, 4] - torque[:, 5], rigid[:, 4] - rigid[:, 5])
    drives["motor6"] = (angle[:, 4] + angle[:, 5], torque[:, 5], rigid[:, 5])
    return [_write(folder / f"tx40_{name}.csv", time[inside], *columns) for name, columns in drives.items()]


def _write(path: Path, time: Array, position: Array, torque: Array, load: Array) -> Path:
    table = np.column_stack([time, position, torque, load])
    whole = len(table) // AVERAGED * AVERAGED
    means = table[:whole].reshape(-1, AVERAGED, 4).mean(axis=1)
    names = ["time_s", "position_rad", "torque_Nm", "load_torque_Nm"]
    pd.DataFrame(means, columns=names).to_csv(path, index=False)
    return path


def halves(whole: Recording) -> dict[str, Recording]:
    """Return the first and the second half of a recording."""
    middle = len(whole) // 2
    return {"first half": whole.select(np.arange(middle)), "second half": whole.select(np.arange(middle, len(whole)))}


def with_effect_table(recordings: dict[str, Recording], effects: Sequence[str]) -> str:
    """Add the same effect to the base law on every joint."""
    rows = []
    for name, each in recordings.items():
        train, test = kept_back(ready(each))
        cells = []
        for model in (BASE, *(f"{BASE}+{effect}" for effect in effects)):
            errors = compare_model(train, test, Drive(Model.parse(model), INERTIA)).errors
            cells.append(f"{errors.percent:.1f} / {errors.held_out_percent:.1f} %")
        rows.append([name, *cells])
    return table(["", f"`{BASE}`", *(f"+ `{effect}`" for effect in effects)], rows)


def published_table(stories: dict[str, Story]) -> str:
    """Return the base law's coefficients beside the published ones."""
    rows = []
    for joint, (viscous, coulomb) in PUBLISHED.items():
        if joint > 4:
            continue
        estimate = stories[f"joint {joint}"].base.estimate
        found = [f"{estimate.parameters[k]:.3g} ± {estimate.standard_errors[k]:.2g}" for k in ("K_v", "K_c")]
        rows.append([f"joint {joint}", found[0], f"{viscous:.3g}", found[1], f"{coulomb:.3g}"])
    estimate = stories["motor 6"].base.estimate
    found = [f"{estimate.parameters[k]:.3g} ± {estimate.standard_errors[k]:.2g}" for k in ("K_v", "K_c")]
    rows.append(["motor 6 on joints 5 + 6", found[0], "0.616", found[1], "1.95"])
    return table(["", "K_v [N m s/rad]", "published F_v", "K_c [N m]", "published F_s"], rows)


def page(data: Path, configs: Path, pictures: Path, folder: Path, say: Callable[[str], None]) -> dict[str, str]:
    """Return the parts of the page."""
    joints = {f"joint {i}": read(folder / f"tx40_joint{i}.csv") for i in range(1, 7)}
    motors = {f"motor {i}": read(folder / f"tx40_motor{i}.csv") for i in (5, 6)}
    stories = {}
    for name, each in (joints | motors).items():
        say(f"improving {name}")
        stories[name] = tell(each, BASE, INERTIA)
    for joint in (1, 2, 3):
        picture(stories[f"joint {joint}"], pictures / f"measured_tx40_joint{joint}.png")
    picture(stories["joint 5"], pictures / "measured_tx40_joint5.png")
    picture(stories["motor 5"], pictures / "measured_tx40_motor5.png")
    say("halves by themselves")
    parts = {
        f"{name}, {half}": part for name in ("joint 1", "joint 2") for half, part in halves(ready(joints[name])).items()
    }
    solo = {name: joints[name] for name in ("joint 1", "joint 2", "joint 3", "joint 4")}
    one, two, three = (blocks(stories[f"joint {i}"]) for i in (1, 2, 3))
    return {
        **{f"one_{key}": text for key, text in one.items()},
        **{f"two_{key}": text for key, text in two.items()},
        **{f"three_{key}": text for key, text in three.items()},
        "five_words": blocks(stories["joint 5"])["words"],
        "summary": summary_table({k: v for k, v in stories.items() if k.startswith("joint")}),
        "wrist": summary_table({k: stories[k] for k in ("joint 5", "motor 5", "joint 6", "motor 6")}),
        "published": published_table(stories),
        "alone": independent_table(parts, BASE, INERTIA),
        "same": with_effect_table(solo | motors, ("nonlinear-viscous", "stribeck", "load-friction")),
        "five_parameters": parameter_table(stories["motor 5"].final),
        "six_parameters": parameter_table(stories["motor 6"].final),
        "four_parameters": parameter_table(stories["joint 4"].final),
    }
