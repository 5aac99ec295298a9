"""What every sequential estimator does before the first sample: find the scales, make a first guess."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array, Mask, rms
from fricmodels.dimension import Dimension, Scales
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.model import ModelParameter
from fricmodels.recording import Recording
from fricmodels.simulation import Between

if TYPE_CHECKING:
    from fricmodels.signals import Noise

REST_WIDTH = 1e-3
"""Width of rest, as a fraction of the peak speed: limits the slope of |ω|^p to what a step can follow."""
_SPOILT = 10
"""Times its usual peak from which a sample is a spike."""
_MEANS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
"""Samples over which means of noise are taken."""
_MOST_COMBINATIONS = 400
_TRACED = 20_000


def peak_speed(recording: Recording) -> float:
    """Return the 99 % quantile of the speed: the peak, but of the motion and not of its noise."""
    return float(np.quantile(np.abs(recording.velocity), 0.99)) or float(np.max(np.abs(recording.velocity)))


def longest_run(recording: Recording) -> Recording:
    """Return the run with the most samples."""
    numbers, counts = np.unique(recording.run, return_counts=True)
    return recording if len(numbers) == 1 else recording.select(recording.run == numbers[np.argmax(counts)])


def dominant_frequency(recording: Recording) -> float:
    """Return the angular frequency ω [rad/s] that carries most of the velocity's variation in the longest run.

    The peak of the periodogram (Hann window, padded four times); at least one cycle in the run.
    """
    run = longest_run(recording)
    count = len(run)
    duration = float(run.time[-1] - run.time[0])
    grid = np.linspace(run.time[0], run.time[-1], count)
    values = np.interp(grid, run.time, run.velocity)
    spectrum = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(count), 4 * count))
    frequency = 2 * np.pi * np.fft.rfftfreq(4 * count, duration / (count - 1))
    spectrum[frequency < 2 * np.pi / duration * (1 - 1e-9)] = 0.0
    return float(frequency[np.argmax(spectrum)])


def velocity_noise(recording: Recording) -> float:
    """Return the standard deviation of the velocity's noise, counted as white.

    Without samples that go ten times beyond the peak speed. At least 1e-4 of that, so that a noiseless simulation does
    not make a filter infinitely certain.
    """
    from fricmodels.signals import velocity_noise as noise_of_velocity

    peak = peak_speed(recording)
    usual = np.abs(recording.velocity) <= _SPOILT * peak
    kept = recording if usual.all() else recording.select(usual)
    return max(_as_white(noise_of_velocity(kept), len(kept)), 1e-4 * peak)


def position_noise(recording: Recording) -> float:
    """Return the standard deviation of the position's noise, counted as white, at least 1e-6 of its range."""
    from fricmodels.signals.noise_level import noise_of

    position = recording["position"]
    found = _as_white(noise_of(recording.time, position, recording.run), len(recording))
    return max(found, 1e-6 * float(np.ptp(position)))


def _as_white(noise: Noise, count: int) -> float:
    """Return the standard deviation of white noise that says as little of a signal as its own noise does.

    Noise that lasts n samples, as that of a rounded signal does, is the same in all of them: it counts as white noise
    of n times its variance, which is what means over many samples have.

    Args:
        noise: of the signal. count: its samples.
    """
    widths = [width for width in _MEANS if width <= count]
    return max(math.sqrt(width) * float(noise.after(np.full(width, 1.0 / width))) for width in widths)


def smoothed_acceleration(recording: Recording) -> Array:
    """Return dω/dt, measured or by the Lanczos differentiator whose width suits the noise."""
    from fricmodels.signals import Preparation, prepare

    return prepare(recording, Preparation())["acceleration"]


def ordinary(recording: Recording, acceleration: Array) -> Mask:
    """Return the samples that no spike has spoilt: neither speed nor acceleration ten times over their usual peaks."""
    magnitude = np.abs(acceleration)
    usual = magnitude <= _SPOILT * max(float(np.quantile(magnitude, 0.95)), np.finfo(float).tiny)
    return np.asarray(usual & (np.abs(recording.velocity) <= _SPOILT * peak_speed(recording)))


def inertia_guess(drive: Drive, recording: Recording) -> float:
    """Return the drive's inertia, or a first value from regressing the torque on dω/dt, ω, sgn ω and 1.

    Raises:
        EstimationError: when the recording gives none (the drive never accelerates).
    """
    if drive.inertia is not None:
        return drive.inertia
    acceleration = smoothed_acceleration(recording)
    speed = recording.velocity
    moving = (np.abs(speed) > 0.05 * peak_speed(recording)) & ordinary(recording, acceleration)
    design = np.stack([acceleration, speed, np.sign(speed), np.ones_like(speed)])[:, moving]
    torque = recording.driving_torque[moving]
    size = np.sqrt(np.mean(design**2, axis=1, keepdims=True))
    size[size == 0] = 1.0
    solution = np.linalg.lstsq((design / size).T, torque, rcond=None)[0] / size[:, 0]
    if not solution[0] > 0:
        raise EstimationError(
            f"recording '{recording.name}' gives no inertia: torque does not grow with acceleration; state --inertia"
        )
    return float(solution[0])


def paper_scales(drive: Drive, recording: Recording) -> Scales:
    """Return the paper's normalisation: time in 1/ω, torque in J ω² D, so that the inertia becomes 1.

    ω is the dominant frequency. The paper's D is 1 rad, with which its motor reaches a normalised speed of about 2;
    D is chosen such that every drive does: D = peak speed / (2 ω).
    """
    omega = dominant_frequency(recording)
    displacement = peak_speed(recording) / (2 * omega)
    force = inertia_guess(drive, recording) * displacement * omega**2
    return Scales(force=force, displacement=displacement, time=1 / omega)


