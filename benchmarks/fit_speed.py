"""Speed of a torque-error fit with standard errors: 20 000 samples, exponential law and inertia, 5 parameters.

Peers in one run: lmfit, SciPy's ``least_squares`` with an analytic Jacobian, CasADi with IPOPT. They are given the
true acceleration and a start at twice the truth; ours finds its start and its derivative itself and gives standard
errors that hold for autocorrelated residuals. *Fit alone* is the part that the peers do; *automatic* also chooses the
test functions and explains the velocity by the fit. *One solve* is one descent from a start at twice the truth on rows
that are laid out, with standard errors: what a peer's whole time is spent on. A fit makes three of them, an automatic
one five: for rows before and after the friction is known, at other velocities, and for a torque that goes on or is
shifted.

Noise and rests are told once for each recording: a *new* one in every fit has all of that in it, a *known* one was
fitted before, as in a tournament or a comparison. *Cold* is the first fit of a fresh process with its imports, *warm*
the median of repeated ones, *least* the least of them, which other processes disturb less. Run: ``python
benchmarks/fit_speed.py``.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fricmodels.recording import Recording

TRUE = {"J": 4.87e-6, "K_v": 1.0e-4, "K_c": 1.2e-2, "C": 8.0e-3, "B": 0.3}
SAMPLES = 20_000


def data() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Simulate the drive under a multisine by many small Euler steps; return time, torque, velocity, acceleration."""
    rng = np.random.default_rng(1)
    time_s = 5e-4 * np.arange(SAMPLES)
    frequencies = np.array([1.1, 2.7, 4.3, 7.9])
    phases = 2 * np.pi * np.outer(frequencies, time_s) + rng.uniform(0, 6, (4, 1))
    torque = 0.012 * np.sin(phases).sum(axis=0)
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.simulation import simulate

    drive = Drive(Model.parse("exponential-stick-slip"), TRUE["J"])
    velocity = simulate(drive, TRUE, time_s, torque, substeps=4).velocity
    speed = np.abs(velocity)
    coulomb = TRUE["C"] + (TRUE["K_c"] - TRUE["C"]) * np.exp(-TRUE["B"] * speed)
    friction = (TRUE["K_v"] * speed + coulomb) * np.sign(velocity)
    acceleration = np.where(velocity == 0.0, 0.0, (torque - friction) / TRUE["J"])
    return time_s, torque + 1e-4 * rng.standard_normal(SAMPLES), velocity, acceleration


