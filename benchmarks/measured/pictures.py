"""The residual of a model before and after it was improved: along time, over position, over speed, since reversals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis import Comparison
from fricmodels.recording import Recording
from fricmodels.score import headline_window, torque_error_over
from measured.story import Story

Array = NDArray[np.float64]
FORWARD, BACKWARD = "#1f77b4", "#d62728"
_POINTS = 6000


def picture(story: Story, path: Path, recording: Recording | None = None) -> None:
    """Draw the residual of the base law (above) and of the improved model (below)."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    drawn = story.recording if recording is None else recording
    comparisons = [story.base, story.final]
    figure, axes = plt.subplots(2, 4, figsize=(15, 6.2), sharey=True, constrained_layout=True)
    most = 0.0
    for row, comparison in zip(axes, comparisons, strict=True):
        window = headline_window(comparison.train, comparison.drive.inertia)
        error = torque_error_over(comparison.drive, comparison.estimate.parameters, drawn, window)
        most = max(most, float(np.quantile(np.abs(error), 0.998)))
        _row(row, comparison, drawn, error)
    axes[0, 0].set_ylim(-1.15 * most, 1.15 * most)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=64)
    plt.close(figure)


def _row(axes: NDArray[np.object_], comparison: Comparison, recording: Recording, error: Array) -> None:
    along, over_position, over_speed, since = axes
    linear = comparison.drive.motion == "linear"
    length, force = ("m", "N") if linear else ("rad", "N m")
    velocity = recording.velocity
    shown = np.linspace(0, len(recording) - 1, min(_POINTS, len(recording))).astype(int)
    clock = np.arange(len(recording)) * recording.interval
    along.plot(clock[shown], error[shown], ".", ms=1.2, color="#444444")
    along.set_title(comparison.drive.model.name, fontsize=9, loc="left")
    along.set_xlabel("time in the recording [s]")
    along.set_ylabel(f"torque error [{force}]" if not linear else f"force error [{force}]")
    moving = np.abs(velocity) > 0.02 * float(np.max(np.abs(velocity)))
    for side, colour, name in ((1, FORWARD, "forward"), (-1, BACKWARD, "backward")):
        mask = moving & (np.sign(velocity) == side)
        chosen = shown[mask[shown]]
        over_position.plot(recording["position"][chosen], error[chosen], ".", ms=1.2, color=colour, label=name)
        over_speed.plot(np.abs(velocity[chosen]), error[chosen], ".", ms=1.2, color=colour)
        for axis, values in ((over_position, recording["position"]), (over_speed, np.abs(velocity))):
            _trend(axis, values[mask], error[mask], colour)
    over_position.set_xlabel(f"position [{length}]")
    over_position.legend(fontsize=7, markerscale=6, loc="upper right")
    over_speed.set_xlabel(f"speed [{length}/s]")
    distance = since_reversal(recording)
    late = shown[distance[shown] > 3e-5 * float(np.ptp(recording["position"]))]
    since.semilogx(distance[late], (error * np.sign(velocity))[late], ".", ms=1.2, color="#444444")
    since.set_xlabel(f"distance since reversal [{length}]")
    since.set_title("error along the motion", fontsize=9)
    for axis in axes:
        axis.axhline(0, color="k", lw=0.5)
        axis.tick_params(labelsize=8)


def _trend(axis: object, values: Array, error: Array, colour: str) -> None:
    """Draw the mean error in forty parts of a range."""
    if len(values) < 80:
        return
    edges = np.linspace(values.min(), values.max(), 41)
    place = np.clip(np.digitize(values, edges) - 1, 0, 39)
    count = np.bincount(place, minlength=40)
    mean = np.bincount(place, error, 40) / np.maximum(count, 1)
    enough = count > max(10, 0.005 * len(values))
    centre = (edges[1:] + edges[:-1]) / 2
    axis.plot(centre[enough], mean[enough], "-", lw=2.2, color="white")  # type: ignore[attr-defined]
    axis.plot(centre[enough], mean[enough], "-", lw=1.2, color=colour)  # type: ignore[attr-defined]


def since_reversal(recording: Recording) -> Array:
    """Return the distance travelled since the direction last changed, or since the run began."""
    side = np.sign(recording.velocity)
    turned = np.concatenate([[True], (side[1:] != side[:-1]) | (np.diff(recording.run) != 0)])
    start = np.maximum.accumulate(np.where(turned, np.arange(len(side)), 0))
    position = recording["position"]
    return np.asarray(np.abs(position - position[start]))
