"""The paper's sequential least-squares filter (Detchmendy and Sridhar 1966)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from pydantic import Field

from fricmodels.arrays import Array
from fricmodels.dimension import INERTIA, Scales
from fricmodels.drive import Drive
from fricmodels.estimator import EstimatorSettings, OnlineFilter, SequentialEstimator, Solution, usable
from fricmodels.filtering import FilterProblem, ProblemOnline, transition
from fricmodels.filtering.bounds import bounded, normalised_bounds
from fricmodels.filtering.covariance import symbolic_covariance, symbolic_pack, symbolic_prediction
from fricmodels.filtering.normalisation import NormalisedSpace, normalised_space
from fricmodels.filtering.preparation import REST_WIDTH, paper_scales, peak_speed, scanned_guess
from fricmodels.filtering.problem import diverged, initial_states, unidentified
from fricmodels.filtering.stored_problem import checked_state, problem_of
from fricmodels.filtering.substeps import stable_substeps
from fricmodels.kernels import Scan
from fricmodels.recording import Recording
from fricmodels.simulation import Between


def detchmendy_sridhar_step(space: NormalisedSpace, drive: Drive) -> Any:
    r"""Build one step of eqs. 12–14 as a CasADi function for :class:`fricmodels.kernels.Scan`.

    .. math::
        d\hat x/dr = g(\hat x, r) + 2PHQ[y - h(\hat x)], \qquad
        dP/dr = \tfrac{\partial g}{\partial x}P + P\tfrac{\partial g}{\partial x}^T + 2PMP + W, \qquad
        M = \tfrac{\partial}{\partial x}\{HQ(y - h(\hat x))\}

    M contains the second derivative of a nonlinear h. The step splits the two parts of the right-hand sides: the
    motion first (:mod:`fricmodels.filtering.transition`; P ← F P Fᵀ + W Δr), then the observation, whose equation
    dP/dr = 2PMP has the exact solution P ← P + 2Δr P M (I − 2Δr P M)⁻¹ P. For linear h this never overflows, however
    large P is, where explicit integration does; it tends to eqs. 12–14 as Δr → 0. Only the lower triangle of P is
    stored, so that it stays symmetric.

    State: ``[x; lower triangle of P]``. Input: ``[Δr, weight, y, u…]``, the weight being the time since the last
    observation, or zero for none. Constants: ``[known…, Q, diagonal of W…, lower bounds…, upper bounds…]``.
    Output: ``[x; diagonal of P; innovation; 2/(Q Δr) + Hᵀ P H]``.
    """
    import casadi

    step = transition(space)
    x, n, moving = space.x, space.x.numel(), space.moving
    triangle, covariance = symbolic_covariance(n)
    weight, y, q = (casadi.SX.sym(name) for name in ("weight", "y", "Q"))
    w = casadi.SX.sym("W", n)
    lower, upper = casadi.SX.sym("lower", n - moving), casadi.SX.sym("upper", n - moving)

    predicted = symbolic_prediction(step.jacobian, covariance, w * step.duration)
    observation = casadi.Function("observation", [x, space.u], [space.output])
    slope = casadi.gradient(space.output, x)
    correction = casadi.Function("correction", [x, space.u, y, q], [slope * q * (y - space.output)])
    bracket = casadi.Function("bracket", [x, space.u, y, q], [casadi.jacobian(slope * q * (y - space.output), x)])

    prior = step.following
    curvature = casadi.sparsify(bracket(prior, space.u, y, q))
    seen = sorted({*curvature.sparsity().get_triplet()[0], *curvature.sparsity().get_triplet()[1]})
    small = curvature[seen, seen]
    gain = predicted[:, seen]
    shrink = casadi.inv(casadi.SX.eye(len(seen)) - 2 * weight * casadi.mtimes(small, predicted[seen, seen]))
    posterior = predicted + casadi.mtimes(casadi.mtimes(gain, 2 * weight * casadi.mtimes(shrink, small)), gain.T)
    estimate = prior + casadi.mtimes(posterior, 2 * weight * correction(prior, space.u, y, q))
    estimate = bounded(estimate, posterior, lower, upper, drive)

    innovation = y - observation(prior, space.u)
    seen_slope = casadi.substitute(slope, x, prior)
    spread = casadi.mtimes([seen_slope.T, predicted, seen_slope]) + 1 / (2 * q * casadi.fmax(weight, 1e-300))
    return casadi.Function(
        "detchmendy_sridhar",
        [
            casadi.vertcat(x, triangle),
            casadi.vertcat(step.duration, weight, y, space.u),
            casadi.vertcat(space.known, q, w, lower, upper),
        ],
        [
            casadi.vertcat(estimate, symbolic_pack(posterior)),
            casadi.vertcat(estimate, casadi.diag(posterior), innovation, spread),
        ],
        {"cse": True},
    )


class DetchmendySridharSettings(EstimatorSettings):
    """Settings; the defaults are the paper's, in its normalised units."""

    weight_of_observations: float = Field(1.0, gt=0, description="Q of eq. 12")
    weight_of_model: float = Field(1.0, ge=0, description="factor of the unit matrix in eq. 14")
    initial_variance: float = Field(4.0, gt=0, description="diagonal of P(0)")
    initial_covariance: float = Field(1.0, description="elements of P(0) off the diagonal")
    initial_inertia_variance: float = Field(0.04, gt=0, description="element of P(0) of an inertia that is estimated")
    scan: Literal["effects", "all", "none"] = Field(
        "effects", description="whose nonlinear parameters start from their scan; the others start as declared, at 0"
    )
    average: float = Field(0.5, ge=0, lt=1, description="last part of the record over which estimates are averaged")
    substeps: int | None = Field(None, ge=1, description="steps between samples; by stability where not given")
    torque: Between = Field("linear", description="motor torque between samples: linear, or held")
    bounds: bool = Field(True, description="keep parameters within their physical bounds")


