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

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.kernels import Scan
from fricmodels.recording import Recording

Between: TypeAlias = Literal["linear", "held"]

_MOTION = ("velocity", "position", "acceleration")
_NEWTON_STEPS = 2
_PHASES = 2
"""Legs of a step: to a stop and on, or at rest and away. What a third would do in the same step waits for the next."""
_AT_ONCE = 1e-9
"""Share of a step within which leaving rest is leaving at once."""
_scans: WeakKeyDictionary[Drive, Scan] = WeakKeyDictionary()


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
        name: of the recording.

    Returns:
        A recording with ``time``, ``torque``, ``velocity`` and what was given; ``provenance["true_parameters"]`` holds
        the values. Where the integration stops being finite the velocity is not a number from there on.

    Raises:
        InputError: for a model that needs a signal that was not given, a missing parameter, or times that do not
            increase.
    """
    times = np.asarray(time, dtype=float)
    channels = {"time": times, "torque": np.broadcast_to(np.asarray(torque, dtype=float), times.shape).copy()}
    for key, given in {"load_torque": load_torque, "temperature": temperature, **(further or {})}.items():
        if given is not None:
            channels[key] = np.broadcast_to(np.asarray(given, dtype=float), times.shape).copy()
    runs = np.broadcast_to(np.asarray(run, dtype=np.int64), times.shape).copy()
    driven = Recording(name, drive.motion, channels, runs, units=units or {})
    velocity, position = np.empty_like(times), np.empty_like(times)
    for number in np.unique(runs):
        mask = runs == number
        velocity[mask], position[mask] = _integrate(
            drive, values, driven.select(mask), initial_velocity, initial_position, between_samples, substeps
        )
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
    deviation = noise / 100 * float(np.sqrt(np.mean(velocity**2)))
    measured = velocity + deviation * np.random.default_rng(seed).standard_normal(len(velocity))
    if quantisation > 0:
        measured = quantisation * np.round(measured / quantisation)
    return np.asarray(measured[np.arange(len(velocity)) // hold * hold], dtype=float)


def simulated_velocity(
    drive: Drive,
    values: Mapping[str, float],
    recording: Recording,
    *,
    between_samples: Between = "linear",
    substeps: int = 1,
) -> Array:
    """Return the velocity that the drive would have under the recorded torque alone, shape (N,).

    Each run starts from its own first velocity (and position); nothing after that is taken from the measured motion.
    """
    simulated = np.empty(len(recording))
    for number in np.unique(recording.run):
        mask = recording.run == number
        one = recording.select(mask)
        position = float(one["position"][0]) if "position" in one else 0.0
        simulated[mask], _ = _integrate(drive, values, one, float(one.velocity[0]), position, between_samples, substeps)
    return simulated


def simulated_velocity_error(
    drive: Drive,
    values: Mapping[str, float],
    recording: Recording,
    *,
    between_samples: Between = "linear",
    substeps: int = 1,
) -> Array:
    """Return recorded minus simulated velocity, shape (N,); see :func:`simulated_velocity`."""
    return recording.velocity - simulated_velocity(
        drive, values, recording, between_samples=between_samples, substeps=substeps
    )


def _integrate(
    drive: Drive,
    values: Mapping[str, float],
    driven: Recording,
    initial_velocity: float,
    initial_position: float,
    between_samples: Between,
    substeps: int,
) -> tuple[Array, Array]:
    """Return velocity and position at the samples of one run."""
    if substeps < 1:
        raise InputError(f"substeps must be at least 1, got {substeps}")
    intervals = np.diff(driven.time)
    if len(intervals) == 0 or not np.all(intervals > 0):
        raise InputError(f"recording '{driven.name}' needs at least two increasing sample times to be simulated")
    driven.require(drive.model.required - {*_MOTION, "load_torque"}, drive.model.name)
    inertia, parameters = _checked(drive, values)
    step_length = np.repeat(intervals / substeps, substeps)
    columns = [step_length]
    for name in _inputs(drive):
        held = between_samples == "held" and name != "time"
        columns.extend(_ends(driven.signal(name), substeps, held=held))
    push = float(np.max(np.abs(driven.torque - driven.load_torque)))
    width = 1e-6 * float(np.median(intervals)) * push / inertia or 1e-9
    scan = _scans.get(drive)
    if scan is None:
        scan = _scans[drive] = Scan(_step(drive))
    states = [state.initial for state in drive.model.states]
    start = [initial_velocity, initial_position, *states, 0.0]
    rows = np.repeat(np.column_stack([*columns, np.zeros(len(step_length))]), _PHASES, axis=0)
    rows[_PHASES - 1 :: _PHASES, -1] = 1.0
    stride = substeps * _PHASES
    _, outputs, done = scan(start, rows, [inertia, *parameters, width], stride=stride)
    if done < len(rows):
        outputs[done // stride :] = np.nan
    velocity = np.concatenate([[initial_velocity], outputs[:, 0]])
    position = np.concatenate([[initial_position], outputs[:, 1]])
    return velocity, position


def _checked(drive: Drive, values: Mapping[str, float]) -> tuple[float, Array]:
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


def _inputs(drive: Drive) -> tuple[str, ...]:
    """Return the signals that drive the motion, in order."""
    needed = {"motor_torque", "load_torque", *drive.model.needs} - set(_MOTION)
    return tuple(name for name in drive.model.signals if name in needed)


class _Motion:
    """The drive's equations on one side of zero velocity, as expressions."""

    def __init__(self, drive: Drive) -> None:
        import casadi

        e = drive.model.expression()
        self.n_states = e.states.numel()
        self.parameters, self.width = e.parameters, e.width
        self.inertia = casadi.SX.sym("inertia")
        acceleration = e.signals["acceleration"]
        slope = casadi.jacobian(e.torque, acceleration)
        if casadi.depends_on(slope, acceleration):
            raise InputError(f"'{drive.model.name}' is not affine in the acceleration and cannot be simulated")
        at_zero = casadi.substitute(e.torque, acceleration, 0)
        applied = e.signals["motor_torque"] - e.signals["load_torque"]
        rate = (applied - at_zero) / (self.inertia + slope)
        arguments = [
            e.signals["velocity"], e.signals["position"], e.states, *(e.signals[name] for name in _inputs(drive))
        ]  # fmt: skip
        given = [self.inertia, self.parameters, self.width]
        self._rate = casadi.Function("rate", [*arguments, *given], [rate])
        self._excess = casadi.Function("excess", [*arguments, *given], [applied - at_zero])
        sliding = casadi.substitute(e.rates, acceleration, rate) if self.n_states else e.rates
        resting = casadi.substitute(e.rates, acceleration, 0) if self.n_states else e.rates
        self._sliding = casadi.Function("sliding", [*arguments, *given], [sliding])
        self._resting = casadi.Function("resting", [*arguments, *given], [resting])
        ends = [e.later["velocity"], e.later["position"], *(e.later[name] for name in _inputs(drive)), e.step]
        self._stepped = list(e.discrete_step)
        self._discrete_step = casadi.Function(
            "discrete_step", [*arguments, *ends, *given], [casadi.vertcat(*e.discrete_step.values())]
        )
        self._given = given

    def excess(self, direction: Any, position: Any, states: Any, inputs: list[Any]) -> Any:
        """Applied torque beyond what friction holds as the velocity goes to zero from one side."""
        tiny = 1e-9 * self.width
        return self._excess(direction * tiny, position, states, *inputs, *self._given)

    def _change(self, x: Any, direction: Any, position: Any, inputs: list[Any], *, moving: bool) -> Any:
        import casadi

        tiny = 1e-9 * self.width
        speed = casadi.fmax(direction * x[0], tiny) if moving else tiny
        states = x[1:]
        arguments = [direction * speed, position, states, *inputs, *self._given]
        if moving:
            return casadi.vertcat(self._rate(*arguments), self._sliding(*arguments))
        return casadi.vertcat(0, self._resting(*arguments))

    def leg(
        self,
        x: Any,
        position: Any,
        direction: Any,
        length: Any,
        begin: list[Any],
        end: list[Any],
        *,
        moving: bool,
    ) -> tuple[Any, Any]:
        """Advance ``x`` (velocity, internal states) and the position by the trapezium rule.

        Newton's matrix takes no credit for friction that falls with speed: where the law pushes, an iteration is a
        plain fixed-point one, and the rule is Heun's. States with a discrete step follow its formula.
        """
        import casadi

        first = self._change(x, direction, position, begin, moving=moving)
        solved = [0, *(1 + i for i in range(self.n_states) if i not in self._stepped)]
        unknown = casadi.SX.sym("x", len(solved))
        arrived = position + length / 2 * (x[0] + unknown[0])
        following = casadi.SX(x)
        following[solved] = unknown
        if self._stepped:
            speeds = [direction * casadi.fmax(direction * v, 0) if moving else 0 for v in (x[0], unknown[0])]
            stepped = self._discrete_step(
                speeds[0], position, x[1:], *begin, speeds[1], arrived, *end, length, *self._given
            )
            following[[1 + i for i in self._stepped]] = stepped
        last = self._change(following, direction, arrived, end, moving=moving)
        residual = (following - x - length / 2 * (first + last))[solved]
        matrix = casadi.jacobian(residual, unknown)
        matrix[0, 0] = casadi.fmax(matrix[0, 0], 1)
        improved = unknown - casadi.solve(matrix, residual)
        guess = (x + length * first)[solved]
        for _ in range(_NEWTON_STEPS):
            guess = casadi.substitute(improved, unknown, guess)
        return casadi.substitute(following, unknown, guess), position + length / 2 * (x[0] + guess[0])


