"""Simulates a drive under a given torque: Karnopp's stick detection, trapezium rule, and simple sensors.

While the drive slides in one direction its friction is smooth, and a step is the implicit trapezium rule

.. math:: x_{k+1} = x_k + \\tfrac h2 [f(x_k, u_k) + f(x_{k+1}, u_{k+1})],

solved by Newton's method. Where the velocity passes zero within a step, the step is cut there and the velocity set
to exactly zero. At zero the drive sticks as long as the applied torque lies between the limits of the model's torque
as ω → −0 and ω → +0; it leaves at the instant, within the step, at which the torque passes one of them. Nothing of
this knows which law it simulates: the two limits are the law's own.

Source: D. Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", 1985, with the instant
of stopping and of breakaway instead of a band of small velocities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array, Mask, rms
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.kernels import Scan
from fricmodels.loop import Loop
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.stick_slip import MOTION, phase_of_step, pushing_signals

Between: TypeAlias = Literal["linear", "held"]

PHASES = 2
"""Legs of a step: to a stop and on, or at rest and away. What a third would do in the same step waits for the next."""
_KEPT = 200_000
"""Steps of which the inputs are kept, some 100 bytes each."""
_scans: WeakKeyDictionary[Drive, WeakKeyDictionary[Loop | Drive, Scan]] = WeakKeyDictionary()


def simulate(
    drive: Drive,
    values: Mapping[str, float],
    time: ArrayLike,
    torque: ArrayLike,
    *,
    load_torque: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    further: Mapping[str, ArrayLike] | None = None,
    units: Mapping[str, str] | None = None,
    run: ArrayLike = 0,
    initial_velocity: float = 0.0,
    initial_position: float = 0.0,
    between_samples: Between = "linear",
    substeps: int = 1,
    noise: float = 0.0,
    quantisation: float = 0.0,
    hold: int = 1,
    seed: int = 0,
    with_position: bool | None = None,
    initial_states: Sequence[float] | None = None,
    width: float | None = None,
    name: str = "simulated",
) -> Recording:
    """Simulate the drive and measure its velocity.

    Args:
        drive: the model and its motion.
        values: the model's parameters by key, in SI units, and the inertia unless the drive has one.
        time: sample times [s], shape (N,), increasing within a run; they need not be even.
        torque: motor torque [N m] or force [N] at the samples.
        load_torque: known load torque at the samples; zero where it is not given.
        temperature: temperature at the samples [°C], for models that need it.
        further: further channels at the samples by name, such as ``other.j2_velocity``, for models that need them.
        units: SI units of the further channels; see :attr:`fricmodels.recording.Recording.units`.
        run: number of the run of each sample.
        initial_velocity, initial_position: at the first sample of each run.
        between_samples: ``linear`` joins the samples of the torque, ``held`` keeps each until the next one.
        substeps: steps of integration per sampling interval.
        noise: standard deviation of white noise on the velocity, in percent of the RMS velocity.
        quantisation: smallest step of the measured velocity [rad/s or m/s]; 0 for none.
        hold: the velocity sensor gives a new value only every so many samples.
        seed: of the noise.
        with_position: whether the recording has the position; as a rule, where the model needs it.
        initial_states: internal states at the first sample of each run; as declared where not given.
        width: width of rest [velocity]; a millionth of what the torque adds to the velocity in a sample if not given.
        name: of the recording.

    Returns:
        A recording with ``time``, ``torque``, ``velocity`` and what was given; ``provenance["true_parameters"]`` holds
        the values. Where the integration stops being finite the velocity is not a number from there on.

    Raises:
        InputError: for a model that needs a signal that was not given, a missing parameter, times that do not
            increase, or none, or another way between samples.
    """
    _check_between(between_samples)
    times = np.asarray(time, dtype=float)
    if not times.size:
        raise InputError("there is nothing to simulate: the torque has no sample")
    channels = {"time": times, "torque": np.broadcast_to(np.asarray(torque, dtype=float), times.shape).copy()}
    for key, given in {"load_torque": load_torque, "temperature": temperature, **(further or {})}.items():
        if given is not None:
            channels[key] = np.broadcast_to(np.asarray(given, dtype=float), times.shape).copy()
    for key, values_of in channels.items():
        wrong = np.flatnonzero(~np.isfinite(values_of))
        if len(wrong):
            raise InputError(f"the {key} is no finite number at sample {wrong[0] + 1}; give one for every sample")
    runs = np.broadcast_to(np.asarray(run, dtype=np.int64), times.shape).copy()
    driven = Recording(name, drive.motion, channels, runs, units=units or {})
    velocity, position = np.empty_like(times), np.empty_like(times)
    pushed, timed = drive.timed(driven, values)
    for number in np.unique(runs):
        mask = runs == number
        velocity[mask], position[mask] = _integrate(
            drive, timed, pushed.select(mask), initial_velocity, initial_position, between_samples, substeps,
            initial_states, width,
        )  # fmt: skip
    channels["velocity"] = measure(velocity, noise=noise, quantisation=quantisation, hold=hold, seed=seed)
    if with_position or (with_position is None and "position" in drive.model.needs):
        channels["position"] = position
    inertia, _ = drive.split(values)
    provenance = {
        "simulated": drive.model.name,
        "true_parameters": {
            drive.inertia_key: inertia,
            **{p.key: float(values[p.key]) for p in drive.model.parameters},
        },
        "noise_percent": noise,
        "seed": seed,
    }
    return Recording(name, drive.motion, channels, runs, provenance=provenance, units=units or {})


def measure(velocity: Array, *, noise: float = 0.0, quantisation: float = 0.0, hold: int = 1, seed: int = 0) -> Array:
    """Return what a simple sensor makes of a velocity: white noise, quantisation, sample and hold, in this order.

    Args:
        velocity: the true velocity, shape (N,).
        noise: standard deviation in percent of the RMS velocity.
        quantisation: smallest step; 0 for none.
        hold: a new value only every so many samples.
        seed: of the noise.
    """
    if noise < 0 or quantisation < 0 or hold < 1:
        raise InputError("noise and quantisation must not be negative, and hold at least 1")
    deviation = noise / 100 * rms(velocity)
    measured = velocity + deviation * np.random.default_rng(seed).standard_normal(len(velocity))
    if quantisation > 0:
        measured = quantisation * np.round(measured / quantisation)
    return np.asarray(measured[np.arange(len(velocity)) // hold * hold], dtype=float)


def simulated_velocity(
    drive: Drive, values: Mapping[str, float], recording: Recording, *, between_samples: Between = "linear"
) -> Array:
    """Return the velocity that the drive would have under the recorded torque alone, shape (N,).

    Each run starts from its own first velocity (and position); nothing after that is taken from the measured motion.
    """
    simulated = np.empty(len(recording))
    for mask, one in _each_run(recording):
        position = float(one["position"][0]) if "position" in one else 0.0
        simulated[mask], _ = _integrate(drive, values, one, float(one.velocity[0]), position, between_samples, 1)
    return simulated


def simulated_velocity_error(drive: Drive, values: Mapping[str, float], recording: Recording) -> Array:
    """Return recorded minus simulated velocity, shape (N,); see :func:`simulated_velocity`."""
    return recording.velocity - simulated_velocity(drive, values, recording)


def _integrate(
    drive: Drive,
    values: Mapping[str, float],
    driven: Recording,
    initial_velocity: float,
    initial_position: float,
    between_samples: Between,
    substeps: int,
    initial_states: Sequence[float] | None = None,
    width: float | None = None,
) -> tuple[Array, Array]:
    """Return velocity and position at the samples of one run."""
    if substeps < 1:
        raise InputError(f"substeps must be at least 1, got {substeps}")
    intervals = np.diff(driven.time)
    if len(intervals) == 0 or not np.all(intervals > 0):
        raise InputError(f"recording '{driven.name}' needs at least two increasing sample times to be simulated")
    driven.require(drive.model.required - {*MOTION, "load_torque"}, drive.model.name)
    inertia, parameters = checked(drive, values)
    rows = _rows(drive, driven, between_samples, substeps)
    if width is None:
        width = width_of_rest(driven, inertia)
    states = [state.initial for state in drive.model.states] if initial_states is None else initial_states
    start = [initial_velocity, initial_position, *states, 0.0]
    stride = substeps * PHASES
    _, outputs, done = stepping(drive)(start, rows, [inertia, *parameters, width], stride=stride)
    if done < len(rows):
        outputs[done // stride :] = np.nan
    velocity = np.concatenate([[initial_velocity], outputs[:, 0]])
    position = np.concatenate([[initial_position], outputs[:, 1]])
    return velocity, position


@once
def _runs(recording: Recording) -> list[tuple[Mask, Recording]]:
    """Return the samples of each run, and the run on its own."""
    masks = [recording.run == number for number in recording.run_numbers]
    return [(mask, recording.select(mask)) for mask in masks]


def _each_run(recording: Recording) -> list[tuple[Mask, Recording]]:
    if len(recording.run_numbers) > 1:
        return _runs(recording)
    return [(np.ones(len(recording), dtype=bool), recording)]


def _check_between(between_samples: str) -> None:
    """Refuse a way between samples that there is not."""
    if between_samples not in ("linear", "held"):
        raise InputError(f"between_samples is linear or held, not '{between_samples}'")


def _rows(drive: Drive, driven: Recording, between_samples: Between, substeps: int) -> Array:
    """Return :func:`stepping_rows`, kept with a recording that is not long: a fit simulates it many times."""
    if len(driven) * substeps > _KEPT:
        return stepping_rows(drive, driven, between_samples, substeps)
    known, key = _known_rows(driven), (pushing_signals(drive), between_samples, substeps)
    if key not in known:
        known[key] = stepping_rows(drive, driven, between_samples, substeps)
    return known[key]


@once
def _known_rows(_: Recording) -> dict[tuple[object, ...], Array]:
    return {}


def stepping_rows(
    drive: Drive, driven: Recording, between_samples: Between, substeps: int, loop: Loop | None = None
) -> Array:
    """Return the inputs of :func:`stepping` along one run, shape (PHASES · substeps · (N − 1), inputs)."""
    step_length = np.repeat(np.diff(driven.time) / substeps, substeps)
    columns = [step_length]
    for name in pushing_signals(drive, loop):
        held = between_samples == "held" and name != "time"
        columns.extend(_ends(driven.signal(name), substeps, held=held))
    rows = np.empty((len(step_length), PHASES, len(columns) + 1))
    for i, column in enumerate(columns):
        rows[:, :, i] = column[:, None]
    rows[:, :, -1] = 0.0
    rows[:, PHASES - 1, -1] = 1.0
    return rows.reshape(-1, rows.shape[2])


def width_of_rest(driven: Recording, inertia: float) -> float:
    """Return a millionth of what the torque adds to the velocity in a sample."""
    step, push = _step_and_push(driven)
    return 1e-6 * step * push / inertia or 1e-9


@once
def _step_and_push(driven: Recording) -> tuple[float, float]:
    """Return the median sampling interval and the largest torque that drives."""
    return float(np.median(np.diff(driven.time))), float(np.max(np.abs(driven.driving_torque)))


def advanced(
    drive: Drive,
    values: Mapping[str, float],
    moving: Sequence[float],
    begin: Mapping[str, float],
    end: Mapping[str, float],
    interval: float,
    width: float,
) -> tuple[float, ...]:
    """Return a drive's velocity, position and internal states a sampling interval later, as :func:`simulate` does.

    Args:
        drive: the model and its motion.
        values: parameters by key, the inertia unless the drive has one.
        moving: velocity, position, internal states.
        begin, end: the signals that push, at the beginning and the end of the interval: see :func:`pushing_signals`.
        interval: its length [s].
        width: width of rest [velocity].
    """
    inertia, parameters = checked(drive, values)
    row = [interval, *(x for name in pushing_signals(drive) for x in (begin[name], end[name]))]
    rows = [[*row, float(phase == PHASES - 1)] for phase in range(PHASES)]
    last, _, done = stepping(drive)([*moving, 0.0], rows, [inertia, *parameters, width])
    return tuple(last[:-1].tolist()) if done == PHASES else (float("nan"),) * len(moving)


def stepping(drive: Drive, loop: Loop | None = None) -> Scan:
    """Return the compiled recursion over the phases of :func:`fricmodels.stick_slip.phase_of_step`."""
    scans = _scans.setdefault(drive, WeakKeyDictionary())
    scan = scans.get(loop or drive)
    if scan is None:
        scan = scans[loop or drive] = Scan(phase_of_step(drive, loop))
    return scan


def checked(drive: Drive, values: Mapping[str, float]) -> tuple[float, Array]:
    """Return the inertia and the model's parameters.

    Raises:
        InputError: for a value that is missing, or an inertia that is not positive.
    """
    try:
        inertia, parameters = drive.split(values)
    except KeyError as missing:
        raise InputError(f"to simulate '{drive.model.name}' a value is needed for {missing}") from None
    if not inertia > 0:
        raise InputError(f"to simulate '{drive.model.name}' the inertia must be positive, got {inertia}")
    return inertia, parameters


def _ends(signal: Array, substeps: int, *, held: bool) -> tuple[Array, Array]:
    """Return a signal at the beginning and the end of every step."""
    if held:
        kept = np.repeat(signal[:-1], substeps)
        return kept, kept
    fractions = np.arange(substeps) / substeps
    rise = np.diff(signal)[:, None]
    begin = (signal[:-1, None] + rise * fractions).ravel()
    end = (signal[:-1, None] + rise * (fractions + 1 / substeps)).ravel()
    return begin, end
