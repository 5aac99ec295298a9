"""The pictures of Elhami and Brookfield (1997), drawn anew: Figs. 3, 4 and 6 to 10."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.files import replaced
from fricmodels.fit import Fit
from fricmodels.recording import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


BLUE, ORANGE, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#7f7f7f"
_MILLI = 1e3
_STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
}


@contextmanager
def _figure(path: Path, rows: int, columns: int, size: tuple[float, float], **shared: Any) -> Iterator[list[Axes]]:
    """Yield axes to draw on, then write the picture whole; its bytes depend on what is drawn alone."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):
        figure: Figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False, **shared)
        yield list(axes.ravel())
        with replaced(path) as beside:
            figure.savefig(beside, format="png", dpi=110, metadata={"Software": None})


def _curve(drive: Drive, values: Mapping[str, float], velocity: Array) -> Array:
    """Return the law's torque at the velocities; the step at zero is drawn as a vertical line."""
    zero = np.zeros_like(velocity)
    channels = {"time": zero, "torque": zero, "velocity": velocity}
    return drive.friction(Recording("curve", drive.motion, channels, np.zeros(len(velocity), dtype=np.int64)), values)


def _speeds(recording: Recording) -> Array:
    low, high = float(recording.velocity.min()), float(recording.velocity.max())
    tiny = 1e-6 * max(abs(low), abs(high))
    return np.concatenate([np.linspace(min(low, -tiny), -tiny, 400), np.linspace(tiny, max(high, tiny), 400)])


def friction_against_velocity(
    path: Path, recordings: Sequence[Recording], fits: Sequence[tuple[str, Drive, Fit]], titles: Sequence[str]
) -> None:
    """Draw simulated and estimated friction torque against velocity (Figs. 3 and 4), one panel for each fit.

    Args:
        path: PNG to write.
        recordings: simulated, with their true parameters.
        fits: name of the true model, drive that was fitted, and fit.
        titles: of the panels.
    """
    from fricmodels.model import Model

    with _figure(path, 1, len(fits), (3.6 * len(fits), 3.1), sharey=True) as axes:
        for axis, recording, (truth, drive, fit), title in zip(axes, recordings, fits, titles, strict=True):
            velocity = _speeds(recording)
            true_drive = Drive(Model.parse(truth), fit.parameters[drive.inertia_key], drive.motion)
            true = _curve(true_drive, recording.provenance["true_parameters"], velocity)
            axis.plot(velocity, _MILLI * true, color=GREY, linewidth=3.5, alpha=0.55, label="simulated")
            estimated = _curve(drive, fit.parameters, velocity)
            axis.plot(velocity, _MILLI * estimated, color=ORANGE, linestyle="--", label="estimated")
            axis.set_title(title, fontsize=9)
            axis.set_xlabel("velocity [rad/s]")
        axes[0].set_ylabel("friction torque [mN m]")
        axes[0].legend(loc="upper left")


def torque_and_velocity(path: Path, recording: Recording, cycles: float, frequency: float) -> None:
    """Draw torque and velocity against time (Fig. 6)."""
    shown = recording.time <= recording.time[0] + cycles * 2 * np.pi / frequency
    time = recording.time[shown]
    with _figure(path, 2, 1, (6.4, 3.8), sharex=True) as (upper, lower):
        upper.plot(time, _MILLI * recording.torque[shown], color=BLUE)
        upper.set_ylabel("motor torque [mN m]")
        lower.plot(time, recording.velocity[shown], color=ORANGE, linewidth=0.9)
        lower.set_ylabel("velocity [rad/s]")
        lower.set_xlabel("time [s]")


def coefficients_against_sample(path: Path, fit: Fit, true: Mapping[str, float], units: Mapping[str, str]) -> None:
    """Draw each coefficient against the sample number while it is being estimated (Fig. 7)."""
    history = fit.history
    if history is None:
        raise ValueError(f"'{fit.estimator}' keeps no history")
    keys = [key for key in fit.estimated if key in history]
    rows = (len(keys) + 1) // 2
    with _figure(path, rows, 2, (7.2, 1.9 * rows), sharex=True) as axes:
        for axis, key in zip(axes, keys, strict=False):
            axis.axhline(true[key], color=GREY, linewidth=3.5, alpha=0.55, label="true")
            axis.plot(np.arange(len(history)), history[key], color=ORANGE, linewidth=1.0, label="estimated")
            axis.set_title(f"{key} [{units[key]}]", fontsize=9)
            axis.ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
        for axis in axes[len(keys) :]:
            axis.set_axis_off()
        axes[0].legend(loc="best")
        for axis in axes[-2:]:
            axis.set_xlabel("sample")


