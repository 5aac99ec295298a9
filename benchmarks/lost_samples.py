"""Logs that lack samples here and there: do the intervals hold, and how wide are they?

Drives of the coverage matrix at 100 samples a second, with a torque that is held or goes on between samples. After a
share of the samples some are left out. Printed are, of each parameter, how many of its 95 % intervals hold the truth,
its RMS error over its standard error, and the median standard error. Run:
``python benchmarks/lost_samples.py [--replications 40]``.
"""

from __future__ import annotations

import argparse

import numpy as np

from fricmodels.recording import Recording
from intervals_held import held
from known_drives import Cell

CELLS = (
    Cell(motion="sine", rate=100, torque="linear"),
    Cell(motion="sine", rate=100),
    Cell(rate=100),
    Cell(rate=100, inertia="estimated"),
)
LOST = ((0, 0.0), (2, 0.02), (3, 0.02), (4, 0.1))
"""Samples that are lost together, and the share of samples after which they are."""


def without(recording: Recording, together: int, share: float, number: int) -> Recording:
    """Return a recording that lacks so many samples after a share of the others."""
    rng = np.random.default_rng(number)
    keep = np.ones(len(recording), dtype=bool)
    for begin in np.flatnonzero(rng.random(len(recording)) < share):
        keep[begin + 1 : begin + 1 + together] = False
    return recording.select(keep)


def main() -> None:
    """Print a row for each kind of drive and loss."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--replications", type=int, default=40)
    replications = parser.parse_args().replications
    for cell in CELLS:
        for together, share in LOST:
            lost = f"{together} after {100 * share:.0f} %" if together else "none"
            some = (without(cell.recording(number), together, share, number) for number in range(replications))
            print(f"{cell.name}, lost {lost}: {held(cell, some)}", flush=True)


if __name__ == "__main__":
    main()
