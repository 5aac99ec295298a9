"""Recursive weighted least squares with exponential forgetting, on the equation of motion in weak form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field

from estimators.newest_window import NewestWindow
from estimators.regression import Design, cubic
from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.estimator import EstimatorSettings, OnlineFilter, SequentialEstimator, Solution, usable
from fricmodels.filtering.covariance import symbolic_covariance, symbolic_pack, unpack
from fricmodels.filtering.online import checked_sample
from fricmodels.filtering.preparation import (
    dominant_frequency,
    inertia_guess,
    peak_speed,
    scanned_guess,
    velocity_noise,
)
from fricmodels.filtering.problem import HISTORY_ROWS
from fricmodels.filtering.stored_problem import SCHEMA, checked_state, drive_document, drive_of
from fricmodels.filtering.windowed import RESTING, WindowedRegression
from fricmodels.kernels import Scan
from fricmodels.recording import Recording, channel_of

_VAGUE = 1e6
"""Initial variance of the normalised parameters."""
_MOST = 10 * _VAGUE
"""Greatest variance with which anything is forgotten."""


def recursive_step(order: int, most: float = math.inf) -> Any:
    r"""Build one step of recursive least squares for :class:`fricmodels.kernels.Scan`.

    .. math::
        k = \frac{P a}{\lambda + a^T P a},\quad \theta \leftarrow \theta + k (z - a^T\theta),\quad
        P \leftarrow [(I - k a^T) P (I - k a^T)^T + \lambda k k^T]/\lambda

    which is (P − k aᵀP)/λ, written such that rounding leaves P positive definite (Joseph). Where a parameter is not
    excited for long, forgetting would let its variance grow without end (wind-up); while the greatest variance is above
    ``most``, nothing is forgotten.

    A row with ``use`` zero changes nothing. State: ``[θ; lower triangle of P]``. Input: ``[a…, z, use]``.
    Constant: ``[λ]``. Output: ``[θ; diagonal of P]``.
    """
    import casadi

    theta, a = casadi.SX.sym("theta", order), casadi.SX.sym("a", order)
    z, use, forgetting = (casadi.SX.sym(name) for name in ("z", "use", "forgetting"))
    triangle, covariance = symbolic_covariance(order)
    reach = casadi.mtimes(covariance, a)
    wound_up = casadi.mmax(casadi.diag(covariance)) > most
    kept = casadi.if_else(wound_up, 1, forgetting)
    gain = reach / (kept + casadi.dot(a, reach))
    estimate = theta + use * gain * (z - casadi.dot(a, theta))
    once = covariance - casadi.mtimes(gain, reach.T)
    shrunk = (once - casadi.mtimes(casadi.mtimes(once, a), gain.T) + kept * casadi.mtimes(gain, gain.T)) / kept
    posterior = covariance + use * (shrunk - covariance)
    state = casadi.vertcat(estimate, symbolic_pack(posterior))
    return casadi.Function(
        "recursive_least_squares",
        [casadi.vertcat(theta, triangle), casadi.vertcat(a, z, use), forgetting],
        [state, casadi.vertcat(estimate, casadi.diag(posterior))],
        {"cse": True},
    )


class RecursiveLeastSquaresSettings(EstimatorSettings):
    """Settings."""

    memory: float = Field(20.0, gt=0, description="cycles after which a sample's weight has fallen to 1/e")
    window: int | None = Field(
        None, ge=5, description="samples in the weak form's window; by the noise where not given"
    )
    smoothing: int | None = Field(
        None, ge=1, description="samples of the local cubic that smooths the velocity; by its noise where not given"
    )


@dataclass(frozen=True)
class _Problem:
    drive: Drive
    design: Design
    scan: Scan
    forgetting: float

    @property
    def order(self) -> int:
        return len(self.design.keys)

    def initial_memory(self) -> Array:
        triangle = _VAGUE * np.eye(self.order)[np.tril_indices(self.order)]
        return np.concatenate([np.zeros(self.order), triangle])

    def named(self, memory: Array) -> dict[str, float]:
        found = dict(zip(self.design.keys, (memory[: self.order] * self.design.size).tolist(), strict=True))
        values = {**self.design.fixed, **found}
        return {self.drive.inertia_key: values.pop(self.drive.inertia_key), **values}


class RecursiveLeastSquares(SequentialEstimator):
    """Recursive weighted least squares with exponential forgetting (Canudas de Wit and Carrillo 1988).

    The torque equation is multiplied by a test function over the last samples and integrated, so that no measured
    velocity is differentiated. Windows that contain standstill are left out. Only linear parameters are estimated;
    nonlinear ones are held at the best of their scan. Standard errors are by the distance to an unbiased fit,
    :mod:`fricmodels.interval`.
    """

    name = "rls"
    summary = "recursive weighted least squares with forgetting (Canudas de Wit and Carrillo 1988)"
    Settings = RecursiveLeastSquaresSettings

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        """Estimate over the recording; see the class.

        Raises:
            EstimationError: for a model with internal states, or a recording that never slides for a whole window.
        """
        import pandas as pd

        problem = self._problem(drive, recording)
        rows = np.concatenate([problem.design.windows(run) for run in recording.runs()])
        used = rows[:, -1] > 0
        if np.count_nonzero(used) < 2 * problem.order:
            windows = f"{np.count_nonzero(used)} windows; {2 * problem.order} are needed"
            raise EstimationError(f"recording '{recording.name}' slides for {windows}")
        memory, outputs, _ = problem.scan(problem.initial_memory(), rows, [problem.forgetting])
        n, size = problem.order, problem.design.size
        covariance = unpack(memory[n:], n)
        stride = -(-len(rows) // HISTORY_ROWS)
        frame = {"time": recording.time[::stride]}
        frame |= {key: outputs[::stride, i] * size[i] for i, key in enumerate(problem.design.keys)}
        held = sorted(set(problem.design.fixed) - {drive.inertia_key})
        return Solution(
            parameters=problem.named(memory),
            estimated=problem.design.keys,
            message=f"held at the best of their scan: {', '.join(held)}" if held else "",
            not_identified={
                key: "no window of the recording excites it"
                for i, key in enumerate(problem.design.keys)
                if covariance[i, i] > 1e-3 * _VAGUE
            },
            history=pd.DataFrame(frame),
        )

    def start(self, drive: Drive, recording: Recording) -> OnlineFilter:
        """Return the estimator before its first sample."""
        return _Online(self._problem(drive, usable(drive, recording)))

    def resume(self, state: Mapping[str, Any]) -> OnlineFilter:
        """Return an estimator that goes on where one was saved; the settings are the saved ones."""
        saved = checked_state(state, self.name)
        problem = saved["problem"]
        names = ("window", "smoothing", "peak", "torque", "omega")
        design = Design(
            drive=drive_of(problem),
            keys=tuple(problem["estimated"]),
            fixed=dict(problem["fixed"]),
            **{name: problem[name] for name in names},
        )
        step = Scan(recursive_step(len(design.keys), _MOST))
        return _Online(_Problem(design.drive, design, step, float(problem["forgetting"])), saved)

    def _problem(self, drive: Drive, recording: Recording) -> _Problem:
        if drive.model.states:
            raise EstimationError(
                f"'{drive.model.name}' has internal states, which rls cannot estimate; use ekf or detchmendy-sridhar"
            )
        fixed: dict[str, float] = {}
        if drive.model.nonlinear_parameters:
            guess = scanned_guess(drive, recording)
            fixed = {p.key: guess[p.key] for p in drive.model.nonlinear_parameters}
        if drive.inertia is not None:
            fixed[drive.inertia_key] = drive.inertia
        per_cycle = 2 * np.pi / dominant_frequency(recording) / recording.interval
        peak = peak_speed(recording)
        inertia = inertia_guess(drive, recording)
        design = Design(
            drive=drive,
            keys=tuple(key for key in drive.keys if key not in fixed),
            fixed=fixed,
            window=self.settings.window or _window(recording, inertia, per_cycle),
            smoothing=self.settings.smoothing or _smoothing(recording, peak * 2 * np.pi / per_cycle),
            peak=peak,
            torque=recording.rms_torque,
            omega=dominant_frequency(recording),
        )
        forgetting = float(np.exp(-1 / (self.settings.memory * per_cycle)))
        return _Problem(drive, design, Scan(recursive_step(len(design.keys), _MOST)), forgetting)


def _window(recording: Recording, inertia: float, per_cycle: float) -> int:
    """Return the samples of a test function with 5 % of the RMS torque by velocity noise; 12 to a tenth of a cycle.

    The test function (1 − s²)³ over L samples turns white noise σ of the velocity into 5.04 J σ / (Δt L^(3/2)) of
    torque.
    """
    torque = recording.rms_torque
    noise = 5.04 * inertia * velocity_noise(recording) / recording.interval
    return int(np.clip(np.ceil((noise / (0.05 * torque)) ** (2 / 3)), 12, max(12, per_cycle / 10)))


def _smoothing(recording: Recording, change: float) -> int:
    """Return the samples over which a reversal's instant is known to a quarter of a sample, at most 15.

    ``change`` is the change of the velocity from sample to sample at a reversal; more smoothing rounds the kink there.
    """
    return min(15, int(np.ceil((4 * velocity_noise(recording) / change) ** 2)))


class _Online(OnlineFilter):
    def __init__(self, problem: _Problem, state: Mapping[str, Any] | None = None) -> None:
        self._problem = problem
        self._memory = problem.initial_memory() if state is None else np.array(state["memory"], dtype=float)
        needs = sorted(channel_of(name) for name in problem.drive.model.needs - {"acceleration"})
        self._channels = tuple(dict.fromkeys(["time", "torque", "velocity", "load_torque", *needs]))
        self._window = NewestWindow(problem.design, self._channels)
        self._forgetting = np.array([problem.forgetting])
        self._output = np.empty((1, problem.scan.n_outputs))
        for sample in () if state is None else state["samples"]:
            self._window.take(sample)

    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take one sample and return the parameters; refuses what is missing, not finite or out of order."""
        samples = self._window.samples
        present = checked_sample(sample, self._channels, samples[-1] if samples else None, "estimator")
        if samples and samples[-1]["run"] != present["run"]:
            self._window.clear()
        row = self._window.take(present)
        if row is not None:
            self._memory, _, _ = self._problem.scan(self._memory, row, self._forgetting, outputs=self._output)
        return self.parameters

    @property
    def windowed(self) -> WindowedRegression:
        """What it computes with, as plain numbers, before the first sample."""
        design = self._problem.design
        value, slope = cubic(design.smoothing)
        return WindowedRegression(
            drive=design.drive,
            keys=design.keys,
            fixed=design.fixed,
            window=design.window,
            value=value,
            slope=slope,
            resting=RESTING * design.peak,
            torque=design.torque,
            size=design.size,
            step=self._problem.scan.function,
            forgetting=self._problem.forgetting,
            memory=self._problem.initial_memory(),
        )

    @property
    def state(self) -> dict[str, Any]:
        """All that it knows and remembers, as plain data."""
        design = self._problem.design
        return {
            "schema": SCHEMA,
            "estimator": RecursiveLeastSquares.name,
            "problem": {
                **drive_document(design.drive),
                "estimated": list(design.keys),
                "fixed": dict(design.fixed),
                "window": design.window,
                "smoothing": design.smoothing,
                "peak": float(design.peak),
                "torque": float(design.torque),
                "omega": float(design.omega),
                "forgetting": self._problem.forgetting,
            },
            "memory": self._memory.tolist(),
            "samples": [dict(sample) for sample in self._window.samples],
        }

    @property
    def parameters(self) -> dict[str, float]:
        return self._problem.named(self._memory)

    @property
    def covariance(self) -> Array:
        n, size = self._problem.order, self._problem.design.size
        return np.asarray(unpack(self._memory[n:], n) * np.outer(size, size))
