"""The momentum balance from sample to sample: what a fitted model leaves where no test function averages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.weakform.carriers import at_steps, step_positions
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.rates import relative_intervals


@dataclass(frozen=True)
class Steps:
    """The momentum balance from sample to sample, as far as the motion is certain.

    Attributes:
        place, passed: position of each balance, and what the drive passes between two samples there, shape (N,).
        residual: mean torque that the model leaves, shape (N,); zero where it is not used.
        used: where the motion is certain.
        order: how often the balance averages over a sampling interval: once, or twice where velocities are means.
    """

    place: Array
    passed: Array
    residual: Array
    used: Mask
    order: int

    @classmethod
    def of(cls, problem: WeakFormProblem, parameters: Mapping[str, float]) -> Steps:
        """Evaluate what a fitted model leaves."""
        drive, test_functions, recording = problem.drive, problem.test_functions, problem.recording
        design, offset = problem.evaluate(drive, drive.model.nonlinear_of(parameters))
        theta = np.array(drive.model.linear_of(parameters, delay=False))
        points = problem.quadrature.recording
        left = points.driving_torque - theta @ design - offset
        impulses = at_steps(problem.quadrature.impulses(left[None]), test_functions.over_cells)[0]
        inertia, _ = drive.split(parameters)
        velocity, interval = problem.cell_velocity, recording.interval * relative_intervals(recording)
        covered = test_functions.covered(len(recording))
        used = covered & np.roll(covered, 1) & np.roll(covered, -1)
        balance = (impulses - inertia * np.diff(velocity, prepend=velocity[:1])) / interval
        place, passed = positions(problem)
        used &= passed != 0.0
        return cls(place, passed, np.where(used, balance, 0.0), used, 2 if test_functions.over_cells else 1)

    @cached_property
    def span(self) -> float:
        """The range of position."""
        return float(np.ptp(self.place[self.used])) if np.any(self.used) else 0.0


def positions(problem: WeakFormProblem) -> tuple[Array, Array]:
    """Return the position of each balance, and what the drive passes between two samples there, both shape (N,).

    An encoder's steps are no motion: what passes follows from the velocity freed of noise.
    """
    recording, over_cells = problem.recording, problem.test_functions.over_cells
    place, _ = step_positions(recording["position"], over_cells)
    smooth = problem.smooth
    between = smooth if over_cells else 0.5 * (smooth + np.concatenate([smooth[:1], smooth[:-1]]))
    return place, recording.interval * relative_intervals(recording) * between
