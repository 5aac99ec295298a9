"""What all Kalman filters of a drive share: start, bounds and noise, found with the compiled extended filter."""

from __future__ import annotations

import itertools
import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from fricmodels.arrays import Array
from fricmodels.dimension import DISPLACEMENT, VELOCITY, Scales
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.estimator import Estimator, EstimatorSettings, Solution
from fricmodels.filtering.bounds import bounded, normalised_bounds
from fricmodels.filtering.covariance import symbolic_covariance, symbolic_pack, symbolic_prediction
from fricmodels.filtering.normalisation import NormalisedSpace, normalised_space
from fricmodels.filtering.preparation import (
    REST_WIDTH,
    dominant_frequency,
    paper_scales,
    peak_speed,
    position_noise,
    scanned_guess,
    velocity_noise,
)
from fricmodels.filtering.problem import FilterProblem, Trajectory, diverged, initial_states, unidentified
from fricmodels.filtering.substeps import stable_substeps
from fricmodels.filtering.transition import transition
from fricmodels.kernels import Scan
from fricmodels.recording import Recording
from fricmodels.simulation import Between

_FARTHEST = 3.0
"""How many initial standard deviations a parameter may move from its start."""
_CALIBRATION_SAMPLES = 20_000
_UNKNOWN = 0.1
"""Standard deviation of the velocity where a run begins and positions are measured, as a share of the peak speed."""
_MODEL_NOISE = (0.0, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)
_NOISE_FACTORS = (0.5, 0.7, 1.0, 1.4, 2.0)
_PRIOR_FACTORS = (1.0, 0.3, 0.1)
"""For laws with nonlinear parameters: how wide to start, as a share of the widest, lest linearisation fails."""
_ROUNDING = 1e-14
"""Share of a variance that rounding may take from it in a step, and that is given back: else P may lose its sign."""
_INDISTINCT = 1.92
"""Half the 95 % quantile of chi-square, one degree of freedom: model noise is assumed where it explains more."""


class KalmanSettings(EstimatorSettings):
    """Settings; what is left out comes from the data."""

    velocity_noise: float | None = Field(
        None, gt=0, description="standard deviation of the velocity noise, SI; from third differences and likelihood"
    )
    model_noise: float | None = Field(
        None, ge=0, description="white torque error of a sample over the RMS torque; by likelihood where not given"
    )
    drift: float = Field(0.0, ge=0, description="random walk of each parameter in a cycle, over its initial deviation")
    initial_inertia_deviation: float = Field(0.3, gt=0, description="relative, where the inertia is estimated")
    substeps: int | None = Field(None, ge=1, description="steps between samples; by stability where not given")
    torque: Between | None = Field(
        None, description="motor torque between samples: linear, or held; by likelihood where not given"
    )
    measured: Literal["velocity", "position"] | None = Field(
        None, description="what is measured: the velocity, or the position where the velocity is derived from it"
    )


