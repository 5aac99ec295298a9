"""Runs of other lengths, rates and noise in one recording: do intervals hold, and does an added run ever do harm?

Drives of the coverage matrix at 1000 samples a second, alone, with a second or with a run of the same drive at another
rate, or with a run of which the velocity, the torque or both have far more noise. Printed are, of each parameter, how
many of its 95 % intervals hold the truth, its RMS error over its standard error, and the median standard error. Run:
``python benchmarks/several_rates.py [--replications 40]``.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from fricmodels.recording import Recording
from intervals_held import held
from known_drives import Cell

CELLS = (Cell(), Cell(torque="linear"), Cell(motion="trapezoid"), Cell(inertia="estimated"))
BESIDE: dict[str, tuple[int, float, float, float]] = {
    "alone": (1000, 0.0, 0.0, 0.0),
    "with 1 s": (1000, 1.0, 0.0, 0.0),
    "with 12 s at 200 Hz": (200, 12.0, 0.0, 0.0),
    "with 12 s at 50 Hz": (50, 12.0, 0.0, 0.0),
    "with 12 s, velocity noisy": (1000, 12.0, 0.2, 0.0),
    "with 12 s, torque noisy": (1000, 12.0, 0.0, 0.5),
    "with 12 s, both noisy": (1000, 12.0, 0.2, 0.5),
}
"""Rate [Hz] and duration [s] of the run that is added, and noise of its velocity and torque over their RMS values."""


def together(first: Recording, second: Recording) -> Recording:
    """Return two recordings as runs of one."""
    later = second.with_channels(time=second.time + first.time[-1] + 1.0)
    channels = {name: np.concatenate([first[name], later[name]]) for name in first.channels}
    run, known = np.repeat([0, 1], [len(first), len(second)]), {"file_of_run": {0: "first.csv", 1: "second.csv"}}
    return replace(first, channels=channels, run=run, origin=None, provenance=known)


def recorded(cell: Cell, beside: tuple[int, float, float, float], number: int, replications: int) -> Recording:
    """Return a recording of a drive, with a second run of it where one is added."""
    recording = cell.recording(number)
    rate, seconds, *noises = beside
    if not seconds:
        return recording
    other = replace(cell, rate=rate).recording(number + replications).select(np.arange(int(seconds * rate)))
    rng = np.random.default_rng(number)
    for name, noise in zip(("velocity", "torque"), noises, strict=True):
        size = noise * np.sqrt(np.mean(other[name] ** 2))
        other = other.with_channels(derived=False, **{name: other[name] + size * rng.standard_normal(len(other))})
    return together(recording, other)


def main() -> None:
    """Print a row for each kind of drive and what is added."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--replications", type=int, default=40)
    parser.add_argument("--only", default="", help="what is added, or a part of it")
    asked = parser.parse_args()
    replications = asked.replications
    for cell in CELLS:
        for name, beside in BESIDE.items():
            if asked.only not in name and name != "alone":
                continue
            some = (recorded(cell, beside, number, replications) for number in range(replications))
            line = f"{cell.motion}, {cell.torque}, inertia {cell.inertia}, {name}: {held(cell, some)}"
            print(line, flush=True)


if __name__ == "__main__":
    main()
