"""Whether the motor torque was held between two samples, as by a digital controller, or went straight."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.drive import Drive
from fricmodels.loop import Loop
from fricmodels.motion.simulator import Simulator
from fricmodels.motion.start import SAMPLES
from fricmodels.recording import Recording
from fricmodels.simulation import Between

_SURE = 2.0
"""Standard errors: that the torque is held is said at 5 %, by both tails."""
_LENGTH = 10
"""Length of a window over the samples that tell its first state: in shorter ones the parabola through these speaks."""
_FEWEST = 6
"""Windows from which a standard error is worth something."""


def torque_between_samples(
    drive: Drive,
    values: Mapping[str, float],
    recording: Recording,
    *,
    loop: Loop | None = None,
    compiled: bool = True,
) -> Between:
    r"""Return ``held`` where a held torque moves the drive clearly nearer to what was measured, else ``linear``.

    Both differ by half a sample in time. Over a whole recording that is far more than the rest of a good model leaves:
    a drive that starts and stops is late each time. The recording is simulated both ways in windows of ten times the
    samples that tell a first state. The logarithm of the ratio of the squared errors has to be above zero by two of its
    standard errors over the windows, in which a ratio counts alike whether the window is hard or easy to predict. A
    window in which both are the same, as at rest, says nothing.

    Args:
        drive: the model. values: its parameters by key, SI.
        recording: prepared (:func:`fricmodels.weakform.prepared.ready`), with a position or a velocity.
        loop: what pushes the drive; through it there is no recorded torque, and the answer is ``linear``.
        compiled: see :class:`.simulator.Simulator`.
    """
    if loop is not None:
        return "linear"
    window = _LENGTH * max(SAMPLES, 2 * recording.derived_over + 1)
    straight = Simulator(drive, recording, horizon=window, compiled=compiled)
    held = Simulator(drive, recording, horizon=window, between_samples="held", compiled=compiled)
    known = recording.measures("position")
    measured = recording["position"] if known else recording.velocity
    one, other = ((np.asarray(each(values)[0 if known else 1]) - measured) ** 2 for each in (straight, held))
    begins = [predicted.start for predicted, _ in straight.starts]
    ends = [predicted.stop for predicted, _ in straight.starts]
    errors = np.array([[np.sum(e[a:b]) for e in (one, other)] for a, b in zip(begins, ends, strict=True)])
    telling = errors[np.all(np.isfinite(errors) & (errors > 0), axis=1) & (errors[:, 0] != errors[:, 1])]
    if len(telling) < _FEWEST:
        return "linear"
    ratio = np.log(telling[:, 0] / telling[:, 1])
    error = float(np.std(ratio, ddof=1)) / np.sqrt(len(ratio))
    return "held" if float(np.mean(ratio)) > _SURE * error else "linear"