def scan_unit(dimension: Dimension, recording: Recording) -> float:
    """Return the SI size of one unit in which :attr:`Parameter.scan` is counted, from the recording's own scales.

    Times are counted in the recording's duration, speeds in its peak speed, displacements in its range of position,
    torques in the RMS torque.
    """
    peak = peak_speed(recording)
    reach = float(np.ptp(recording["position"])) if "position" in recording else 0.0
    reach = reach or peak / dominant_frequency(recording)
    duration = float(np.ptp(longest_run(recording).time))
    size = recording.rms_torque ** float(dimension.force)
    along, time = float(dimension.displacement), float(dimension.time)
    if along == 0:
        return float(size * duration**time)
    return float(size * peak ** (-time) * reach ** (along + time))


def scanned_guess(drive: Drive, recording: Recording) -> dict[str, float]:
    """Return a first guess of parameters in SI, by key: nonlinear ones from their scan values, linear ones regressed.

    Parameters without scan values keep their declared initial values. Internal states are integrated along the measured
    motion of the first 20 000 samples.
    """
    inertia = inertia_guess(drive, recording)
    choices: list[Sequence[float]] = []
    for declared in (p.declared for p in drive.model.nonlinear_parameters):
        unit = scan_unit(declared.dimension, recording) if declared.scan else 1.0
        origin = float(np.min(recording["position"])) if declared.place and "position" in recording else 0.0
        values = [origin + unit * value for value in declared.scan] or [declared.initial]
        choices.append([min(max(value, declared.lower), declared.upper) for value in values])
    part = recording.with_channels(acceleration=smoothed_acceleration(recording))
    moving = np.abs(recording.velocity) > 0.02 * peak_speed(recording)
    moving &= ordinary(recording, part["acceleration"])
    if drive.model.states:
        part, moving = part.select(np.arange(len(part)) < _TRACED), moving[:_TRACED]
    else:
        rows = np.flatnonzero(moving)
        part = part.select(rows[:: max(1, len(rows) // 4000)])
        moving = np.ones(len(part), dtype=bool)
    torque = part.driving_torque - inertia * part["acceleration"]
    declared_linear = drive.model.linear_parameters
    names = [p.key for p in declared_linear]
    above = [(i, names.index(p.at_least)) for i, p in enumerate(declared_linear) if p.at_least in names]
    best: tuple[float, tuple[float, ...], Array] | None = None
    for nonlinear in itertools.islice(itertools.product(*choices), _MOST_COMBINATIONS):
        design, offset = drive.regressors(part, nonlinear)
        design, right = design[:, moving], (torque - offset)[moving]
        linear = bounded_least_squares(design, right, declared_linear, above)
        residual = rms(right - linear @ design)
        if best is None or residual < best[0]:
            best = (residual, nonlinear, linear)
    if best is None:
        raise EstimationError(f"'{drive.model.name}' has no value to start from")
    found = {drive.inertia_key: inertia}
    nonlinear_values, linear_values = iter(best[1]), iter(best[2])
    for p, is_linear in zip(drive.model.parameters, drive.model.linear, strict=True):
        found[p.key] = float(next(linear_values) if is_linear else next(nonlinear_values))
    return found


def bounded_least_squares(
    design: Array, right: Array, parameters: Sequence[ModelParameter], above: Sequence[tuple[int, int]] = ()
) -> Array:
    """Return θ that minimises ‖right − θ·design‖ within its bounds, with θ_i ≥ θ_j for each pair (i, j) in ``above``.

    θ_i is written as θ_j + d with d ≥ 0, whose column is that of θ_i, while the column of θ_j becomes the sum.
    """
    from scipy.optimize import lsq_linear

    lower, upper = np.array([p.declared.lower for p in parameters]), np.array([p.declared.upper for p in parameters])
    columns, low, high = design.copy(), lower.copy(), upper.copy()
    for i, j in above:
        columns[j] = columns[j] + design[i]
        low[i], high[i] = 0.0, np.inf
    size = np.sqrt(np.mean(columns**2, axis=1))
    size[size == 0] = 1.0
    scaled = (columns / size[:, None]).T
    found = np.linalg.lstsq(scaled, right, rcond=1e-9)[0]
    if np.any(found < low * size) or np.any(found > high * size):
        unit = float(np.max(np.abs(right))) or 1.0  # products of what diverges would overflow
        found = unit * lsq_linear(scaled, right / unit, (low * size / unit, high * size / unit)).x
    found = found / size
    for i, j in above:
        found[i] += found[j]
    return np.asarray(np.clip(found, lower, upper))


def mid_step(drive_inputs: Sequence[str], run: Recording, substeps: int, hold: Between) -> tuple[Array, Array]:
    """Return the durations, shape (N − 1,), and the inputs in the middle of every sub-step, (substeps (N − 1), m).

    Inputs run linearly between samples; a ``held`` motor torque keeps the value of the sample before.
    """
    durations = np.diff(run.time)
    fraction = (np.arange(substeps) + 0.5) / substeps
    columns = []
    for name in drive_inputs:
        values = run.signal(name)
        if name == "motor_torque" and hold == "held":
            columns.append(np.repeat(values[:-1], substeps))
        else:
            columns.append((values[:-1, None] * (1 - fraction) + values[1:, None] * fraction).ravel())
    return durations, np.stack(columns, axis=1) if columns else np.zeros((len(durations) * substeps, 0))
