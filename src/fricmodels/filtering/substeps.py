"""How many steps between two samples the explicit midpoint rule needs."""

from __future__ import annotations

import numpy as np

from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.filtering.preparation import peak_speed, scanned_guess
from fricmodels.recording import Recording

_LARGEST = 64
_STABLE = 1.0
"""Step × fastest rate; the midpoint rule is stable up to 2, accurate well below."""
_PHASE = 0.1
"""Longest step in radians of the dominant cycle."""


def stable_substeps(drive: Drive, recording: Recording, scales: Scales) -> int:
    """Return the number of sub-steps for which the rule is stable and follows the motion.

    The fastest rate is the largest eigenvalue of ∂g/∂[velocity, states] at the first guess of the parameters,
    over a range of speeds; at most 64 sub-steps.
    """
    import casadi

    space = Drive(drive.model, drive.inertia, drive.motion).state_space()
    moving = len(space.states)
    block = casadi.Function(
        "block", [space.x, space.u, space.width], [casadi.jacobian(space.rate[:moving], space.x)[:, :moving]]
    )
    guess = scanned_guess(drive, recording)
    parameters = [guess[key] for key in drive.keys]
    states = [state.initial for state in drive.model.states]
    middle = [float(np.median(recording.signal(name))) for name in space.inputs]
    peak = peak_speed(recording)
    fastest = 0.0
    for speed in peak * np.array([-1.0, -0.3, -0.1, 0.1, 0.3, 1.0]):
        matrix = np.array(block([speed, *states, *parameters], middle, 1e-3 * peak))
        if np.all(np.isfinite(matrix)):
            fastest = max(fastest, float(np.max(np.abs(np.linalg.eigvals(matrix)))))
    steps = np.diff(recording.time)[np.diff(recording.run) == 0]
    step = float(np.median(steps))
    needed = max(step * fastest / _STABLE, step / scales.time / _PHASE)
    return int(min(max(1, np.ceil(needed - 1e-9)), _LARGEST))
