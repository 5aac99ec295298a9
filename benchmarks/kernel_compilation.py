"""How long recursions take to compile, from the smallest to the largest, and how long a row takes then.

    python benchmarks/kernel_compilation.py

Each is compiled into an empty cache, after a first one that pays for loading the compiler.
"""

from __future__ import annotations

import os
import tempfile
import time
from typing import Any

import numpy as np

from filter_speed import problem, seconds

ROWS = 20_000


def steps() -> dict[str, Any]:
    """Return steps of several sizes, made as the commands make them."""
    from fricmodels.drive import Drive
    from fricmodels.memory import memory_step
    from fricmodels.model import Model
    from fricmodels.stick_slip import phase_of_step

    small, large = "coulomb-viscous", "asymmetric-exponential-stick-slip+backlash+presliding"
    return {
        "memory of presliding": memory_step(Model.parse(f"{small}+presliding")),
        "motion of a drive with one law": phase_of_step(Drive(Model.parse(small), 1.0)),
        "Detchmendy–Sridhar filter, nine states": problem("ds", 21)[0].scan.function,
        "motion of a drive with two effects": phase_of_step(Drive(Model.parse(large), 1.0)),
    }


def main() -> None:
    """Print the table."""
    import casadi

    from fricmodels.kernels import Scan

    one = [casadi.SX.sym(name) for name in "xuc"]
    Scan(casadi.Function("one", one, one[:2]))([0.0], np.zeros(1), [0.0])
    print(f"{'recursion':42} {'operations':>10} {'compiling ms':>13} {'a row ns':>9}")
    for name, step in steps().items():
        scan = Scan(step)
        rng = np.random.default_rng(0)
        rows = rng.uniform(0.5, 1.0, (ROWS, scan.n_inputs)) * np.sign(np.sin(np.arange(ROWS) / 300.0))[:, None]
        rows[:, 0] = 1e-3
        state, constants = np.full(scan.n_states, 0.01), rng.uniform(0.1, 1.0, scan.n_constants)
        began = time.perf_counter()
        scan(state, rows[:0], constants)
        compiling = time.perf_counter() - began
        _, _, done = scan(state, rows, constants)
        row = seconds(lambda: scan(state, rows[:done], constants, stride=1000), 50) / done  # noqa: B023
        print(f"{name:42} {step.n_instructions():10d} {1e3 * compiling:13.0f} {1e9 * row:9.1f}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as cache:
        os.environ["FRICMODELS_CACHE"] = cache
        main()