def _step(drive: Drive) -> Any:
    """Build one phase of a step: the drive rests, or slides in one direction, until that ends or the step does.

    State: velocity, position, internal states, and how much of the step is done. Input: length of the step, each
    signal at its beginning and its end, and whether this is the step's last phase, which goes to its end.
    """
    import casadi

    motion = _Motion(drive)
    state = casadi.SX.sym("state", 3 + motion.n_states)
    count = len(_inputs(drive))
    inputs = casadi.SX.sym("input", 2 + 2 * count)
    constants = casadi.vertcat(motion.inertia, motion.parameters, motion.width)
    x, position, done = casadi.vertcat(state[0], state[2:-1]), state[1], state[-1]
    last_phase = inputs[-1] > 0
    end = [inputs[2 + 2 * i] for i in range(count)]
    begin = [inputs[1 + 2 * i] + done * (inputs[2 + 2 * i] - inputs[1 + 2 * i]) for i in range(count)]
    left = (1 - done) * inputs[0]

    # At rest: held while neither limit is passed; ``wait`` is the share of what is left until one of them is.
    above = [motion.excess(1, position, x[1:], ends) for ends in (begin, end)]
    below = [motion.excess(-1, position, x[1:], ends) for ends in (begin, end)]
    within = casadi.logic_and(x[0] == 0, casadi.logic_and(above[0] <= 0, below[0] >= 0))
    up = above[1] > 0
    leaves = casadi.logic_or(up, below[1] < 0)
    share = casadi.if_else(up, above[0] / (above[0] - above[1]), below[0] / (below[0] - below[1]))
    at_once = casadi.logic_and(leaves, share <= _AT_ONCE)
    rests = casadi.logic_and(within, casadi.logic_not(at_once))
    wait = casadi.if_else(casadi.logic_and(leaves, casadi.logic_not(last_phase)), share, 1)
    held, _ = motion.leg(x, position, 1, wait * left, begin, end, moving=False)

    # Sliding, up to where the velocity passes zero.
    leaving_up = casadi.if_else(within, up, above[0] > 0)
    forward = casadi.if_else(x[0] == 0, leaving_up, x[0] > 0)
    direction = casadi.if_else(forward, 1, -1)
    slid, reached = motion.leg(x, position, direction, left, begin, end, moving=True)
    stops = casadi.logic_and(direction * slid[0] <= 0, left > 0)
    part = casadi.if_else(stops, x[0] / (x[0] - slid[0]), 1)
    stopped = x + part * (slid - x)
    stopped[0] = 0

    def choose(yes: Any, no: Any, otherwise: Any) -> Any:
        return casadi.if_else(rests, yes, casadi.if_else(stops, no, otherwise))

    final = [choose(held[i], stopped[i], slid[i]) for i in range(x.numel())]
    final_position = choose(position, position + part * left * x[0] / 2, reached)
    final_done = casadi.if_else(last_phase, 0, done + (1 - done) * choose(wait, part, 1))
    following = casadi.vertcat(final[0], final_position, *final[1:], final_done)
    return casadi.Function("step", [state, inputs, constants], [following, following[:2]], {"cse": True})
