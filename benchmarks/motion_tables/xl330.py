"""BAM XL330: the position of a servo on a pendulum, simulated through its firmware from the goal alone."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fricmodels_bam import LAWS
from fricmodels_bam.bench import LENGTH, MASS, Bench, read_logs
from fricmodels_bam.firmware import Firmware, SaggingSupply, recorded

from fricmodels import Recording
from fricmodels.drive import Drive
from fricmodels.loop import Loop
from fricmodels.model import Model
from fricmodels.motion import MotionFit, Simulator, fit_motion, motion_errors
from fricmodels.weakform.prepared import ready

SOURCE = {
    "kt": "loop.k_t", "R": "loop.R", "q_offset": "loop.q_offset", "friction_base": "K_c", "friction_viscous": "K_v",
    "friction_stribeck": "K_cs", "load_friction_base": "K_l", "load_friction_stribeck": "K_ls",
    "load_friction_motor": "K_m", "load_friction_external": "K_e", "load_friction_motor_stribeck": "K_ms",
    "load_friction_external_stribeck": "K_es", "load_friction_motor_quad": "K_mq",
    "load_friction_external_quad": "K_eq", "dtheta_stribeck": "omega_s", "alpha": "alpha",
}  # fmt: skip
"""Names of the published files."""
SIMPLER = {
    "bam-m2": ("bam-m1",), "bam-m3": ("bam-m1",), "bam-m4": ("bam-m3", "bam-m2"), "bam-m5": ("bam-m4",),
    "bam-m6": ("bam-m5",),
}  # fmt: skip
"""The laws that each one contains."""
NEUTRAL = {"K_cs": 0.0, "K_l": 0.0, "K_ls": 0.0, "K_mq": 0.0, "K_eq": 0.0, "omega_s": 1.0, "alpha": 1.5}
"""With these a law is the smaller one that it contains."""
RANGES = {
    "J": (5.5e-3, 9e-3), "K_v": (1e-3, 3e-2), "K_c": (1e-3, 3e-2), "K_cs": (1e-3, 3e-2), "omega_s": (0.05, 4.0),
    "alpha": (1.0, 4.0), "K_l": (0.02, 0.4), "K_ls": (0.02, 0.4), "K_m": (0.02, 0.4), "K_e": (0.02, 0.4),
    "K_ms": (0.02, 0.4), "K_es": (0.02, 0.4), "K_mq": (0.1, 5.0), "K_eq": (0.1, 5.0), "loop.k_t": (0.28, 0.45),
    "loop.R": (2.0, 5.0), "loop.q_offset": (0.005, 0.03), "loop.rho": (0.1, 1.5),
}  # fmt: skip
"""From which starts are drawn, evenly in logarithms; the peers search in them too."""
KEPT = "/200"
"""Logs of this gain take no part in fitting."""
_DRAWS, _BEST, _JACOBIANS = 100, 2, 10
_FEW = 8
"""Jacobians of a fit that begins from that of all gains."""
_PEER = 1000
"""Simulations of the peer, at least."""


def published(number: int, data: Path) -> dict[str, float]:
    """Return the maker's parameters of a law, without the mass of the arm."""
    content = json.loads((data / "bam_xl330" / "published" / f"m{number}.json").read_text())
    values = {SOURCE.get(k, k): v for k, v in content.items() if not isinstance(v, str)}
    return {**values, "J": MASS * LENGTH**2 + values.pop("armature")}


def parts(data: Path) -> tuple[Recording, Recording, Recording]:
    """Return all logs, those that are fitted and those that are kept back."""
    whole = ready(recorded(data / "bam_xl330" / "xl330_pendulum_16logs.csv"))
    numbers = [number for name, number in whole.provenance["runs"].items() if name.endswith(KEPT)]
    kept = np.isin(whole.run, numbers)
    return whole, whole.select(~kept), whole.select(kept)


def starts(law: str, found: Mapping[str, MotionFit]) -> list[dict[str, float]]:
    """Return the optima of the laws that a law contains, as its own parameters."""
    listed = []
    for name in SIMPLER.get(law, ()):
        own = {**NEUTRAL, **found[name].parameters}
        halves = {"K_m": own["K_l"], "K_e": own["K_l"], "K_ms": own["K_ls"], "K_es": own["K_ls"]}
        listed.append({**halves, **own})
    return listed


def drawn(simulator: Simulator, keys: Sequence[str], seed: int) -> list[dict[str, float]]:
    """Return the best of many draws."""
    random = np.random.default_rng(seed)
    draws = [{key: float(np.exp(random.uniform(*np.log(RANGES[key])))) for key in keys} for _ in range(_DRAWS)]
    return sorted(draws, key=lambda values: _error(simulator, values))[:_BEST]


def _error(simulator: Simulator, values: Mapping[str, float]) -> float:
    return float(np.nan_to_num(motion_errors(simulator, values).position_mean_absolute, nan=1e3))