class KalmanEstimator(Estimator):
    """A Kalman filter of velocity, internal states and constant parameters; a subclass writes :meth:`run`.

    Starts from a regression (nonlinear parameters from their scan), with standard deviations as wide as the torque
    itself. The noise of the measurement and of the model are those, on a grid, under which the innovations of an
    extended filter over the first 20 000 samples are likeliest; so is, for laws with nonlinear parameters, how wide it
    starts, and whether the torque is held between samples. Where the velocity was derived from a position that one is
    measured, if the filter of a subclass observes the element :attr:`FilterProblem.measured` of x, and says so.

    Attributes:
        filters_positions: whether it does.
    """

    filters_positions: ClassVar[bool] = False
    Settings: ClassVar[type[EstimatorSettings]] = KalmanSettings
    carries_states = True

    @abstractmethod
    def run(self, problem: FilterProblem, recording: Recording) -> Trajectory:
        """Filter a recording in SI units: the compiled way, or :meth:`FilterProblem.run_stepwise`."""

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        """Filter the recording; see the class."""
        problem = self.problem(drive, recording, by_position=self._by_position(recording))
        trajectory = self.run(problem, recording)
        if trajectory.diverged_at is not None:
            return diverged(problem, trajectory)
        return Solution(
            parameters=problem.named(problem.parameters(trajectory.memory[: problem.order])),
            not_identified=unidentified(problem, trajectory),
            history=problem.history(trajectory),
            notes={"noise": _noise(problem)},
        )

    def _by_position(self, recording: Recording) -> bool:
        """Whether the position is measured, and the velocity no more than what was derived from it."""
        settings = self.settings
        if settings.measured == "position" and not self.filters_positions:
            raise EstimationError(f"'{self.name}' does not filter positions; leave the setting 'measured' out")
        if settings.measured is not None:
            return bool(settings.measured == "position")
        derived = "velocity" in recording.derived and "position" in recording
        return self.filters_positions and settings.velocity_noise is None and derived

    def problem(self, drive: Drive, recording: Recording, *, by_position: bool = False) -> FilterProblem:
        """Return the filter before its first sample: scales, step, noise, bounds and start.

        Args:
            drive, recording: what is filtered.
            by_position: whether its samples are positions, not velocities. A derived velocity has noise of a colour
                that no such filter knows, and errors where a run begins: it takes them for motion.
        """
        settings = self.settings
        scales = paper_scales(drive, recording)
        space = normalised_space(drive, by_position=by_position)
        size = drive.parameter_scales(scales)
        lower, upper = normalised_bounds(drive, scales)
        guess = scanned_guess(drive, recording)
        start = np.clip(np.array([guess[key] for key in drive.keys]) / size, lower, upper)
        deviation = initial_deviation(drive, recording, start * size) / size
        if drive.inertia is None:
            deviation[0] = settings.initial_inertia_deviation
        linear = np.array([p.linear for p in drive.parameters])
        crest = float(np.max(np.abs(recording.torque)) / recording.rms_torque)
        largest = np.maximum(crest * deviation, 2.0 * (np.array(drive.keys) == drive.inertia_key))
        start = np.where(linear, np.clip(start, -largest, largest), start)
        lower = np.maximum(lower, start - _FARTHEST * deviation)
        upper = np.minimum(upper, start + _FARTHEST * deviation)
        noise, begins = self._measurement_noise(recording, scales, by_position=by_position)
        memory = [state.initial / scales.of(state.dimension) for state in drive.model.states]
        problem = FilterProblem(
            drive=drive,
            scales=scales,
            space=space,
            scan=Scan(kalman_step(space, drive)),
            known=space.values(drive, scales, REST_WIDTH * peak_speed(recording)),
            measurement=noise**2,
            walk=np.concatenate([np.zeros(space.moving), (settings.drift * deviation) ** 2 / (2 * np.pi)]),
            lower=lower,
            upper=upper,
            initial_states=initial_states(drive, scales, by_position=by_position),
            initial_parameters=start,
            initial_covariance=np.diag([*begins[:1], *(1e-6 + np.square(memory)), *begins[1:], *deviation**2]),
            substeps=settings.substeps or stable_substeps(drive, recording, scales),
            hold=settings.torque or "linear",
        )
        nonlinear = not all(p.linear for p in drive.parameters)
        factors = _NOISE_FACTORS if settings.velocity_noise is None else (1.0,)
        found, _ = self._calibrated(problem, recording, factors, _PRIOR_FACTORS if nonlinear else (1.0,))
        if settings.torque is not None:
            return found
        straight, score = self._calibrated(found, recording)
        held, likelier = self._calibrated(replace(found, hold="held"), recording)
        return held if likelier > score + _INDISTINCT else straight

    def _measurement_noise(
        self, recording: Recording, scales: Scales, *, by_position: bool
    ) -> tuple[float, list[float]]:
        """Return the deviation of what is measured, and the variances of velocity and position where a run begins."""
        if not by_position:
            noise = (self.settings.velocity_noise or velocity_noise(recording)) / scales.of(VELOCITY)
            return noise, [noise**2]
        noise = position_noise(recording) / scales.of(DISPLACEMENT)
        return noise, [(_UNKNOWN * peak_speed(recording) / scales.of(VELOCITY)) ** 2, noise**2]

    def _calibrated(
        self,
        problem: FilterProblem,
        recording: Recording,
        factors: Sequence[float] = (1.0,),
        priors: Sequence[float] = (1.0,),
    ) -> tuple[FilterProblem, float]:
        """Return the problem with the noise under which the innovations are likeliest, and how likely they are then.

        It is started where that run ends, unless this makes them less likely.

        Args:
            problem, recording: what is filtered.
            factors, priors: of the noise of the measurement, and of the deviations to start with, that are tried.
        """
        part = recording.select(np.arange(min(len(recording), _CALIBRATION_SAMPLES)))
        torque = recording.rms_torque / problem.scales.force
        step, known = recording.interval / problem.scales.time, self.settings.model_noise
        levels = _MODEL_NOISE if known is None else (known,)
        tried = []
        for prior, factor, level in itertools.product(priors, factors, levels):
            candidate = replace(
                problem,
                measurement=factor**2 * problem.measurement,
                walk=np.array([(level * torque) ** 2 * step, *problem.walk[1:]]),
                initial_covariance=_narrowed(problem, prior),
            )
            trajectory = candidate.run(part)
            tried.append((log_likelihood(trajectory), level, candidate, trajectory.memory))
        likeliest = max(score for score, *_ in tried)
        if likeliest == -math.inf:
            return tried[0][2], likeliest
        likely = [entry for entry in tried if entry[0] >= likeliest - _INDISTINCT]
        smallest = min(level for _, level, *_ in likely)
        score, _, chosen, memory = max((e for e in likely if e[1] == smallest), key=lambda entry: entry[0])
        again = replace(chosen, initial_parameters=memory[problem.moving : problem.order])
        from_there = log_likelihood(again.run(part))
        return (again, from_there) if from_there >= score else (chosen, score)


