"""The motion that a model makes of the measured torque, stroke by stroke, beside the measured motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.motion.between import torque_between_samples
from fricmodels.motion.simulator import Simulator
from fricmodels.motion.start import SAMPLES
from fricmodels.recording import Recording
from fricmodels.results.words import NORMAL_95
from fricmodels.score.noise import noise_like
from fricmodels.signals.lanczos import lanczos_value
from fricmodels.signals.rest import motion_noise, resting, smoothed_velocity, velocity_noise
from fricmodels.simulation import Between

MOST = 20_000
"""Samples that are simulated; of a longer recording windows that are spread evenly over it."""


@dataclass(frozen=True)
class Stretch:
    """What is simulated of a recording, and in which windows.

    Attributes:
        recording: the samples.
        horizon: samples after which a simulation begins anew from the measured state; ``None`` for a piece at one go.
        window: length of a window [s]; that of the longest piece where there is no horizon.
        stroke: whether that is the usual time between two reversals.
        total: samples of the recording that this is an excerpt of.
    """

    recording: Recording
    horizon: int | None
    window: float
    stroke: bool
    total: int

    @property
    def excerpt(self) -> bool:
        """Whether these are some windows of a longer recording."""
        return len(self.recording) < self.total

    @property
    def place(self) -> Index:
        """Number of the window that each sample is in, shape (N,): it goes up where a simulation begins anew."""
        run = self.recording.run
        begins = np.concatenate([[True], np.diff(run) != 0])
        since = np.arange(len(run)) - np.maximum.accumulate(np.where(begins, np.arange(len(run)), 0))
        anew = begins if self.horizon is None else begins | ((since - 1) % self.horizon == 0) & (since > 1)
        return np.cumsum(anew)


@dataclass(frozen=True)
class Replay:
    """The motion of one model along a stretch.

    Attributes:
        model: its name.
        velocity: simulated [rad/s or m/s], shape (N,); not a number where the simulation ended before.
        error: RMS of simulated less measured velocity, the first sample of each piece left out.
        percent: of the RMS velocity.
    """

    model: str
    velocity: Array
    error: float
    percent: float


@dataclass(frozen=True)
class Replays:
    """The motion of several models along the same stretch.

    Attributes:
        stretch: what was simulated.
        models: each model's motion, in the order given.
        noise: RMS velocity error that noise of the sensors alone gives with the last model.
        between_samples: how the measured torque goes, by the last model; see :mod:`.between`.
    """

    stretch: Stretch
    models: tuple[Replay, ...]
    noise: float
    between_samples: Between


def stretch_of(recording: Recording, most: int = MOST) -> Stretch:
    """Return what of a recording is simulated: windows as long as the usual time between two reversals.

    Friction turns about at a reversal, and what it is before and after shows within such a window; over many of them
    an error of force adds up to a speed that says little of friction. A piece without two reversals is one window.

    Args:
        recording: prepared; of test data as a rule.
        most: samples; of more, whole windows are taken that are spread evenly.
    """
    longest = int(np.max(np.unique(recording.run, return_counts=True)[1]))
    stroke = _stroke(recording)
    length = min(max(stroke or longest, SAMPLES), longest - 1, most - 1)
    whole = stroke is None or length >= longest - 1
    if len(recording) <= most:
        seconds = (longest - 1 if whole else length) * recording.interval
        return Stretch(recording, None if whole else length, seconds, not whole and length == stroke, len(recording))
    pieces = np.split(np.arange(len(recording)), np.flatnonzero(np.diff(recording.run)) + 1)
    starts = np.concatenate([part[: -length : length + 1] for part in pieces if len(part) > length])
    count = min(len(starts), max(1, most // (length + 1)))
    taken = starts[((np.arange(count) + 0.5) * len(starts) / count).astype(np.int64)]
    chosen = np.zeros(len(recording), dtype=bool)
    chosen[(taken[:, None] + np.arange(length + 1)).ravel()] = True
    part = recording.select(chosen)
    part = replace(part, run=np.repeat(np.arange(count), length + 1))
    return Stretch(part, None, length * recording.interval, stroke == length, len(recording))


def _stroke(recording: Recording) -> int | None:
    """Return the median samples between two reversals; ``None`` with fewer than two in any piece."""
    velocity, still = smoothed_velocity(recording)[0], resting(recording)
    moving = np.flatnonzero(~still & (velocity != 0))
    turned = (np.diff(np.sign(velocity[moving])) != 0) & (np.diff(recording.run[moving]) == 0)
    turns = moving[1:][turned]
    apart = np.diff(turns)[np.diff(recording.run[turns]) == 0]
    return int(np.median(apart)) if len(apart) else None


def replayed(models: Sequence[tuple[Drive, Mapping[str, float]]], stretch: Stretch) -> Replays:
    """Simulate models along a stretch from its measured torque, each window from its measured state.

    Args:
        models: each with its parameters by key, the inertia among them.
        stretch: of :func:`stretch_of`.

    Raises:
        InputError: where a motion cannot be simulated, saying why.
    """
    recording, found = stretch.recording, []
    between = torque_between_samples(*models[-1], recording, compiled=False)
    for drive, values in models:
        simulator = _simulator(drive, stretch, between)
        velocity = simulator(values)[1]
        wrong = (velocity - recording.velocity)[simulator.scored]
        if not np.all(np.isfinite(wrong)):
            raise InputError(_why_ended(drive, values, recording))
        rms = float(np.sqrt(np.mean(recording.velocity[simulator.scored] ** 2)))
        error = float(np.sqrt(np.mean(wrong**2)))
        found.append(Replay(drive.model.name, velocity, error, 100 * error / rms if rms > 0 else np.nan))
    drive, values = models[-1]
    return Replays(stretch, tuple(found), _of_noise(drive, values, stretch, between, found[-1].velocity), between)


def undetermined(drive: Drive, inertia: float, error: float | None) -> str:
    """Say why a motion cannot be simulated with an inertia, or nothing where it can.

    Args:
        drive: the model, and its inertia where that was given.
        inertia: J [kg m²] or M [kg]. error: its standard error; of none where it was given.
    """
    name = "mass" if drive.motion.value == "linear" else "inertia"
    if not inertia > 0:
        return f"the {name} is zero"
    if drive.inertia is None and not (error and inertia > NORMAL_95 * error):
        return f"this recording does not determine the {name}"
    return ""


def _why_ended(drive: Drive, values: Mapping[str, float], recording: Recording) -> str:
    """Say why a simulation ended: the inertia is lost between two samples, or the model's own speed has no end.

    The RMS torque brings an inertia to the RMS speed within J·RMS(ω)/RMS(τ). Where that is less than the time between
    two samples, no motion that inertia makes is in the recording.
    """
    inertia = float(values[drive.inertia_key])
    speed, torque = (float(np.sqrt(np.mean(recording[each] ** 2))) for each in ("velocity", "torque"))
    name, unit, effort = ("mass", "kg", "force") if drive.motion.value == "linear" else ("inertia", "kg m²", "torque")
    if inertia * speed < recording.interval * torque:
        given = f"the {name} that was given" if drive.inertia is not None else f"the {name} that was found"
        return (
            f"{given}, {inertia:.3g} {unit}, is next to none: the measured {effort} would bring it to the measured "
            f"speed in {inertia * speed / torque:.1g} s, and samples are {recording.interval:.3g} s apart"
        )
    return f"the simulated speed of {drive.model.name} grows without bound before the recording ends"


def _simulator(drive: Drive, stretch: Stretch, between: Between) -> Simulator:
    return Simulator(drive, stretch.recording, horizon=stretch.horizon, between_samples=between, compiled=False)


def _of_noise(drive: Drive, values: Mapping[str, float], stretch: Stretch, between: Between, velocity: Array) -> float:
    """Return the RMS error that noise gives: of the torque, of the state a window starts from, and of what is compared.

    The recording is simulated again with as much noise added as its channels have.
    """
    recording, rng = stretch.recording, np.random.default_rng(0)
    torque = recording.torque + noise_like(recording, "torque", rng)
    if recording.derived_over:
        drawn = motion_noise(recording).like(len(recording), rng)
        moved = lanczos_value(recording.time, drawn, recording.derived_over, recording.run, order=1)
    else:
        moved = velocity_noise(recording).like(len(recording), rng)
        drawn = np.zeros(len(recording))
    channels = {**recording.channels, "torque": torque, "velocity": recording.velocity + moved}
    if "position" in recording:
        channels["position"] = recording["position"] + drawn
    simulator = _simulator(drive, replace(stretch, recording=replace(recording, channels=channels)), between)
    wrong = (simulator(values)[1] - velocity - moved)[simulator.scored]
    return float(np.sqrt(np.mean(wrong**2)))