def chain(fitted: Recording, loop: Loop, seed: int = 0) -> dict[str, tuple[MotionFit, float]]:
    """Fit M1 to M6, each from the optima of those that it contains and from draws; with the processor time of each."""
    found: dict[str, tuple[MotionFit, float]] = {}
    for law in LAWS:
        begin = time.process_time()
        simulator = Simulator(Drive(Model(law())), fitted, loop=loop)
        begun = [*starts(law.name, {name: fit for name, (fit, _) in found.items()})]
        begun += drawn(simulator, simulator.keys, seed)
        fit = fit_motion(simulator, begun, loss="absolute", most=_JACOBIANS)
        found[law.name] = (fit, time.process_time() - begin)
    return found


def across_gains(fitted: Recording, loop: Loop, law: Any, start: Mapping[str, float]) -> float:
    """Return the mean absolute error on each gain, with the parameters of the others: no log is kept back for it."""
    gains = fitted["other.gain"]
    errors = []
    for gain in np.unique(gains):
        drive = Drive(Model(law()))
        others = fit_motion(
            Simulator(drive, fitted.select(gains != gain), loop=loop), [start], loss="absolute", most=_FEW
        )
        errors.append(_error(Simulator(drive, fitted.select(gains == gain), loop=loop), others.parameters))
    return float(np.mean(errors))


def evolution(simulator: Simulator, evaluations: int, seed: int = 0) -> tuple[str, dict[str, float]]:
    """Return the optimum of CMA-ES, or of differential evolution where it is not installed, within the ranges."""
    keys = simulator.keys
    low, high = np.log(np.array([RANGES[key] for key in keys])).T

    def cost(unit: Sequence[float]) -> float:
        values = np.exp(low + np.clip(unit, -0.5, 1.5) * (high - low))
        return _error(simulator, dict(zip(keys, values.tolist(), strict=True)))

    try:
        import cma
    except ImportError:
        from scipy.optimize import differential_evolution

        rounds = max(1, evaluations // (10 * len(keys)) - 1)
        ended = differential_evolution(
            cost, [(0.0, 1.0)] * len(keys), maxiter=rounds, popsize=10, polish=False, seed=seed
        )
        return "differential evolution", dict(zip(keys, np.exp(low + ended.x * (high - low)).tolist(), strict=True))
    options = {"maxfevals": evaluations, "seed": seed + 1, "verbose": -9, "verb_log": 0}
    best, _ = cma.fmin2(cost, [0.5] * len(keys), 0.25, options)
    unit = np.clip(best, -0.5, 1.5)
    return "CMA-ES", dict(zip(keys, np.exp(low + unit * (high - low)).tolist(), strict=True))


def tables(data: Path, say: Callable[[str], None], *, peers: bool = True) -> dict[str, list[list[str]]]:
    """Return the tables, each a list of rows with its title row first."""
    whole, fitted, kept = parts(data)
    logs = read_logs(data / "bam_xl330" / "xl330_pendulum_16logs.csv")
    rows = [["law", "published here", "the source's steps of 5 ms", "steps that stick exactly"]]
    printed = ("79.5", "78.8", "66.3", "67.3", "71.8", "71.2")
    for number, law in enumerate(LAWS, start=1):
        values = published(number, data)
        old = {key.removeprefix("loop."): value for key, value in values.items()}
        old["armature"] = values["J"] - MASS * LENGTH**2
        exact = motion_errors(Simulator(Drive(Model(law())), whole, loop=Firmware()), values)
        rows.append(
            [law.name, printed[number - 1], _mrad(Bench(law).error(logs, old)), _mrad(exact.position_mean_absolute)]
        )
    found: dict[str, list[list[str]]] = {"published parameters": rows}
    for loop in (SaggingSupply(), Firmware()):
        say(f"fitting M1 to M6: {loop.name}")
        fits = chain(fitted, loop)
        titles = ["law", "parameters", "fit", "kept back", "across gains", "seconds"]
        rows = [[*titles, *(["peer: fit", "peer: kept back", "peer: seconds"] if peers else [])]]
        for law in LAWS:
            fit, seconds = fits[law.name]
            simulator = Simulator(Drive(Model(law())), fitted, loop=loop)
            other = Simulator(simulator.drive, kept, loop=loop)
            row = [law.name, str(len(fit.estimated)), _mrad(fit.errors.position_mean_absolute)]
            row.append(_mrad(_error(other, fit.parameters)))
            row.append(_mrad(across_gains(fitted, loop, law, fit.parameters)))
            row.append(f"{seconds:.1f}")
            if peers:
                begin = time.process_time()
                name, values = evolution(simulator, max(fit.evaluations, _PEER))
                seconds = time.process_time() - begin
                row += [_mrad(_error(simulator, values)), _mrad(_error(other, values)), f"{seconds:.1f}"]
                rows[0][-3:] = [f"{name}: fit", f"{name}: kept back", f"{name}: seconds"]
            rows.append(row)
            say(" | ".join(row))
        total = sum(seconds for _, seconds in fits.values())
        say(f"{loop.name}: {total:.1f} s of processor time for all six")
        found[loop.name] = rows
    return found


def _mrad(value: float) -> str:
    return f"{1e3 * value:.1f}"
