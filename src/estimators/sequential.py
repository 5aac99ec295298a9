"""Running a filter: normalised samples in, a trajectory of estimates out, all at once or one sample at a time.

A filter's memory is the column ``[x; lower triangle of P]`` with x = velocity, internal states, parameters. It is
advanced by a compiled step (:class:`fricmodels.kernels.Scan`) whose input row is ``[duration, weight, y, u…]``: the
duration of the sub-step, the weight of the measurement at its end (zero where there is none), the measured velocity
and the drive's inputs in the middle of the sub-step. Nothing connects two runs of a recording: at the start of each,
velocity and internal states begin anew, the parameters and their covariance are carried on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from estimators.normalisation import NormalisedSpace
from estimators.preparation import Hold, mid_step
from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.estimator import OnlineFilter
from fricmodels.kernels import Scan
from fricmodels.recording import CHANNELS, SIGNAL_CHANNEL, Recording

Array = NDArray[np.float64]

HISTORY_ROWS = 50_000
_TINY = 1e-300


@dataclass(frozen=True)
class Trajectory:
    """What a filter gave, normalised, one row per sample.

    Attributes:
        time: of each sample [s].
        run: its run.
        states: x after the sample, shape (N, n).
        variances: diagonal of P after the sample, shape (N, n).
        innovation: measured minus predicted velocity, shape (N,); NaN at the first sample of a run.
        innovation_variance: what the filter takes its variance to be, shape (N,).
        memory: the last memory.
        diverged_at: index of the sample at which the estimate stopped being finite, or None.
    """

    time: Array
    run: NDArray[np.int64]
    states: Array
    variances: Array
    innovation: Array
    innovation_variance: Array
    memory: Array
    diverged_at: int | None


@dataclass(frozen=True)
class FilterProblem:
    """A drive ready to be filtered: scales, compiled step, constants and initial memory."""

    drive: Drive
    scales: Scales
    space: NormalisedSpace
    scan: Scan
    constants: Array
    initial_states: Array
    initial_parameters: Array
    initial_covariance: Array
    substeps: int
    hold: Hold

    @property
    def moving(self) -> int:
        """How many of x are velocity and internal states."""
        return self.space.moving

    @property
    def order(self) -> int:
        """Length of x."""
        return len(self.initial_covariance)

    def initial_memory(self) -> Array:
        """Return the memory before the first sample; :meth:`restarted` gives it its velocity."""
        x = np.concatenate([self.initial_states, self.initial_parameters])
        return np.concatenate([x, pack(self.initial_covariance)])

    def restarted(self, memory: Array, velocity: float) -> Array:
        """Return the memory at the first sample of a run: velocity as measured, internal states at their initial."""
        n, moving = self.order, self.moving
        x = memory[:n].copy()
        x[:moving] = self.initial_states
        x[0] = velocity
        covariance = unpack(memory[n:], n)
        covariance[:moving, moving:] = 0.0
        covariance[moving:, :moving] = 0.0
        covariance[:moving, :moving] = self.initial_covariance[:moving, :moving]
        return np.concatenate([x, pack(covariance)])

    def rows(self, run: Recording) -> Array:
        """Return the input rows of one normalised run, ``substeps`` for each sample but the first."""
        durations, inputs = mid_step(self.space.inputs, run, self.substeps, self.hold)
        rows = np.zeros((len(inputs), 3 + inputs.shape[1]))
        rows[:, 0] = np.repeat(durations / self.substeps, self.substeps)
        rows[self.substeps - 1 :: self.substeps, 1] = durations
        rows[:, 2] = np.repeat(run.velocity[1:], self.substeps)
        rows[:, 3:] = inputs
        return rows

    def run(self, recording: Recording, memory: Array | None = None) -> Trajectory:
        """Filter a recording in SI units from its first sample to its last."""
        n = self.order
        memory = self.initial_memory() if memory is None else memory
        outputs = np.full((len(recording), 2 * n + 2), np.nan)
        diverged = None
        scaled = recording.scaled(self.scales)
        for number in np.unique(recording.run):
            where = np.flatnonzero(recording.run == number)
            run = scaled.select(where)
            memory = self.restarted(memory, float(run.velocity[0]))
            outputs[where[0], :n] = memory[:n]
            outputs[where[0], n : 2 * n] = np.diag(unpack(memory[n:], n))
            if len(where) < 2:
                continue
            rows = self.rows(run)
            memory, out, done = self.scan(memory, rows, self.constants, stride=self.substeps)
            outputs[where[1:]] = out
            if done < len(rows):
                diverged = int(where[1 + done // self.substeps])
                break
        return Trajectory(
            recording.time,
            recording.run,
            outputs[:, :n],
            outputs[:, n : 2 * n],
            outputs[:, 2 * n],
            outputs[:, 2 * n + 1],
            memory,
            diverged,
        )

    def parameters(self, x: Array) -> Array:
        """Return the parameters in SI units from normalised x, shape (…, n) → (…, parameters)."""
        return np.asarray(x[..., self.moving :] * self.drive.parameter_scales(self.scales))

    def named(self, values: Array) -> dict[str, float]:
        """Return SI values by key, with the inertia where it was given."""
        named = {key: float(value) for key, value in zip(self.drive.keys, values, strict=True)}
        if self.drive.inertia is not None:
            named = {self.drive.inertia_key: self.drive.inertia, **named}
        return named

    def history(self, trajectory: Trajectory) -> pd.DataFrame:
        """Return ``time``, each parameter and its standard deviation by the filter's own P (``sd(KEY)``), in SI.

        Long histories are thinned to at most 50 000 rows.
        """
        stop = len(trajectory.time) if trajectory.diverged_at is None else trajectory.diverged_at
        stride = -(-stop // HISTORY_ROWS) if stop else 1
        kept = slice(0, stop, stride)
        values = self.parameters(trajectory.states[kept])
        spread = self.parameters(np.sqrt(np.maximum(trajectory.variances[kept], 0.0)))
        frame = {"time": trajectory.time[kept]}
        frame |= {key: values[:, i] for i, key in enumerate(self.drive.keys)}
        frame |= {f"sd({key})": spread[:, i] for i, key in enumerate(self.drive.keys)}
        return pd.DataFrame(frame)


class ProblemOnline(OnlineFilter):
    """A filter beside the drive: the same compiled step, one sample at a time.

    A sample has ``time``, ``torque``, ``velocity`` and the channels that the model needs, in SI; ``run`` is optional:
    where it changes, velocity and internal states begin anew.
    """

    def __init__(self, problem: FilterProblem) -> None:
        self._problem = problem
        self._memory = problem.initial_memory()
        self._previous: dict[str, float] | None = None
        space_inputs = [SIGNAL_CHANNEL[name] for name in problem.space.inputs]
        self._channels = tuple(dict.fromkeys(["time", "torque", "velocity", *space_inputs]))

    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take one sample and return the parameters.

        Raises:
            InputError: when a channel is missing, a value is not finite, or time does not increase.
        """
        problem = self._problem
        defaults = {"load_torque": 0.0, **sample}
        missing = [name for name in self._channels if name not in defaults]
        if missing:
            raise InputError(f"the sample has no '{missing[0]}', which this filter needs")
        present = {name: float(defaults[name]) for name in self._channels}
        if not all(np.isfinite(list(present.values()))):
            raise InputError(f"the sample at time {present['time']} has a value that is not finite; leave it out")
        present["run"] = float(sample.get("run", 0))
        previous = self._previous
        if previous is None or present["run"] != previous["run"]:
            velocity = present["velocity"] / problem.scales.of(CHANNELS["velocity"])
            self._memory = problem.restarted(self._memory, velocity)
        elif not present["time"] > previous["time"]:
            raise InputError(f"time must increase: {present['time']} follows {previous['time']}")
        else:
            pair = {name: np.array([previous[name], present[name]]) for name in self._channels}
            run = Recording("online", problem.drive.motion, pair, np.zeros(2, dtype=np.int64)).scaled(problem.scales)
            self._memory, _, _ = problem.scan(
                self._memory, problem.rows(run), problem.constants, stride=problem.substeps
            )
        self._previous = present
        return self.parameters

    @property
    def parameters(self) -> dict[str, float]:
        """The present estimate in SI."""
        return self._problem.named(self._problem.parameters(self._memory[: self._problem.order]))

    @property
    def covariance(self) -> Array:
        """The filter's own covariance of the estimated parameters in SI."""
        problem = self._problem
        covariance = unpack(self._memory[problem.order :], problem.order)[problem.moving :, problem.moving :]
        size = problem.drive.parameter_scales(problem.scales)
        return np.asarray(covariance * np.outer(size, size))


