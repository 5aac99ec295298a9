"""Updates of the filters on line in Python: time of the first and the last tenth, size of the state, covariance.

``python benchmarks/updates.py [--updates 1000000] [--only ekf]`` prints the table of docs/compensation.md: in motion
all the time, and at rest after a tenth. ``benchmarks/instructions.py`` does the same for the exported C.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from typing import Any

import numpy as np

STEP, CYCLE = 1e-3, 200
TRUE = {"K_v": 0.05, "K_c": 0.4, "J": 0.01}
LOOKS = 100
"""How often the covariance is looked at."""


def motion(count: int) -> tuple[Any, Any]:
    """Return torque and velocity of a drive that oscillates, with a little noise."""
    time_ = STEP * np.arange(count)
    omega = 2 * np.pi / (STEP * CYCLE)
    velocity = 6 * np.sin(omega * time_) + 2 * np.sin(3 * omega * time_ + 0.7)
    slope = 6 * omega * np.cos(omega * time_) + 6 * omega * np.cos(3 * omega * time_ + 0.7)
    torque = TRUE["J"] * slope + TRUE["K_v"] * velocity + TRUE["K_c"] * np.sign(velocity)
    return torque, velocity + 0.02 * np.random.default_rng(0).standard_normal(count)


def run(cls: Any, updates: int, resting: bool) -> dict[str, Any]:
    """Return what one filter does over so many updates."""
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.recording import Recording

    torque, velocity = motion(20 * CYCLE)
    drive = Drive(Model.parse("coulomb-viscous"), TRUE["J"])
    channels = {"time": STEP * np.arange(len(torque)), "torque": torque, "velocity": velocity}
    online = cls().start(drive, Recording("updates", drive.motion, channels, np.zeros(len(torque), dtype=np.int64)))
    tenth, seconds, bare, sizes = updates // 10, [], [], []
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    begin = time.process_time()
    for i in range(updates):
        still, place = resting and i >= tenth, i % len(torque)
        online.update(
            {
                "time": i * STEP,
                "torque": 0.0 if still else float(torque[place]),
                "velocity": 0.0 if still else float(velocity[place]),
            }
        )
        if i % (updates // LOOKS) == updates // LOOKS - 1:
            covariance = online.covariance
            size = np.sqrt(np.diag(covariance))
            bare.append(float(np.linalg.eigvalsh(covariance / np.outer(size, size))[0]))
            sizes.append(len(json.dumps(online.state)))
        if i % tenth == tenth - 1:
            seconds.append(time.process_time() - begin)
            begin = time.process_time()
    return {
        "seconds": seconds,
        "least": min(bare),
        "state": (sizes[0], max(sizes)),
        "grown": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before,
    }


def main() -> None:
    from estimators.detchmendy_sridhar import DetchmendySridhar
    from estimators.ekf import ExtendedKalman
    from estimators.rls import RecursiveLeastSquares

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--updates", type=int, default=1_000_000)
    parser.add_argument("--only", choices=("detchmendy-sridhar", "ekf", "rls"))
    given = parser.parse_args()
    print(
        "| filter | motion | all | first tenth | last tenth | least eigenvalue | state, at first and at most | memory |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for cls in (DetchmendySridhar, ExtendedKalman, RecursiveLeastSquares):
        if given.only not in (None, cls.name):
            continue
        for resting in (False, True):
            found = run(cls, given.updates, resting)
            first, last = found["seconds"][0], found["seconds"][-1]
            what, small, large = "rest after a tenth" if resting else "all the time", *found["state"]
            print(
                f"| `{cls.name}` | {what} | {sum(found['seconds']):.0f} s | {first:.2f} s | {last:.2f} s | "
                f"{found['least']:.2g} | {small}, {large} characters | +{found['grown']} kB |",
                flush=True,
            )


if __name__ == "__main__":
    main()