def _narrowed(problem: FilterProblem, factor: float) -> Array:
    """Return the initial covariance with the parameters' standard deviations multiplied by a factor."""
    deviations = np.ones(problem.order)
    deviations[problem.moving :] = factor
    return np.asarray(problem.initial_covariance * np.outer(deviations, deviations))


def initial_deviation(drive: Drive, recording: Recording, start: Array) -> Array:
    """Return the standard deviations in SI that parameters start with.

    A linear one may carry the whole RMS torque at the peak speed; a nonlinear one may be wrong by half.
    """
    omega = dominant_frequency(recording)
    torque = recording.rms_torque
    natural = Scales(force=torque, displacement=peak_speed(recording) / omega, time=1 / omega)
    size = drive.parameter_scales(natural)
    linear = np.array([p.linear for p in drive.parameters])
    return np.where(linear | (start == 0), size, 0.5 * np.abs(start))


def log_likelihood(trajectory: Trajectory) -> float:
    """Return the logarithm of the likelihood of the innovations; minus infinity for a run that diverged."""
    if trajectory.diverged_at is not None:
        return -math.inf
    with np.errstate(invalid="ignore", divide="ignore"):
        terms = np.log(trajectory.innovation_variance) + trajectory.innovation**2 / trajectory.innovation_variance
    total = -0.5 * float(np.nansum(terms))
    return total if math.isfinite(total) else -math.inf


def _noise(problem: FilterProblem) -> dict[str, float]:
    """Return the noise that the filter was given, in SI."""
    velocity = problem.scales.of(VELOCITY)
    what, size = ("position", problem.scales.of(DISPLACEMENT)) if problem.measured else ("velocity", velocity)
    return {
        what: float(np.sqrt(problem.measurement) * size),
        "model": float(np.sqrt(problem.walk[0] / problem.scales.time) * velocity),
    }


def kalman_step(space: NormalisedSpace, drive: Drive) -> Any:
    r"""Build one predict-and-update step as a CasADi function for :class:`fricmodels.kernels.Scan`.

    .. math::
        \hat x^- = f(\hat x, u),\; P^- = F P F^T + W\Delta t;\quad
        K = P^- H / (H^T P^- H + R),\; \hat x = \hat x^- + K (y - H^T \hat x^-),\; P = P^- - K (H^T P^- H + R) K^T

    H is 1 at what is measured, the velocity or the position, and 0 elsewhere. The update is left out where the weight
    of the row is zero.

    State: ``[x; lower triangle of P]``. Input: ``[Δt, weight, y, u…]``.
    Constants: those of :attr:`FilterProblem.constants`.
    Output: ``[x; diagonal of P; innovation; HᵀPH + R]``.
    """
    import casadi

    step = transition(space)
    n, moving = space.x.numel(), space.moving
    triangle, covariance = symbolic_covariance(n)
    weight, y, r = (casadi.SX.sym(name) for name in ("weight", "y", "R"))
    w = casadi.SX.sym("W", n)
    lower, upper = casadi.SX.sym("lower", n - moving), casadi.SX.sym("upper", n - moving)

    predicted, at = symbolic_prediction(step.jacobian, covariance, step.duration * w), space.measured
    spread = predicted[at, at] + r
    measured = casadi.sign(weight)
    gain = predicted[:, at] * (measured / spread)
    innovation = y - step.following[at]
    estimate = step.following + gain * innovation
    posterior = predicted - casadi.mtimes(gain, predicted[at, :])
    kept = predicted[at, :] * ((r + (1 - measured) * predicted[at, at]) / spread)
    posterior[at, :], posterior[:, at] = kept, kept.T
    posterior += casadi.diag(_ROUNDING * casadi.diag(predicted))
    estimate = bounded(estimate, posterior, lower, upper, drive)
    return casadi.Function(
        "kalman",
        [
            casadi.vertcat(space.x, triangle),
            casadi.vertcat(step.duration, weight, y, space.u),
            casadi.vertcat(space.known, r, w, lower, upper),
        ],
        [
            casadi.vertcat(estimate, symbolic_pack(posterior)),
            casadi.vertcat(estimate, casadi.diag(posterior), innovation, spread),
        ],
        {"cse": True},
    )
