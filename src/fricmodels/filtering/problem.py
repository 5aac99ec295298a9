"""Running a filter: normalised samples in, a trajectory of estimates out.

A filter's memory is the column ``[x; lower triangle of P]`` with x = velocity, internal states, parameters. It is
advanced by a compiled step (:class:`fricmodels.kernels.Scan`) whose input row is ``[duration, weight, y, u…]``: the
duration of the sub-step, the weight of the measurement at its end (zero where there is none), the measured velocity (or
the way since the run began), and the drive's inputs in the middle of the sub-step. Nothing connects two runs of a
recording: at the start of each, velocity and internal states begin anew, the parameters and their covariance are
carried on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.estimator import Solution
from fricmodels.filtering.bounds import normalised_bounds, projected
from fricmodels.filtering.covariance import pack, unpack
from fricmodels.filtering.normalisation import NormalisedSpace
from fricmodels.filtering.preparation import mid_step
from fricmodels.fit import Status
from fricmodels.kernels import Scan
from fricmodels.recording import Recording
from fricmodels.simulation import Between

if TYPE_CHECKING:
    import pandas as pd

HISTORY_ROWS = 50_000
_LOST = 1.0 / np.finfo(float).eps
"""Normalised states are of the order of one; beside a larger one than this no measurement changes a digit."""


class SampleFilter(Protocol):
    """A filter that takes one sub-step at a time, such as filterpy's.

    Attributes:
        x, P: estimate, shape (n,), and covariance, shape (n, n).
    """

    x: Array
    P: Array

    def step(self, duration: float, inputs: Array) -> None:
        """Predict over a sub-step of a normalised duration with the inputs in its middle."""

    def observe(self, measured: float) -> tuple[float, float]:
        """Take in what is measured; return the innovation and the variance that it is expected to have."""


@dataclass(frozen=True)
class Trajectory:
    """What a filter gave, normalised, one row per sample.

    Attributes:
        time: of each sample [s].
        states: x after the sample, shape (N, n).
        variances: diagonal of P after the sample, shape (N, n).
        innovation: measured minus predicted velocity or position, shape (N,); NaN at the first sample of a run.
        innovation_variance: what the filter takes its variance to be, shape (N,).
        memory: the last memory.
        diverged_at: index of the sample at which the estimate stopped being finite, or None.
    """

    time: Array
    states: Array
    variances: Array
    innovation: Array
    innovation_variance: Array
    memory: Array
    diverged_at: int | None


@dataclass(frozen=True)
class FilterProblem:
    """A drive ready to be filtered, in normalised units.

    Attributes:
        drive, scales, space: the drive, the units, its equations in these units.
        scan: the compiled step; its constants are those of :attr:`constants`.
        known: numbers of the drive that the equations need, see :meth:`NormalisedSpace.values`.
        measurement: R, the variance of the measured velocity or position (the weight Q of an observation in eq. 12).
        walk: diagonal of W, by how much the variance of each x grows in a unit of time.
        lower, upper: bounds of the parameters.
        initial_states, initial_parameters, initial_covariance: before the first sample.
        substeps: steps between two samples. hold: torque between samples.
    """

    drive: Drive
    scales: Scales
    space: NormalisedSpace
    scan: Scan
    known: Array
    measurement: float
    walk: Array
    lower: Array
    upper: Array
    initial_states: Array
    initial_parameters: Array
    initial_covariance: Array
    substeps: int
    hold: Between

    @property
    def constants(self) -> Array:
        """The constants of the compiled step: ``[known…, R, diagonal of W…, lower bounds…, upper bounds…]``."""
        return np.concatenate([self.known, [self.measurement], self.walk, self.lower, self.upper])

    @property
    def physical_bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the parameters that physics sets; :attr:`lower` and :attr:`upper` may be nearer."""
        return normalised_bounds(self.drive, self.scales)

    @property
    def moving(self) -> int:
        """How many of x are no parameters."""
        return self.space.moving

    @property
    def measured(self) -> int:
        """The place in x of what is measured."""
        return self.space.measured

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
        rows[:, 2] = np.repeat(self._measured(run)[1:], self.substeps)
        rows[:, 3:] = inputs
        return rows

    def _measured(self, run: Recording) -> Array:
        by_position = self.measured > 0  # the velocity comes first
        return run["position"] - run["position"][0] if by_position else run.velocity

    def run(self, recording: Recording) -> Trajectory:
        """Filter a recording in SI units with the compiled step."""

        def advance(memory: Array, run: Recording, outputs: Array) -> tuple[Array, int]:
            memory, outputs[1:], done = self.scan(memory, self.rows(run), self.constants, stride=self.substeps)
            return memory, 1 + done // self.substeps

        return self._over_runs(recording, advance)

    def run_stepwise(self, recording: Recording, kalman: SampleFilter) -> Trajectory:
        """Filter a recording in SI units with a filter that takes one sample at a time.

        The parameters are kept within their bounds. A filter that raises ``numpy.linalg.LinAlgError``, that is no
        longer finite, has a negative variance, or a state beside which all that is measured is rounding has diverged.
        """
        n = self.order

        def advance(memory: Array, run: Recording, outputs: Array) -> tuple[Array, int]:
            kalman.x, kalman.P = memory[:n].copy(), unpack(memory[n:], n)
            sample = 1
            for row in self.rows(run):
                try:
                    kalman.step(row[0], row[3:])
                    if not (np.all(np.abs(kalman.x) < _LOST) and np.all(np.isfinite(kalman.P))):
                        break
                    if not row[1] > 0:
                        continue
                    innovation = kalman.observe(row[2])
                except np.linalg.LinAlgError:
                    break
                kalman.x = projected(kalman.x, kalman.P, self.lower, self.upper, self.drive)
                variances = np.diag(kalman.P)
                if not (np.all(np.isfinite(kalman.x)) and np.all(variances >= 0)):
                    break
                outputs[sample] = [*kalman.x, *variances, *innovation]
                sample += 1
            return np.concatenate([kalman.x, pack(kalman.P)]), sample

        return self._over_runs(recording, advance)

    def _over_runs(
        self, recording: Recording, advance: Callable[[Array, Recording, Array], tuple[Array, int]]
    ) -> Trajectory:
        """Filter each run; ``advance`` fills a run's outputs and returns the memory and how many samples went well."""
        n, memory = self.order, self.initial_memory()
        outputs = np.full((len(recording), 2 * n + 2), np.nan)
        diverged = None
        scaled = recording.scaled(self.scales)
        for number in recording.run_numbers:
            where = np.flatnonzero(recording.run == number)
            run = scaled.select(where)
            memory = self.restarted(memory, float(run.velocity[0]))
            own = np.full((len(where), 2 * n + 2), np.nan)
            own[0, :n], own[0, n : 2 * n] = memory[:n], np.diag(unpack(memory[n:], n))
            done = 1
            if len(where) > 1:
                memory, done = advance(memory, run, own)
            outputs[where] = own
            if done < len(where):
                diverged = int(where[done])
                break
        columns = (outputs[:, :n], outputs[:, n : 2 * n], outputs[:, 2 * n], outputs[:, 2 * n + 1])
        return Trajectory(recording.time, *columns, memory, diverged)

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
        import pandas as pd

        stop = len(trajectory.time) if trajectory.diverged_at is None else trajectory.diverged_at
        stride = -(-stop // HISTORY_ROWS) if stop else 1
        kept = slice(0, stop, stride)
        values = self.parameters(trajectory.states[kept])
        spread = self.parameters(np.sqrt(np.maximum(trajectory.variances[kept], 0.0)))
        frame = {"time": trajectory.time[kept]}
        frame |= {key: values[:, i] for i, key in enumerate(self.drive.keys)}
        frame |= {f"sd({key})": spread[:, i] for i, key in enumerate(self.drive.keys)}
        return pd.DataFrame(frame)


def initial_states(drive: Drive, scales: Scales, *, by_position: bool = False) -> Array:
    """Return the normalised velocity, zero, the internal states at their initial values, and the position, zero."""
    states = [state.initial / scales.of(state.dimension) for state in drive.model.states]
    return np.array([0.0, *states, *([0.0] if by_position else [])])


def diverged(problem: FilterProblem, trajectory: Trajectory) -> Solution:
    """Return the solution of a filter that overflowed: it says at which sample."""
    at = trajectory.diverged_at or 0
    return Solution(
        status=Status.DIVERGED,
        message=f"the estimate stopped being finite at sample {at} (time {trajectory.time[at]:.6g} s)",
        history=problem.history(trajectory),
    )


def unidentified(problem: FilterProblem, trajectory: Trajectory, walked: float = 0.0) -> dict[str, str]:
    """Name the parameters whose variance the recording left above half of what it would be without it.

    That is the initial one, plus what a random walk (eq. 14 adds the unit matrix) has ``walked``.
    """
    before = np.diag(problem.initial_covariance)[problem.moving :] + walked
    after = np.diag(unpack(trajectory.memory[problem.order :], problem.order))[problem.moving :]
    return {
        key: "the recording reduces its variance by less than half"
        for key, variance, first in zip(problem.drive.keys, after, before, strict=True)
        if variance > 0.5 * first
    }
