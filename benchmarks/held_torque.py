"""Whether a torque that is held between samples is seen, and what it is worth: ``python benchmarks/held_torque.py``.

Rigs are drawn with an effect, scale, size and noise at random, half of them with a torque that goes straight between
samples. The true structure is fitted to the torque, and the whole recording simulated both ways.
"""

from __future__ import annotations

import argparse

import numpy as np

EFFECTS = ("cogging", "stribeck", "asymmetry", "torque-offset")


def trial(seed: int, hold: bool, known: bool) -> tuple[str, float]:
    """Return what was said of the torque, and the position error as it was over the other one.

    Args:
        seed: of the rig. hold: whether its torque is held. known: whether the fitted model has the hidden effect.
    """
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.motion import Simulator, motion_errors, torque_between_samples
    from fricmodels.rig.draw import random_rig
    from fricmodels.weakform.estimate import estimate
    from fricmodels.weakform.prepared import ready

    rng = np.random.default_rng([seed, 7])
    effect = EFFECTS[seed % len(EFFECTS)]
    rig = random_rig(rng, [effect], samples=8000, excitation=None if hold else "multisine")
    recording = ready(rig.model_copy(update={"hold": hold}).simulate())
    model = Model.parse(rig.true_model)
    if not known:
        model = next((model.minus(term.name) for term in model.effects), model)
    drive = Drive(model, rig.inertia, recording.motion)
    values = estimate(drive, recording)[1].parameters
    said = torque_between_samples(drive, values, recording)
    held, straight = (
        motion_errors(Simulator(drive, recording, between_samples=way, horizon=500), values).position
        for way in ("held", "linear")
    )
    return said, held / straight if hold else straight / held


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=40, help="drives of each kind (40)")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print("| torque | model | held | straight, or not clear | error as it was, over the other way: median |")
    print("|---|---|---|---|---|")
    for hold in (True, False):
        for known in (True, False):
            seeds = range(given.seed, given.seed + given.drives)
            found = [trial(seed, hold, known) for seed in seeds]
            held = sum(said == "held" for said, _ in found)
            ratio = float(np.median([worth for _, worth in found]))
            print(
                f"| {'held' if hold else 'straight'} | {'the true structure' if known else 'without the effect'} "
                f"| {held} | {len(found) - held} | {ratio:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