class DetchmendySridhar(SequentialEstimator):
    """Sequential least-squares filter of the paper, eqs. 12–14.

    The recording is normalised as in eq. 6 and the estimate converted back. Eq. 14 adds the unit matrix to dP/dr, so
    the gain never dies and the filter keeps following; the estimate that it is asked for at the end is the mean of
    its history over the last whole cycles (``average``). P is no covariance of the estimate, since Q = W = 1 are not
    noise intensities, and cannot know what is left to converge: standard errors are by the distance to an unbiased
    fit, :mod:`fricmodels.interval`.
    """

    name = "detchmendy-sridhar"
    summary = "sequential least-squares filter of Detchmendy and Sridhar (1966), the paper's method"
    Settings = DetchmendySridharSettings
    carries_states = True

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        """Filter the recording; see the class.

        The estimate is the mean over the last whole cycles, one being the period of the normalisation, 2π of
        normalised time; with less than one in the share that is to be averaged, the final value.
        """
        problem = self._problem(drive, recording)
        trajectory = problem.run(recording)
        if trajectory.diverged_at is not None:
            return diverged(problem, trajectory)
        elapsed = _elapsed(recording) / problem.scales.time / (2 * np.pi)
        cycles = int(np.floor(elapsed[-1] * self.settings.average + 1e-6))
        last = elapsed > elapsed[-1] - cycles + 1e-6 if cycles else elapsed >= elapsed[-1]
        estimate = problem.parameters(trajectory.states[last].mean(axis=0))
        walked = self.settings.weight_of_model * float(elapsed[-1]) * 2 * np.pi
        return Solution(
            parameters=problem.named(estimate),
            not_identified=unidentified(problem, trajectory, walked),
            history=problem.history(trajectory),
        )

    def start(self, drive: Drive, recording: Recording) -> OnlineFilter:
        """Return the filter before its first sample."""
        return ProblemOnline(self._problem(drive, usable(drive, recording)), self.name)

    def resume(self, state: Mapping[str, Any]) -> OnlineFilter:
        """Return a filter that goes on where one was saved; the settings are the saved ones."""
        saved = checked_state(state, self.name)
        return ProblemOnline(problem_of(saved["problem"], detchmendy_sridhar_step), self.name, saved)

    def _problem(self, drive: Drive, recording: Recording) -> FilterProblem:
        settings = self.settings
        scales = paper_scales(drive, recording)
        space = normalised_space(drive)
        covariance = np.full((space.x.numel(),) * 2, settings.initial_covariance)
        np.fill_diagonal(covariance, settings.initial_variance)
        moving = space.moving
        parameters = start_values(drive, recording, scales, settings.scan)
        if drive.inertia is None:
            covariance[moving, :] = covariance[:, moving] = 0.0
            covariance[moving, moving] = settings.initial_inertia_variance
        lower, upper = normalised_bounds(drive, scales)
        if not settings.bounds:
            lower, upper = np.full_like(lower, -1e300), np.full_like(upper, 1e300)
        known = space.values(drive, scales, REST_WIDTH * peak_speed(recording))
        return FilterProblem(
            drive=drive,
            scales=scales,
            space=space,
            scan=Scan(detchmendy_sridhar_step(space, drive)),
            known=known,
            measurement=settings.weight_of_observations,
            walk=np.full(space.x.numel(), settings.weight_of_model),
            lower=lower,
            upper=upper,
            initial_states=initial_states(drive, scales),
            initial_parameters=parameters,
            initial_covariance=covariance,
            substeps=settings.substeps or stable_substeps(drive, recording, scales),
            hold=settings.torque,
        )


def _elapsed(recording: Recording) -> Array:
    """Return the time spent within runs up to each sample [s]."""
    steps = np.where(np.diff(recording.run) == 0, np.diff(recording.time), 0.0)
    return np.concatenate([[0.0], np.cumsum(steps)])


def start_values(drive: Drive, recording: Recording, scales: Scales, scan: str) -> Array:
    """Return normalised start values: declared ones, an inertia of 1, chosen nonlinear ones from their scan."""
    values = {p.key: p.declared.initial for p in drive.parameters}
    own = len(drive.model.law.parameters)
    law = {p.key for p in drive.model.parameters[:own]}
    nonlinear = {p.key for p in drive.parameters if not p.linear} - (law if scan == "effects" else set())
    if nonlinear and scan != "none":
        guess = scanned_guess(drive, recording)
        values |= {key: guess[key] for key in nonlinear}
    if drive.inertia is None:
        values[drive.inertia_key] = scales.of(INERTIA)
    return np.array([values[key] for key in drive.keys]) / drive.parameter_scales(scales)
