"""How many intervals of fits hold the truth, for :mod:`lost_samples` and :mod:`several_rates`."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from fricmodels.diagnosis import compare
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording
from known_drives import Cell

SIDE = 1.959963984540054


def held(cell: Cell, recordings: Iterable[Recording]) -> str:
    """Fit the true model to each recording, and say of each parameter how many 95 % intervals hold the truth.

    With the RMS error over the standard error, and the median standard error; and how many recordings were refused.
    """
    found: defaultdict[str, list[tuple[float, float]]] = defaultdict(list)
    refused = 0
    for recording in recordings:
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
        inside, rms = int(np.sum(np.abs(off) < SIDE)), float(np.sqrt(np.mean(off**2)))
        parts.append(f"{key} {inside}/{len(each)} {rms:.2f} {100 * float(np.median(size)):.2g} %")
    return f"{', '.join(parts)}; {refused} refused"
