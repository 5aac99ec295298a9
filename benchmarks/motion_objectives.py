"""What to make small when a force that no channel has pushes the drive: ``python benchmarks/motion_objectives.py``.

Drives of drawn size move under a known torque and an unrecorded coloured force (1 to 5 % of the RMS torque, correlated
over 0.05 to 8 s). Parameters are found from one recording by torque, by simulated motion in one piece, in windows, and
in windows of several lengths at once; they then simulate another motion, with another such force and without any.
``--misfit`` gives the drives a Stribeck effect that the fitted model does not have.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np
from scipy.signal import lfilter

LAW, HIDDEN = "coulomb-viscous+asymmetry", "coulomb-viscous+asymmetry+stribeck"
_COUNT, _STEP, _INERTIA, _NOISE = 16_000, 1e-3, 0.05, 1e-4


def drawn(seed: int, misfit: bool) -> tuple[dict[str, float], float]:
    """Return the parameters of a drive and its speed [rad/s]."""
    random = np.random.default_rng(seed)
    viscous, speed = _INERTIA / random.uniform(0.2, 1.0), random.uniform(2, 6)
    coulomb = random.uniform(0.3, 1.0) * viscous * speed
    values = {"J": _INERTIA, "K_v": viscous, "K_c": coulomb}
    values |= {"asymmetry.c": random.uniform(-0.1, 0.1) * coulomb, "asymmetry.d": random.uniform(-0.2, 0.2) * viscous}
    if misfit:
        values |= {"stribeck.F_s": random.uniform(0.2, 0.6) * coulomb, "stribeck.delta": 2.0}
        values["stribeck.omega_s"] = random.uniform(0.05, 0.2) * speed
    return values, speed


def recorded(values: dict[str, float], speed: float, seed: int) -> tuple[Any, Any]:
    """Return a motion under the force that no channel has, and the same torque without it."""
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.simulation import simulate
    from fricmodels.weakform.prepared import ready

    random, at = np.random.default_rng(seed), np.arange(_COUNT) * _STEP
    lines = np.array([0.25, 0.45, 0.8, 1.5]) * random.uniform(0.8, 1.2, 4)
    sizes, phases = speed * np.array([0.8, 0.4, 0.3, 0.15]), random.uniform(0, 2 * np.pi, 4)
    velocity = sum(a * np.sin(2 * np.pi * f * at + p) for a, f, p in zip(sizes, lines, phases, strict=True))
    torque = _INERTIA * np.gradient(velocity, _STEP) + values["K_v"] * velocity + values["K_c"] * np.sign(velocity)
    kept = float(np.exp(-_STEP / 10 ** random.uniform(-1.3, 0.9)))
    size = random.uniform(0.01, 0.05) * float(np.sqrt(np.mean(torque**2)))
    force = size * np.sqrt(1 - kept**2) * lfilter([1.0], [1.0, -kept], random.standard_normal(_COUNT))
    drive, made = Drive(Model.parse(HIDDEN if "stribeck.F_s" in values else LAW), _INERTIA), []
    for more in (force, 0.0):
        moved = simulate(drive, values, at, torque + more, with_position=True)
        position = moved["position"] + _NOISE * random.standard_normal(_COUNT)
        made.append(ready(moved.with_channels(derived=False, torque=torque, position=position)))
    return made[0], made[1]


def trial(seed: int, misfit: bool) -> dict[str, tuple[float, float]]:
    """Return the position errors on the other motion, with the force and without it, for each way."""
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.motion import Simulator, fit_motion, motion_errors
    from fricmodels.weakform.estimate import estimate
    from motion_tables.lengths import in_several_lengths

    values, speed = drawn(seed, misfit)
    fitted, others = recorded(values, speed, 100 + seed)[0], recorded(values, speed, 500 + seed)
    drive = Drive(Model.parse(LAW), None, fitted.motion)
    torque = dict(estimate(drive, fitted)[1].parameters)
    found = {"torque": torque, "one piece": dict(fit_motion(Simulator(drive, fitted), [torque]).parameters)}
    for horizon in (300, 2000):
        fit = fit_motion(Simulator(drive, fitted, horizon=horizon), [torque], kinks=False)
        found[f"windows of {horizon * _STEP:g} s"] = dict(fit.parameters)
    found["one piece to 1/128 at once"] = in_several_lengths(drive, fitted, torque, range(8))
    found["1/8 to 1/128 at once"] = in_several_lengths(drive, fitted, torque, range(3, 8))
    errors = {}
    for way, given in found.items():
        one, two = (motion_errors(Simulator(drive, other), given).position for other in others)
        errors[way] = (one, two)
    return errors


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--misfit", action="store_true")
    given = parser.parse_args()
    begin, rows = time.process_time(), []
    for number in range(given.drives):
        rows.append(trial(given.seed + number, given.misfit))
        print(given.seed + number, f"{time.process_time() - begin:.0f} s", flush=True)
    print("\n| made small | another motion, with such a force | without it |\n|---|---|---|")
    for way in rows[0]:
        over = np.log([[row[way][i] / row["one piece"][i] for i in range(2)] for row in rows])
        print(f"| {way} | {np.exp(over[:, 0].mean()):.2f} | {np.exp(over[:, 1].mean()):.2f} |")


if __name__ == "__main__":
    main()