def _recorded() -> Recording:
    """Return the drive's recording."""
    from fricmodels.dimension import Motion
    from fricmodels.recording import Recording

    time_s, torque, velocity, _ = data()
    channels = {"time": time_s, "torque": torque, "velocity": velocity}
    return Recording("benchmark", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


def _ours(settings: dict[str, object], *, known: bool) -> Callable[[], dict[str, float]]:
    from estimators.batch import Batch
    from fricmodels.drive import Drive
    from fricmodels.model import Model

    same = _recorded()
    drive = Drive(Model.parse("exponential-stick-slip"))
    estimator = Batch(settings)

    def anew() -> Recording:
        channels = {name: values.copy() for name, values in same.channels.items()}
        return replace(same, channels=channels)

    return lambda: {**estimator.fit(drive, same if known else anew()).parameters}


def _one_solve() -> Callable[[], dict[str, float]]:
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.weakform.nonlinear import Plan
    from fricmodels.weakform.problem import WeakFormProblem
    from fricmodels.weakform.solve import solve

    problem = WeakFormProblem.of(Drive(Model.parse("exponential-stick-slip")), _recorded(), TRUE, 32)

    def fit() -> dict[str, float]:
        found = solve(replace(problem), Plan(start={"B": 2.0 * TRUE["B"]}), timing=False)
        assert found.standard_errors
        return found.parameters

    return fit


ALONE: dict[str, object] = {"width": 32, "velocity": "measured"}


def _sliding() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    _, torque, velocity, acceleration = data()
    moving = velocity != 0.0
    return torque[moving], velocity[moving], acceleration[moving], np.array([2.0 * value for value in TRUE.values()])


def scipy_peer() -> Callable[[], dict[str, float]]:
    from scipy.optimize import least_squares

    torque, velocity, acceleration, start = _sliding()
    speed, sign = np.abs(velocity), np.sign(velocity)

    def residual(x: np.ndarray) -> np.ndarray:
        return x[0] * acceleration + x[1] * velocity + (x[3] + (x[2] - x[3]) * np.exp(-x[4] * speed)) * sign - torque

    def jacobian(x: np.ndarray) -> np.ndarray:
        fall = np.exp(-x[4] * speed)
        columns = [acceleration, velocity, fall * sign, (1 - fall) * sign, -(x[2] - x[3]) * speed * fall * sign]
        return np.column_stack(columns)

    def fit() -> dict[str, float]:
        solution = least_squares(residual, start, jac=jacobian, x_scale=np.abs(start), method="trf", bounds=(0, np.inf))
        np.linalg.inv(solution.jac.T @ solution.jac)
        return dict(zip(TRUE, solution.x.tolist(), strict=True))

    return fit


def lmfit_peer() -> Callable[[], dict[str, float]]:
    import lmfit

    torque, velocity, acceleration, start = _sliding()
    speed, sign = np.abs(velocity), np.sign(velocity)
    parameters = lmfit.Parameters()
    for key, value in zip(TRUE, start, strict=True):
        parameters.add(key, value=value, min=0.0)

    def residual(p: lmfit.Parameters) -> np.ndarray:
        v = p.valuesdict()
        fall = np.exp(-v["B"] * speed)
        return v["J"] * acceleration + v["K_v"] * velocity + (v["C"] + (v["K_c"] - v["C"]) * fall) * sign - torque

    return lambda: dict(lmfit.minimize(residual, parameters).params.valuesdict())


def ipopt_peer() -> Callable[[], dict[str, float]]:
    import casadi

    torque, velocity, acceleration, start = _sliding()
    x = casadi.MX.sym("x", 5)
    p = x * casadi.DM(start)
    speed, sign = casadi.DM(np.abs(velocity)), casadi.DM(np.sign(velocity))
    friction = p[1] * casadi.DM(velocity) + (p[3] + (p[2] - p[3]) * casadi.exp(-p[4] * speed)) * sign
    residual = (p[0] * casadi.DM(acceleration) + friction - casadi.DM(torque)) / float(np.std(torque))
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes"}}
    solver = casadi.nlpsol("fit", "ipopt", {"x": x, "f": casadi.sumsqr(residual)}, options)
    slope = casadi.Function("slope", [x], [casadi.jacobian(residual, x)])

    def fit() -> dict[str, float]:
        solution = solver(x0=np.ones(5), lbx=0.0)
        jacobian = np.asarray(slope(solution["x"]))
        np.linalg.inv(jacobian.T @ jacobian)
        return dict(zip(TRUE, (np.asarray(solution["x"]).ravel() * start).tolist(), strict=True))

    return fit


PEERS: dict[str, Callable[[], Callable[[], dict[str, float]]]] = {
    "one solve": _one_solve,
    "fit alone, known recording": lambda: _ours(ALONE, known=True),
    "fit alone, new recording": lambda: _ours(ALONE, known=False),
    "automatic, known recording": lambda: _ours({}, known=True),
    "automatic, new recording": lambda: _ours({}, known=False),
    "lmfit": lmfit_peer,
    "SciPy, analytic Jacobian": scipy_peer,
    "CasADi/IPOPT": ipopt_peer,
}


def measure(name: str) -> dict[str, object]:
    """Time one peer in this process."""
    started = time.perf_counter()
    fit = PEERS[name]()
    found = fit()
    cold = time.perf_counter() - started
    seconds, processor = [], []
    for _ in range(25):
        started, busy = time.perf_counter(), time.process_time()
        found = fit()
        seconds.append(time.perf_counter() - started)
        processor.append(time.process_time() - busy)
    worst = max(abs(found[key] / value - 1.0) for key, value in TRUE.items())
    return {
        "cold_s": cold,
        "warm_ms": 1e3 * statistics.median(seconds),
        "processor_ms": 1e3 * statistics.median(processor),
        "least_ms": 1e3 * min(processor),
        "worst_percent": 100 * worst,
    }


def main() -> None:
    """Print the table; each peer runs in a process of its own."""
    print(f"{'':28}{'cold s':>10}{'warm ms':>10}{'CPU ms':>10}{'least ms':>10}{'worst parameter error %':>26}")
    for name in PEERS:
        output = subprocess.run([sys.executable, __file__, name], capture_output=True, text=True, check=False)
        if output.returncode:
            print(f"{name:28}  failed: {output.stderr.strip().splitlines()[-1]}")
            continue
        row = json.loads(output.stdout.splitlines()[-1])
        print(
            f"{name:28}{row['cold_s']:10.2f}{row['warm_ms']:10.1f}{row['processor_ms']:10.1f}{row['least_ms']:10.1f}"
            f"{row['worst_percent']:26.2f}"
        )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(measure(sys.argv[1])))
    else:
        main()
