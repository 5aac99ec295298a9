"""A motion that is told every fourth or fifth row of its log: fitted as the rows stand, and where it is new.

Drives of the rig with one hidden effect, which is in the model; 12 000 samples. Of each the log is fitted whole, with
position and velocity held over four rows, or one of them over five (a position of 16 bit), as it stands and by
``once_each``. Printed are inertia, parameters and test error. Run: ``python benchmarks/told_rarely.py [--drives 8]``.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fricmodels import compare
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording
from fricmodels.signals.polled import once_each
from hidden.draw import generator, mattering

SAMPLES, COUNT = 12_000, 2.0 * np.pi / 65536
EFFECTS = "torque-offset", "stribeck", "gravity", "cogging"
SEED = 9950


def told(recording: Recording, channels: tuple[str, ...], rows: int) -> tuple[Recording, Recording]:
    """Return a log of some channels of the motion, new in every row and in every so many."""
    held = np.arange(len(recording)) // rows * rows
    motion = {name: recording[name] for name in channels}
    if channels == ("position",):
        motion = {"position": COUNT * np.round(recording["position"] / COUNT)}
    plain = {"time": recording.time, "torque": recording.torque}
    of = [{**plain, **motion}, {**plain, **{name: values[held] for name, values in motion.items()}}]
    return replace(recording, channels=of[0], derived=frozenset()), replace(
        recording, channels=of[1], derived=frozenset()
    )


def logs(drives: int) -> Iterator[tuple[str, str, float, Recording, Recording]]:
    """Yield what was told, the model, the true inertia, and the log in every row and in some."""
    for index in range(drives):
        effect = EFFECTS[index % len(EFFECTS)]
        drawn = mattering(generator(SEED + index, "single", effect, 0), effect)
        if drawn is None:
            continue
        recording = drawn.recording.select(slice(0, SAMPLES))
        model, inertia = f"{drawn.rig.friction.law}+{effect}", drawn.comparison.drive.inertia or float("nan")
        for channels, rows in ((("position", "velocity"), 4), (("position",), 5), (("velocity",), 5)):
            yield " and ".join(channels), model, inertia, *told(recording, channels, rows)


def main() -> None:
    """Print a row for each fit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=8)
    for channels, model, inertia, whole, held in logs(parser.parse_args().drives):
        print(f"{model}, {channels}; inertia {inertia:.4g}")
        for name, log in (("every row", whole), ("as it stands", held), ("where it is new", once_each(held))):
            try:
                found = compare(log, model)
            except FricmodelsError as error:
                print(f"  {name:16} {error}")
                continue
            fit = found.estimate
            values = (f"{key} {value:.4g} ± {fit.standard_errors[key]:.1g}" for key, value in fit.parameters.items())
            print(f"  {name:16} {', '.join(values)}; test error {found.errors.held_out_percent:.3g} %", flush=True)


if __name__ == "__main__":
    main()
