"""How well models simulate the parts of a recording that they were not fitted to, each part in its turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Mask, rms
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.loop import Loop
from fricmodels.motion.fit import fit_motion
from fricmodels.motion.simulator import Simulator
from fricmodels.recording import Recording
from fricmodels.simulation import Between
from fricmodels.split import part_of

PARTS = 6
"""Parts that are held out in turn; whole runs where there are as many."""
_SHARES = (1, 2, 4)
"""Windows of a held-out part: all, half, a quarter of it. What is wrong slowly and what is wrong fast both count."""
_JACOBIANS = 8
"""Of a fit that begins from that of all parts."""


@dataclass(frozen=True)
class Fold:
    """What is fitted and what is held out."""

    fitted: Recording
    held_out: Recording


def folds(recording: Recording) -> list[Fold]:
    """Return the ways to hold out one part: so many pieces of time of each run, or groups of whole runs.

    Args:
        recording: prepared. There are fewer parts where a piece would have less than 20 samples.
    """
    numbers, parts = recording.run_numbers, PARTS
    label = np.zeros(len(recording), dtype=np.int64)
    if len(numbers) >= parts:
        label = np.searchsorted(numbers, recording.run) * parts // len(numbers)
    else:
        shortest = min(int(np.count_nonzero(recording.run == number)) for number in numbers)
        parts = max(2, min(parts, shortest // 20))
        for number in numbers:
            where = np.flatnonzero(recording.run == number)
            label[where] = np.arange(len(where)) * parts // len(where)
    remembered = recording if recording.origin is not None else recording.remembering()

    def part(mask: Mask) -> Recording:
        return part_of(remembered, mask)

    return [Fold(part(label != i), part(label == i)) for i in range(parts)]


def scores(
    drive: Drive,
    start: Mapping[str, float],
    parts: Sequence[Fold],
    *,
    loop: Loop | None = None,
    horizon: int | None = None,
    between_samples: Between = "linear",
) -> Array:
    """Return the logarithm of the RMS error of each held-out part, simulated by what the others gave.

    The shape is (parts, windows). Without a horizon the windows are a whole piece, half and a quarter
    of it. Infinite where nothing can be simulated.

    Args:
        drive: the model. start: parameters of a fit to the motion of all parts. parts: of :func:`folds`.
        loop: what pushes the drive. horizon: samples of a window, if only that length counts.
        between_samples: ``linear`` or ``held``.
    """
    found = []
    for fold in parts:
        lengths = [horizon] if horizon is not None else [_window(fold.held_out, share) for share in _SHARES]
        try:
            simulator = Simulator(drive, fold.fitted, loop=loop, horizon=horizon, between_samples=between_samples)
            fit = fit_motion(simulator, [start], most=_JACOBIANS, kinks=False)
        except EstimationError:
            found.append(np.full(len(lengths), np.inf))
            continue
        own = [
            Simulator(drive, fold.held_out, loop=loop, horizon=length, between_samples=between_samples)
            for length in lengths
        ]
        found.append(np.array([log_error(simulator, fit.parameters) for simulator in own]))
    return np.array(found)


def _window(recording: Recording, share: int) -> int | None:
    longest = int(np.max(np.unique(recording.run, return_counts=True)[1]))
    return None if share == 1 else max(1, longest // share)


def log_error(simulator: Simulator, values: Mapping[str, float], where: Mask | None = None) -> float:
    """Return the logarithm of the RMS position error (of the velocity without one), bounded below by rounding.

    Args:
        simulator: of what is scored. values: parameters by key. where: samples that count; all if not given.
    """
    position, velocity = simulator(values)
    measured = simulator.recording
    known = measured.measures("position")
    right = measured["position"] if known else measured.velocity
    error = ((position if known else velocity) - right)[simulator.scored if where is None else simulator.scored & where]
    if not np.all(np.isfinite(error)):
        return float("inf")
    least = 1e-12 * float(np.max(np.abs(right))) + 1e-300
    return float(np.log(max(rms(error), least)))
