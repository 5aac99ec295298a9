"""Runs of other lengths and rates in one recording: do the intervals hold, and does a run that is added ever do harm?

Drives of the coverage matrix at 1000 samples a second, alone, with a second or with a run of the same drive at another
rate. Printed are, of each parameter, how many of its 95 % intervals hold the truth, its RMS error over its standard
error, and the median standard error. Run: ``python benchmarks/several_rates.py [--replications 40]``.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from dataclasses import replace

import numpy as np

from fricmodels.diagnosis import compare
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording
from known_drives import Cell

CELLS = (Cell(), Cell(torque="linear"), Cell(motion="trapezoid"), Cell(inertia="estimated"))
BESIDE = {"alone": None, "with 1 s": (1000, 1.0), "with 12 s at 200 Hz": (200, 12.0), "with 12 s at 50 Hz": (50, 12.0)}
"""Rate [Hz] and duration [s] of the run that is added."""
SIDE = 1.959963984540054


def together(first: Recording, second: Recording) -> Recording:
    """Return two recordings as runs of one."""
    later = second.with_channels(time=second.time + first.time[-1] + 1.0)
    channels = {name: np.concatenate([first[name], later[name]]) for name in first.channels}
    return replace(first, channels=channels, run=np.repeat([0, 1], [len(first), len(second)]), origin=None)


def main() -> None:
    """Print a row for each kind of drive and what is added."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--replications", type=int, default=40)
    replications = parser.parse_args().replications
    for cell in CELLS:
        for name, beside in BESIDE.items():
            found: defaultdict[str, list[tuple[float, float]]] = defaultdict(list)
            refused = 0
            for number in range(replications):
                recording = cell.recording(number)
                if beside is not None:
                    rate, seconds = beside
                    other = replace(cell, rate=rate).recording(number + replications)
                    recording = together(recording, other.select(np.arange(int(seconds * rate))))
                try:
                    fit = compare(recording, cell.drive.model, cell.drive.inertia).estimate
                except FricmodelsError:
                    refused += 1
                    continue
                for key, error in fit.standard_errors.items():
                    if error > 0.0:
                        found[key].append(((fit.parameters[key] - cell.truth[key]) / error, error / cell.truth[key]))
            parts = []
            for key, each in found.items():
                off, size = np.array(each).T
                held, rms = int(np.sum(np.abs(off) < SIDE)), float(np.sqrt(np.mean(off**2)))
                parts.append(f"{key} {held}/{len(each)} {rms:.2f} {100 * float(np.median(size)):.2g} %")
            print(
                f"{cell.motion}, {cell.torque}, inertia {cell.inertia}, {name}: {', '.join(parts)}; {refused} refused"
            )


if __name__ == "__main__":
    main()