def friction_as_it_develops(path: Path, recording: Recording, drive: Drive, fit: Fit) -> None:
    """Draw velocity and estimated friction torque against sample number, and against each other (Fig. 8)."""
    history = fit.history
    if history is None or len(history) != len(recording):
        raise ValueError("the history must have one row for each sample")
    true = recording.provenance["true_parameters"]
    developing = np.zeros(len(recording))
    for key in fit.estimated:
        unit = {**dict.fromkeys(fit.estimated, 0.0), drive.inertia_key: fit.parameters[drive.inertia_key], key: 1.0}
        developing += history[key].to_numpy() * drive.friction(recording, unit)
    sample = np.arange(len(recording))
    with _figure(path, 2, 2, (7.4, 5.0)) as (speed, torque, develops, ends):
        speed.plot(sample, recording.velocity, color=BLUE, linewidth=0.8)
        speed.set(xlabel="sample", ylabel="velocity [rad/s]")
        torque.plot(sample, _MILLI * developing, color=ORANGE, linewidth=0.8)
        torque.set(xlabel="sample", ylabel="friction torque [mN m]")
        colours = ["#c6dbef", "#6baed6", "#08519c"]
        parts = [(0, 0.1, "1st cycle"), (0.1, 0.3, "2nd and 3rd"), (0.3, 1.0, "later")]
        for (begin, end, label), colour in zip(parts, colours, strict=True):
            part = slice(round(begin * len(sample)), round(end * len(sample)))
            develops.plot(
                recording.velocity[part], _MILLI * developing[part], ".", color=colour, markersize=3, label=label
            )
        develops.set(xlabel="velocity [rad/s]", ylabel="friction torque [mN m]")
        develops.set_title("as it develops", fontsize=9)
        develops.legend(loc="lower right", markerscale=3)
        velocity = _speeds(recording)
        ends.plot(velocity, _MILLI * _curve(drive, true, velocity), color=GREY, linewidth=3.5, alpha=0.55, label="true")
        ends.plot(
            velocity, _MILLI * _curve(drive, fit.parameters, velocity), color=ORANGE, linestyle="--", label="estimated"
        )
        ends.set(xlabel="velocity [rad/s]", ylabel="friction torque [mN m]")
        ends.set_title("as it ends", fontsize=9)
        ends.legend(loc="lower right")
        limit = max(abs(value) for axis in (develops, ends) for value in axis.get_ylim())
        for axis in (develops, ends):
            axis.set_ylim(-limit, limit)


def coefficients_against(
    path: Path,
    rows: Sequence[Mapping[str, Any]],
    tag: str,
    label: str,
    true: Mapping[str, float],
    *,
    scale: float = 1.0,
    error: bool = False,
) -> None:
    """Draw the coefficients of leaderboard rows against a tag: frequency (Fig. 9) or amplitude (Fig. 10).

    Medians over the seeds, with quartiles as bars. A coefficient that the program declares not identified, in most
    of the seeds, is an open circle.

    Args:
        path: PNG to write.
        rows: of one model and one estimator.
        tag: on the abscissa.
        label: of the abscissa.
        true: true parameters.
        scale: the tag is divided by it.
        error: add a panel with the RMS torque error.
    """
    values = sorted({row["tags"][tag] for row in rows})
    panels = [("viscous coefficient [mN m s/rad]", ("K_v1", "K_v2")), ("Coulomb torque [mN m]", ("K_c1", "K_c2"))]
    count = len(panels) + error
    with _figure(path, 1, count, (3.5 * count, 3.1)) as axes:
        for axis, (name, keys) in zip(axes, panels, strict=False):
            for key, colour in zip(keys, (BLUE, ORANGE), strict=True):
                _medians(axis, rows, values, tag, scale, key, colour)
                axis.axhline(_MILLI * true[key], color=colour, linewidth=0.9, linestyle=":")
            axis.set(xlabel=label, ylabel=name)
            low, high = axis.get_ylim()
            axis.set_ylim(min(0.0, low), 1.06 * high)
            ends_high = true[keys[0]] * _MILLI > high / 2
            axis.legend(loc="lower right" if ends_high else "upper right")
        if error:
            medians = [np.median([r["rms_torque_error_percent"] for r in rows if r["tags"][tag] == v]) for v in values]
            axes[-1].plot(np.array(values) / scale, medians, "o-", color=GREEN, markersize=4)
            axes[-1].set(xlabel=label, ylabel="RMS torque error [% of $K_I$]")
            axes[-1].set_ylim(0, None)


def _medians(
    axis: Axes,
    rows: Sequence[Mapping[str, Any]],
    values: Sequence[float],
    tag: str,
    scale: float,
    key: str,
    colour: str,
) -> None:
    low, middle, high, identified = [], [], [], []
    for value in values:
        here = [row for row in rows if row["tags"][tag] == value]
        found = _MILLI * np.array([row["parameters"][key] for row in here], dtype=float)
        quartiles = np.percentile(found, [25, 50, 75])
        low.append(quartiles[1] - quartiles[0])
        middle.append(quartiles[1])
        high.append(quartiles[2] - quartiles[1])
        identified.append(np.mean([key in row["not_identified"] for row in here]) < 0.5)
    where, sure = np.array(values) / scale, np.array(identified)
    axis.errorbar(where, middle, yerr=[low, high], color=colour, linewidth=1, capsize=2, elinewidth=0.8)
    axis.plot(where[sure], np.array(middle)[sure], "o", color=colour, markersize=4.5, label=key)
    if not sure.all():
        axis.plot(
            where[~sure], np.array(middle)[~sure], "o", color=colour, markerfacecolor="white", markersize=4.5,
            label=f"{key}, not identified",
        )  # fmt: skip
