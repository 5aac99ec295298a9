"""Fits the torque equation of a drive: weak form, or derivatives of filtered signals."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.batch.inference import covariance
from estimators.batch.least_squares import NormalEquations
from estimators.batch.problem import Outcome, Plan, linear_constraints, nonlinear_search
from estimators.batch.projection import Equations, Projection, Solution
from estimators.batch.separable import Memory, Separable, separable
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.recording import Recording
from fricmodels.signals import Preparation
from fricmodels.signals.order_spectrum import wave_numbers
from fricmodels.weakform.test_functions import HOPS, Quadrature, TestFunctions, segments

Array = NDArray[np.float64]

SMOOTH = 64
"""Samples that a bump spans when the nonlinear parameters of a model with memory are sought: through narrower ones a
contact that closes a sample late is an error of its own, and the search ends where few are late, far from the truth."""
AS_GOOD = 1.1
"""Standard errors larger than the smallest by no more than this factor are as good."""


@dataclass(frozen=True)
class TorqueFit:
    """A torque-error fit in the order of the drive's parameters, in SI units.

    Attributes:
        values: the estimates, and what parameters were held at.
        covariance: of all parameters together, as if none was held.
        conditional: covariance of the others where some are held at the right value; zero for those.
        solution: in the order ``order`` gives: inertia, linear, nonlinear.
        order: place in the solution of each of the drive's parameters.
        width: samples that a bump spans, or an equation is decimated from.
        relative_error: ‖error‖/‖torque‖ over the equations.
    """

    values: Array
    covariance: Array
    conditional: Array
    solution: Solution
    order: NDArray[np.int64]
    width: int
    relative_error: float

    @property
    def outcome(self) -> Outcome:
        """The estimates and how they ended."""
        undetermined = self.solution.normal.null[self.order]
        return Outcome(self.values, self.covariance, undetermined, self.solution.converged, self.message)

    @property
    def message(self) -> str:
        """Why it did not end well; empty where it did."""
        return "" if self.solution.converged else f"no minimum after {self.solution.iterations} iterations"


def weak_equations(drive: Drive, quadrature: Quadrature, bumps: TestFunctions, recording: Recording) -> Equations:
    """Return the equation of motion seen through bumps."""
    split = separable(drive.model)
    driving = (quadrature.recording.torque - quadrature.recording.load_torque)[None]
    momentum = bumps.momentum(recording.velocity)
    push = bumps.of_cells(quadrature.impulses(driving))[0]
    target = push if drive.inertia is None else push - drive.inertia * momentum

    def memory(parameters: Array) -> list[Array]:
        velocity = quadrature.recording.velocity[: len(recording)]
        states = drive.states(recording.with_channels(velocity=velocity), parameters)
        cell = quadrature.cell
        return [np.concatenate([z, z[cell], z[cell + 1]]) for z in states]

    def moving(alpha: Array, slopes: bool) -> Array:
        rows = split.moving_rows(quadrature.recording, alpha, memory, slopes=slopes)
        return bumps.of_cells(quadrature.impulses(rows))

    def waves(residual: Array, j: int, alpha: Array) -> tuple[float, ...]:
        amplitude = _amplitude(split, quadrature.recording, memory, j, alpha)[: len(recording)]
        travel = np.abs(quadrature.recording.velocity[: len(recording)]) * quadrature.weight
        weights = quadrature.weight * bumps.spread(residual) * amplitude
        return _wave_numbers(recording["position"], weights, travel * bumps.width)

    fixed = bumps.of_cells(quadrature.impulses(split.fixed_rows(quadrature.recording)))
    return Equations(split, push, target, momentum if drive.inertia is None else None, fixed, moving, waves)


def _amplitude(split: Separable, recording: Recording, memory: Memory, j: int, alpha: Array) -> Array:
    """Return what a periodic torque is in proportion to: the larger of its rows at wave number 0, shape (N,)."""
    still = np.where(np.arange(len(alpha)) == j, 0.0, alpha)
    rows = split.moving_rows(recording, still, memory, slopes=False)
    own = [rows[split.moving.index(row)] for row, place in split.slopes if place == j]
    return np.asarray(max(own, key=lambda row: float(row @ row)))


def _wave_numbers(position: Array, weights: Array, passed: Array) -> tuple[float, ...]:
    """Return the wave numbers of a residual; ``passed`` is the way that an equation spans at each sample.

    In a fifth of the samples in motion an equation must span less than a period, or it averages the effect away.
    """
    moving = passed > 0.0
    if not moving.any():
        return ()
    return wave_numbers(position, weights, 2 * np.pi / float(np.percentile(passed[moving], 20))).strongest


def fit_equations(
    drive: Drive,
    recording: Recording,
    equations: Equations,
    independent: float,
    width: int,
    plan: Plan,
    start: Array | None = None,
) -> TorqueFit:
    """Solve, and order parameters and covariance as the drive has them; ``start`` is for the nonlinear parameters."""
    linear = [p for p in drive.parameters if p.linear]
    held = {i: plan.held[p.key] for i, p in enumerate(linear) if p.key in plan.held}
    constraints, limits = linear_constraints(linear)
    if len(equations.target) <= len(drive.parameters):
        raise _too_few(drive, recording, len(equations.target))
    solution = Projection(equations, constraints, limits, held).solve(nonlinear_search(drive, recording, plan), start)
    order = np.argsort(_places(drive, equations.separable), kind="stable")
    spread = covariance(solution.jacobian.T, solution.residual, solution.normal.inverse, independent)[
        np.ix_(order, order)
    ]
    conditional = spread
    if plan.held:
        free = np.array([i for i, p in zip(order, drive.parameters, strict=True) if p.key not in plan.held])
        part = solution.jacobian[free]
        inverse = NormalEquations.of(part @ part.T, part @ solution.residual).inverse
        conditional = np.zeros((len(order), len(order)))
        conditional[np.ix_(free, free)] = covariance(part.T, solution.residual, inverse, independent)
        conditional = conditional[np.ix_(order, order)]
    error = float(np.linalg.norm(solution.residual) / np.linalg.norm(equations.driving))
    values = _within_bounds(drive, np.concatenate([solution.theta, solution.alpha])[order])
    return TorqueFit(values, spread, conditional, solution, order, width, error)


def _within_bounds(drive: Drive, values: Array) -> Array:
    """Remove what rounding leaves beyond a bound that the solver has met."""
    exact = np.array(
        [np.clip(v, p.declared.lower, p.declared.upper) for v, p in zip(values, drive.parameters, strict=True)]
    )
    for i, p in enumerate(drive.parameters):
        if p.at_least in drive.keys:
            exact[i] = max(exact[i], exact[drive.keys.index(p.at_least)])
    return exact


def _too_few(drive: Drive, recording: Recording, equations: int) -> EstimationError:
    return EstimationError(
        f"recording '{recording.name}' gives {equations} equations for {len(drive.parameters)} "
        "parameters of the drive; it moves too little or is too short"
    )


def _places(drive: Drive, split: Separable) -> NDArray[np.int64]:
    shift = 0 if drive.inertia is not None else 1
    first = [0] * shift
    return np.array([*first, *(shift + i for i in (*split.linear, *split.nonlinear))])


def weak_fit(
    drive: Drive,
    recording: Recording,
    width: int | None,
    resting: NDArray[np.bool_],
    velocity: Array,
    plan: Plan,
    start: Array | None = None,
) -> TorqueFit:
    """Fit the weak form, the friction evaluated at ``velocity``; ``start`` is for the nonlinear parameters.

    Without a width, those of :func:`possible_widths` are tried, for a model with memory from what a search through
    smooth ones found. Wide bumps suppress noise, narrow ones keep more of the motion; taken is the narrowest whose
    standard errors are, in the geometric mean, within a tenth of the smallest.
    """
    quadrature = Quadrature.of(recording, velocity, resting)
    if width is not None:
        return _fit_width(drive, recording, quadrature, width, resting, plan, start)
    widths = possible_widths(recording)
    if drive.model.states and start is None:
        smooth = max(w for w in widths if w <= SMOOTH)
        with suppress(EstimationError):  # too few wide bumps; narrower ones may do
            start = _fit_width(drive, recording, quadrature, smooth, resting, plan).solution.alpha
    fits: list[TorqueFit] = []
    spreads: list[float] = []
    for candidate in widths:
        try:
            begin = fits[-1].solution.alpha if fits else start
            fits.append(_fit_width(drive, recording, quadrature, candidate, resting, plan, begin))
        except EstimationError:
            if candidate == widths[-1] and not fits:
                raise
            continue
        spreads.append(_mean_log_error(fits[-1]))
        if spreads[-1] > min(spreads) + np.log(AS_GOOD):
            break
    enough = min(spreads) + np.log(AS_GOOD)
    return next(fit for fit, spread in zip(fits, spreads, strict=True) if spread <= enough)


def possible_widths(recording: Recording) -> list[int]:
    """Return 16, 32, 64, … samples, as long as 24 bumps fit side by side: fewer give no reliable standard errors."""
    pieces = [piece.stop - piece.start for piece in segments(recording)]
    return [16, *(16 * 2**i for i in range(1, 12) if sum(piece // (16 * 2**i) for piece in pieces) >= 24)]


def _mean_log_error(fit: TorqueFit) -> float:
    """Return the mean logarithm of the standard errors; infinite where something is undetermined."""
    spread = np.diag(fit.covariance)
    determined = np.all(spread > 0.0) and fit.solution.normal.rank == len(fit.values)
    return float(np.mean(np.log(spread))) / 2.0 if determined else np.inf


def derivative_equations(drive: Drive, recording: Recording, preparation: Preparation) -> tuple[Equations, Recording]:
    """Return the equation of motion at samples of filtered signals and their derivatives, and the filtered recording.

    Both sides are evaluated at every filtered sample and then low-pass filtered and decimated alike ("parallel
    filtering"). Source: M. Gautier, "Dynamic identification of robots with power model", 1997; A. Janot, M. Gautier,
    M. Brunot, "Data set and reference models of EMPS", 2019.
    """
    from fricmodels.signals import prepare, resting

    marked = recording.with_channels(at_rest=resting(recording).astype(float))
    filtered = prepare(marked, preparation.model_copy(update={"decimate": 1, "smooth_velocity": True}))
    in_motion = 1.0 - filtered["at_rest"]
    factor = preparation.decimate
    parts = [part for part in segments(filtered) if part.stop - part.start > 30 * factor]
    if not parts:
        raise EstimationError(f"recording '{recording.name}' is too short to keep every {factor}th sample only")

    def seen(rows: Array) -> Array:
        return np.concatenate([_decimated(rows[:, part] * in_motion[part], factor) for part in parts], axis=1)

    split = separable(drive.model)

    def moving(alpha: Array, slopes: bool) -> Array:
        return seen(split.moving_rows(filtered, alpha, lambda p: drive.states(filtered, p), slopes=slopes))

    driving = seen((filtered.torque - filtered.load_torque)[None])[0]
    acceleration = seen(filtered["acceleration"][None])[0]
    target = driving if drive.inertia is None else driving - drive.inertia * acceleration

    def waves(residual: Array, j: int, alpha: Array) -> tuple[float, ...]:
        kept = np.concatenate([np.arange(part.start, part.stop, factor) for part in parts])
        amplitude = _amplitude(split, filtered, lambda p: drive.states(filtered, p), j, alpha) * in_motion
        passed = np.abs(filtered.velocity) * in_motion * filtered.interval * factor
        return _wave_numbers(filtered["position"][kept], residual * amplitude[kept], passed)

    equations = Equations(
        split,
        driving,
        target,
        acceleration if drive.inertia is None else None,
        seen(split.fixed_rows(filtered)),
        moving,
        waves,
    )
    return equations, filtered


def derivative_fit(drive: Drive, recording: Recording, preparation: Preparation, plan: Plan) -> TorqueFit:
    """Fit :func:`derivative_equations` (IDIM-LS)."""
    equations, filtered = derivative_equations(drive, recording, preparation)
    return fit_equations(drive, filtered, equations, float(len(equations.target)), preparation.decimate, plan)


def _decimated(rows: Array, factor: int) -> Array:
    from scipy.signal import decimate

    return rows if factor == 1 else np.asarray(decimate(rows, factor, axis=1))


def _fit_width(
    drive: Drive,
    recording: Recording,
    quadrature: Quadrature,
    width: int,
    resting: NDArray[np.bool_],
    plan: Plan,
    start: Array | None = None,
) -> TorqueFit:
    bumps = TestFunctions(recording, width, resting)
    if bumps.count <= len(drive.parameters):
        raise _too_few(drive, recording, bumps.count)
    equations = weak_equations(drive, quadrature, bumps, recording)
    return fit_equations(drive, recording, equations, 2.0 * bumps.count / HOPS, bumps.width, plan, start)
