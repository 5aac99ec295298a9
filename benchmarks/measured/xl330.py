"""XL330: a servo swings a pendulum; torque from voltage and speed, gravity known; fitted on 12 logs, checked on 4."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative
from fricmodels.split import Split
from measured.pictures import picture
from measured.story import Story, blocks, by_hand_table, independent_table, leaderboard_table, tell

BASE = "coulomb-viscous"
CONSTANTS = {"M1": (0.3867, 4.017), "M6": (0.3660, 2.811)}
"""Published k_t [N m/A] and R [ohm], found with friction model M1 (Coulomb–viscous) and M6 (with load friction)."""
MASS, LENGTH, GRAVITY = 0.49, 0.10, 9.81
CHECK = {("sin_sin", 100), ("lift_and_drop", 200), ("up_and_down", 400), ("sin_time_square", 800)}
"""The logs that take no part: one of every trajectory, one of every gain of the position controller."""
BY_HAND = ("load-friction", "directional-efficiency", "torque-gain", "load-friction+torque-gain", "thermal")


def standard(data: Path, constants: str = "M1") -> pd.DataFrame:
    """Return the logs with standard columns: motor torque k_t/R (V − k_t ω), load torque m g l sin q.

    The speed in the back-EMF is the slope of the position over seven samples; the servo's own speed register lags by
    20 ms. With the torque switched off the motor is an open circuit.
    """
    k_t, resistance = CONSTANTS[constants]
    logs = pd.read_csv(data / "bam_xl330" / "xl330_pendulum_16logs.csv")
    time, position = logs["t"].to_numpy(), logs["pos_rad"].to_numpy()
    run = pd.factorize(logs["log"])[0]
    _, speed = lanczos_derivative(time, position, 3, run)
    torque = k_t / resistance * (logs["motor_volt_V"].to_numpy() - k_t * speed)
    return pd.DataFrame(
        {
            "time_s": time,
            "torque_Nm": np.where(logs["torque_enable"] == 1, torque, 0.0),
            "position_rad": position,
            "load_torque_Nm": MASS * GRAVITY * LENGTH * np.sin(position),
            "temperature_degC": logs["temp_C"],
            "run": logs["log"],
            "trajectory": logs["trajectory"],
            "kp": logs["kp"],
        }
    )


def prepare(data: Path, folder: Path) -> list[Path]:
    """Write the logs with standard columns: those to fit and those to check, for both sets of constants."""
    paths = []
    for constants in CONSTANTS:
        logs = standard(data, constants)
        check = np.array([each in CHECK for each in zip(logs["trajectory"], logs["kp"], strict=True)])
        for name, mask in (("fit", ~check), ("check", check)):
            path = folder / f"xl330_{constants}_{name}.csv"
            logs[mask].to_csv(path, index=False)
            paths.append(path)
    return paths


def recording(folder: Path, constants: str, name: str) -> Recording:
    """Read one of the prepared files."""
    return read(folder / f"xl330_{constants}_{name}.csv")


def by_gain(data: Path, folder: Path, gains: Sequence[int]) -> Recording:
    """Return the logs of some gains of the position controller, of all trajectories."""
    logs = standard(data)
    path = folder / f"xl330_kp_{'_'.join(map(str, gains))}.csv"
    logs[logs["kp"].isin(gains)].to_csv(path, index=False)
    return read(path)


def free_swing(data: Path) -> tuple[float, float]:
    """Return the loss per load torque and its standard error where the torque is off, by least squares.

    There J a + m g l sin q + K_v ω + (K_c + μ |m g l sin q|) sgn ω = 0, whatever k_t and R are. The error is from the
    scatter between the logs.
    """
    logs = pd.read_csv(data / "bam_xl330" / "xl330_pendulum_16logs.csv")
    found = []
    for _, log in logs[logs["trajectory"] == "lift_and_drop"].groupby("log"):
        time, position = log["t"].to_numpy(), log["pos_rad"].to_numpy()
        run = np.zeros(len(time), dtype=np.int64)
        _, speed = lanczos_derivative(time, position, 5, run)
        _, acceleration = lanczos_derivative(time, speed, 5, run)
        load = MASS * GRAVITY * LENGTH * np.sin(position)
        side = np.sign(speed)
        free = (log["torque_enable"].to_numpy() == 0) & (np.abs(speed) > 0.3)
        columns = np.column_stack([acceleration, speed, side, side * np.abs(load)])[free]
        found.append(np.linalg.lstsq(columns, -load[free], rcond=None)[0][3])
    return float(np.mean(found)), float(np.std(found, ddof=1) / np.sqrt(len(found)))


def story(folder: Path, constants: str = "M1") -> Story:
    """Improve the Coulomb–viscous law on twelve logs."""
    checks = {"other logs": recording(folder, constants, "check")}
    return tell(recording(folder, constants, "fit"), BASE, checks=checks, how=Split(by="runs"))


def page(data: Path, configs: Path, pictures: Path, folder: Path, say: Callable[[str], None]) -> dict[str, str]:
    """Return the parts of the page."""
    say("improving")
    told = story(folder)
    picture(told, pictures / "measured_xl330.png")
    say("the same with the other constants")
    other = story(folder, "M6")
    say("adding effects by hand")
    hand = by_hand_table(told, BASE, BY_HAND)
    say("diagnosing parts by themselves")
    parts = {f"k_p {low} and {high}": by_gain(data, folder, (low, high)) for low, high in ((100, 400), (200, 800))}
    parts["four other logs"] = recording(folder, "M1", "check")
    alone = independent_table(parts, BASE)
    say("tournament")
    loss, error = free_swing(data)
    return {
        **blocks(told),
        "free": f"{loss:.2f} ± {error:.2f}",
        **{f"m6_{key}": text for key, text in blocks(other).items()},
        "hand": hand,
        "alone": alone,
        "leaderboard": leaderboard_table(configs / "xl330.yaml"),
    }
