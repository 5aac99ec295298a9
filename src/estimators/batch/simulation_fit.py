r"""Fits the simulated velocity of a drive to the measured one, as a sparse optimal-control problem.

The velocity (and every internal state) at every sample is an unknown beside the parameters; the equation of motion
ties them together by the implicit midpoint rule

.. math:: J\,(\omega_{k+1} - \omega_k) = h\,[\tau_m - \tau_L - \tau_F]\big((x_k + x_{k+1})/2\big).

Started from the measured velocity it does not have to find its way through sticking, where a simulation that starts
from wrong parameters loses its derivative. The sign function is a hyperbolic tangent that is made steeper step by
step. Where the drive turns, stops or starts, friction jumps within a sampling interval: there the interval is divided.
At rest the rule is evaluated at the end of the step (implicit Euler), which damps the ringing of the midpoint rule.
Solved by IPOPT. Source of the method: J. T. Betts, Practical Methods for Optimal Control, ch. 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Index, Mask, rms
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals import resting
from fricmodels.signals.segments import joined
from fricmodels.weakform.inference import covariance
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.nonlinear import Outcome, linear_constraints
from fricmodels.weakform.predicted_velocity import model_velocity
from fricmodels.weakform.ranges import natural_size

WIDTHS = (3e-2, 1e-2, 3e-3, 1e-3)
"""Widths of the smooth sign, in peak velocities."""
DIVISIONS = 16
"""Steps into which a sampling interval is divided around a standstill."""
PIECES = 8
"""A record that is too long is represented by so many pieces, spread evenly."""


@dataclass(frozen=True)
class SimulationFit:
    """A simulation-error fit.

    Attributes:
        outcome: the parameters.
        samples: how many were used.
        velocity_error: root mean square of measured less simulated velocity [SI].
    """

    outcome: Outcome
    samples: int
    velocity_error: float


def excerpt(recording: Recording, samples: int) -> tuple[Recording, str]:
    """Return the recording, or evenly spread pieces of one that is too long, each as a run; and what was done."""
    if len(recording) <= samples:
        return recording, ""
    length = samples // PIECES
    starts = np.linspace(0, len(recording) - length, PIECES).round().astype(int)
    pieces = np.concatenate([np.arange(start, start + length) for start in starts])
    chosen = recording.select(pieces)
    border = np.repeat(np.arange(PIECES), length) * (int(recording.run.max()) + 1)
    parted = Recording(
        chosen.name, chosen.motion, chosen.channels, chosen.run + border, chosen.derived, chosen.provenance
    )
    return parted, f"fitted to {PIECES} pieces of {length} samples spread over {len(recording)}"


@lru_cache(maxsize=64)
def _step(model: Model, estimates_inertia: bool) -> Any:
    """Return the defect of a step as a CasADi function; friction is evaluated at the share ``lean`` of the step."""
    import casadi

    e = model.expression(smooth=True)
    count = 1 + e.states.numel()
    now, following = casadi.SX.sym("now", count), casadi.SX.sym("following", count)
    step, inertia, lean = casadi.SX.sym("step"), casadi.SX.sym("inertia"), casadi.SX.sym("lean")
    middle = now + lean * (following - now)
    acceleration = (following[0] - now[0]) / step
    old = [e.signals["velocity"], e.states, e.signals["acceleration"]]
    new = [middle[0], middle[1:, 0], acceleration]
    torque, rates = casadi.substitute([e.torque, e.rates], old, new)
    push = e.signals["motor_torque"] - e.signals["load_torque"]
    defect = casadi.vertcat(inertia * acceleration + torque - push, (following[1:, 0] - now[1:, 0]) / step - rates)
    signals = casadi.vertcat(*(e.signals[name] for name in model.signals))
    parameters = casadi.vertcat(inertia, e.parameters) if estimates_inertia else e.parameters
    fixed = casadi.SX(0, 1) if estimates_inertia else inertia
    return casadi.Function("step", [now, following, parameters, fixed, e.width, step, lean, signals], [defect])


@dataclass(frozen=True)
class Mesh:
    """Where the unknown states are: at the samples, and between them around each standstill.

    Attributes:
        time: of each node.
        sample: index of the node of each sample.
        first: index of the node at which each step begins.
        place: position of each node among the samples, to interpolate at.
        lean: share of each step at which friction is evaluated.
    """

    time: Array
    sample: Index
    first: Index
    place: Array
    lean: Array

    @classmethod
    def of(cls, recording: Recording, velocity: Array, resting: Mask) -> Mesh:
        """Divide the intervals in which the velocity passes zero, stops or starts, and their neighbours."""
        direction = np.where(resting, 0.0, np.sign(velocity))
        within = joined(recording.time, recording.run)
        changing = (direction[:-1] != direction[1:]) & within
        near = np.convolve(changing, np.ones(3), mode="same") > 0.0
        divisions = np.where(near & within, DIVISIONS, 1)
        place = np.concatenate([[0.0], *(k + np.arange(1, d + 1) / d for k, d in enumerate(divisions))])
        sample = np.concatenate([[0], np.cumsum(divisions)])
        owner = np.repeat(np.arange(len(divisions)), divisions)
        first = np.flatnonzero(within[owner])
        still = resting[:-1] | resting[1:]
        lean = np.where(still[owner[first]], 1.0, 0.5)
        return cls(np.interp(place, np.arange(len(recording)), recording.time), sample, first, place, lean)

    def at_nodes(self, samples: Array) -> Array:
        """Interpolate a channel to the nodes."""
        return np.interp(self.place, np.arange(len(self.sample)), samples)

    @property
    def beginnings(self) -> Index:
        """Nodes that no step leads to."""
        return np.setdiff1d(np.arange(len(self.time)), self.first + 1)


class Transcription:
    """The problem in scaled unknowns: states at all samples, then parameters.

    Args:
        drive: the model and what is known of it.
        recording: measured velocity and the signals of the model.
        mesh: where the unknowns are.
        states: first guess of velocity and internal states at the nodes, shape (1 + states, nodes).
        sizes: size of each parameter [SI], by which it is scaled.
    """

    def __init__(self, drive: Drive, recording: Recording, mesh: Mesh, states: Array, sizes: Array) -> None:
        import casadi

        self._recording, self._mesh, self._sizes = recording, mesh, sizes
        count, n = states.shape
        first = mesh.first
        self._scale = np.array([max(float(np.max(np.abs(row))), 1e-12) for row in states])
        force = recording.rms_torque
        step = mesh.time[first + 1] - mesh.time[first]
        rates = self._scale[1:] / recording.interval
        needed = drive.model.needs | {"motor_torque", "load_torque"}
        signals = np.array(
            [mesh.at_nodes(recording.signal(name)) if name in needed else np.zeros(n) for name in drive.model.signals]
        )
        middle = signals[:, first] + mesh.lean * (signals[:, first + 1] - signals[:, first])
        unknown = casadi.MX.sym("states", count, n)
        theta = casadi.MX.sym("parameters", len(sizes))
        width = casadi.MX.sym("width")
        scaled = casadi.DM(self._scale)
        x = casadi.repmat(scaled, 1, n) * unknown
        known = casadi.DM(0, 1) if drive.inertia is None else casadi.DM(drive.inertia)
        mapped = _step(drive.model, drive.inertia is None).map(len(first))
        defects = mapped(
            x[:, first.tolist()],
            x[:, (first + 1).tolist()],
            casadi.repmat(casadi.DM(sizes) * theta, 1, len(first)),
            casadi.repmat(known, 1, len(first)),
            casadi.repmat(width, 1, len(first)),
            casadi.DM(step).T,
            casadi.DM(mesh.lean).T,
            casadi.DM(middle),
        )
        defects = casadi.vec(defects / casadi.repmat(casadi.DM([force, *rates]), 1, len(first)))
        constraints, limits = linear_constraints(drive.parameters)
        ordered = [i for i, row in enumerate(constraints) if np.count_nonzero(row) > 1]
        bound = constraints[ordered] * sizes
        self._observed = recording.velocity / self._scale[0]
        residual = unknown[0, mesh.sample.tolist()].T - casadi.DM(self._observed)
        unknowns = casadi.vertcat(casadi.vec(unknown), theta)
        self._count, self._n, self._defects = count, n, defects.numel()
        self._derivative = casadi.Function("derivative", [unknowns, width], [casadi.jacobian(defects, unknowns)])
        self._problem: dict[str, Any] = {
            "x": unknowns,
            "p": width,
            "f": 0.5 * casadi.sumsqr(residual),
            "g": casadi.vertcat(defects, casadi.DM(bound) @ theta) if ordered else defects,
        }
        lower = np.array([p.declared.lower for p in drive.parameters]) / sizes
        upper = np.array([p.declared.upper for p in drive.parameters]) / sizes
        free = np.full(count * n, np.inf)
        self._bounds = {
            "lbx": np.concatenate([-free, lower]),
            "ubx": np.concatenate([free, upper]),
            "lbg": np.concatenate([np.zeros(self._defects), limits[ordered]]),
            "ubg": np.concatenate([np.zeros(self._defects), np.full(len(ordered), np.inf)]),
        }
        self._start = states / self._scale[:, None]

    def solve(self, values: Array, max_seconds: float) -> tuple[Array, Array, float, bool, str]:
        """Return unknowns, parameters [SI], the last width, whether IPOPT succeeded, and its word."""
        import casadi

        peak = float(np.max(np.abs(self._recording.velocity)))
        options: dict[str, Any] = {
            "print_time": False,
            "error_on_fail": False,
            "ipopt": {
                "print_level": 0,
                "sb": "yes",
                "max_iter": 500,
                "max_wall_time": max_seconds,
                "tol": 1e-7,
                "acceptable_tol": 1e-5,
                "mu_strategy": "adaptive",
            },
        }
        solver = casadi.nlpsol("simulation_fit", "ipopt", self._problem, options)
        at = np.concatenate([self._start.ravel(order="F"), values / self._sizes])
        at = np.clip(at, self._bounds["lbx"], self._bounds["ubx"])
        width, reason, succeeded = WIDTHS[0] * peak, "", False
        for relative in WIDTHS:
            solution = solver(x0=at, p=relative * peak, **self._bounds)
            statistics = solver.stats()
            reason = str(statistics["return_status"])
            succeeded = bool(statistics["success"])
            found = np.asarray(solution["x"]).ravel()
            if not np.all(np.isfinite(found)) or not succeeded:
                break
            at, width = found, relative * peak
        return at, at[self._count * self._n :] * self._sizes, width, succeeded, reason

    def sensitivities(self, unknowns: Array, width: float) -> tuple[Array, Array]:
        """Return the derivative of the simulated velocity by the parameters, first states eliminated, and residual.

        From the implicit function theorem on the defects; each stretch's first state is a parameter of its own.
        """
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import splu

        derivative = self._derivative(unknowns, width).sparse().tocsc()
        states = self._count * self._n
        firsts = (self._mesh.beginnings[:, None] * self._count + np.arange(self._count)).ravel()
        later = np.setdiff1d(np.arange(states), firsts)
        given = np.concatenate([firsts, np.arange(states, derivative.shape[1])])
        change = -splu(csc_matrix(derivative[:, later])).solve(derivative[:, given].toarray())
        full = np.zeros((states, len(given)))
        full[later] = change
        full[firsts, np.arange(len(firsts))] = 1.0
        velocity = full[self._mesh.sample * self._count]
        nuisance, wanted = velocity[:, : len(firsts)], velocity[:, len(firsts) :]
        nuisance = nuisance[:, np.linalg.norm(nuisance, axis=0) > 0.0]
        wanted = wanted - nuisance @ np.linalg.lstsq(nuisance, wanted, rcond=None)[0]
        residual = self._observed - unknowns[self._mesh.sample * self._count]
        return wanted / self._sizes * self._scale[0], residual * self._scale[0]


def simulation_fit(
    drive: Drive, recording: Recording, values: Array, samples: int, max_seconds: float
) -> SimulationFit:
    """Fit the simulated velocity, starting from given parameters and the measured velocity."""
    chosen, message = excerpt(recording, samples)
    sizes = np.array([natural_size(chosen, p.dimension) for p in drive.parameters])
    sizes = np.where(values != 0.0, np.abs(values), sizes)
    predicted = model_velocity(drive, dict(zip(drive.keys, values, strict=True)), chosen)
    velocity, still = (
        (predicted.velocity, predicted.resting) if predicted is not None else (chosen.velocity, resting(chosen))
    )
    mesh = Mesh.of(chosen, velocity, still)
    memory = drive.states(chosen, values[len(values) - len(drive.model.parameters) :])
    start = np.array([mesh.at_nodes(row) for row in (velocity, *memory)])
    problem = Transcription(drive, chosen, mesh, start, sizes)
    unknowns, found, width, succeeded, reason = problem.solve(values, max_seconds)
    derivative, residual = problem.sensitivities(unknowns, width)
    normal = NormalEquations.of(derivative.T @ derivative, derivative.T @ residual)
    spread = covariance(derivative, residual, normal.inverse, float(len(residual)))
    note = message if succeeded else "; ".join(filter(None, [message, f"IPOPT: {reason}"]))
    outcome = Outcome(found, spread, normal.null, succeeded, note)
    return SimulationFit(outcome, len(chosen), rms(residual))