def pack(matrix: Array) -> Array:
    """Return the lower triangle, row by row."""
    return np.asarray(matrix[np.tril_indices(len(matrix))])


def unpack(triangle: Array, order: int) -> Array:
    """Return the symmetric matrix of a lower triangle."""
    matrix = np.zeros((order, order))
    matrix[np.tril_indices(order)] = triangle
    return np.asarray(matrix + np.tril(matrix, -1).T)


def symbolic_covariance(order: int) -> tuple[Any, Any]:
    """Return the packed column of symbols and the symmetric ``SX`` matrix of a covariance."""
    import casadi

    triangle = casadi.SX.sym("P", order * (order + 1) // 2)
    matrix = casadi.SX(order, order)
    for k, (i, j) in enumerate(zip(*np.tril_indices(order), strict=True)):
        matrix[int(i), int(j)] = triangle[k]
        matrix[int(j), int(i)] = triangle[k]
    return triangle, matrix


def symbolic_pack(matrix: Any) -> Any:
    """Return the lower triangle of an ``SX`` matrix, row by row: symmetry is kept because half is stored."""
    import casadi

    rows, columns = np.tril_indices(matrix.shape[0])
    return casadi.vertcat(*(matrix[int(i), int(j)] for i, j in zip(rows, columns, strict=True)))


def symbolic_prediction(jacobian: Any, covariance: Any, added: Any) -> Any:
    """Return F P Fᵀ plus a diagonal; elements mirrored across the diagonal are the same expressions."""
    import casadi

    predicted = casadi.mtimes([jacobian, covariance, jacobian.T]) + casadi.diag(added)
    return casadi.tril2symm(casadi.tril(predicted))


def bounded(x: Any, covariance: Any, lower: Any, upper: Any, drive: Drive) -> Any:
    """Return the state with its parameters moved to where their physical bounds allow.

    A stick torque below its slip torque, and a nonlinear parameter outside its bounds, are moved along the covariance,
    so that the other estimates follow as if the bound had been observed (Simon and Chia 2002); merely cutting them
    off would drive correlated parameters away together. What is then still outside is cut off.
    """
    import casadi

    moving = x.numel() - len(drive.keys)
    for i, j in _ordered(drive):
        along = covariance[:, moving + i] - covariance[:, moving + j]
        gap = casadi.fmax(x[moving + j] - x[moving + i], 0)
        x = x + along * (gap / casadi.fmax(along[moving + i] - along[moving + j], _TINY))
    for i in _nonlinear(drive):
        along, value = covariance[:, moving + i], x[moving + i]
        gap = casadi.fmin(casadi.fmax(value, lower[i]), upper[i]) - value
        x = x + along * (gap / casadi.fmax(along[moving + i], _TINY))
    parameters = casadi.fmin(casadi.fmax(x[moving:], lower), upper)
    for i, j in _ordered(drive):
        parameters[i] = casadi.fmax(parameters[i], parameters[j])
    return casadi.vertcat(x[:moving], parameters)


def projected(x: Array, covariance: Array, lower: Array, upper: Array, drive: Drive) -> Array:
    """Return what :func:`bounded` builds, for numbers."""
    moving = len(x) - len(drive.keys)
    for i, j in _ordered(drive):
        along = covariance[:, moving + i] - covariance[:, moving + j]
        gap = max(x[moving + j] - x[moving + i], 0.0)
        x = x + along * (gap / max(along[moving + i] - along[moving + j], _TINY))
    for i in _nonlinear(drive):
        along, value = covariance[:, moving + i], x[moving + i]
        x = x + along * ((np.clip(value, lower[i], upper[i]) - value) / max(along[moving + i], _TINY))
    parameters = np.clip(x[moving:], lower, upper)
    for i, j in _ordered(drive):
        parameters[i] = max(parameters[i], parameters[j])
    return np.concatenate([x[:moving], parameters])


def _ordered(drive: Drive) -> list[tuple[int, int]]:
    """Return pairs of parameters of which the first must not fall below the second."""
    return [
        (i, drive.keys.index(parameter.at_least))
        for i, parameter in enumerate(drive.parameters)
        if parameter.at_least is not None
    ]


def _nonlinear(drive: Drive) -> list[int]:
    """Return the parameters that do not enter the torque linearly."""
    return [i for i, parameter in enumerate(drive.parameters) if not parameter.linear]


def normalised_bounds(drive: Drive, scales: Scales) -> tuple[Array, Array]:
    """Return the lower and upper physical bounds of the estimated parameters; an inertia stays above a tenth of 1."""
    size = drive.parameter_scales(scales)
    lower = np.array([p.declared.lower for p in drive.parameters]) / size
    upper = np.array([p.declared.upper for p in drive.parameters]) / size
    if drive.inertia is None:
        lower[0] = 0.1
    return np.maximum(lower, -1e300), np.minimum(upper, 1e300)
