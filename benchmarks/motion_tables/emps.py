"""EMPS: fitted on the identification file, the file with force pulses simulated from the force alone."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from scipy.signal import butter, filtfilt

from fricmodels import Recording, improve
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.motion import MotionFit, Rung, Simulator, fit_motion, judged, motion_errors
from fricmodels.motion.fit import Loss, Objective
from fricmodels.readers import read
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready
from motion_tables import coloured
from motion_tables.lengths import in_several_lengths

COLUMNS = ("time=t:s", "force=force_N:N", "position=pos_m:m")
AUTHORS = {
    "coulomb-viscous+torque-offset": (
        {"M": 95.1089, "K_v": 203.5034, "K_c": 20.3935, "torque-offset.tau_0": -3.1648}, "8.33",
    ),
    "asymmetric-coulomb-viscous": (
        {"M": 95.1540, "K_v1": 166.7061, "K_c1": 20.1440, "K_v2": 240.4236, "K_c2": 20.6277}, "12.1",
    ),
}  # fmt: skip
"""Parameters of Janot, Gautier and Brunot (2019), and the error that a prototype measured with them [mm]."""
BASE = "coulomb-viscous"
FILES = ("id", "pulses")
STRUCTURES = (
    "coulomb-viscous+torque-offset",
    "coulomb-viscous+asymmetry",
    "coulomb-viscous+asymmetry+stribeck",
    "coulomb-viscous+asymmetry+presliding",
    "coulomb-viscous+asymmetry+nonlinear-viscous",
    "coulomb-viscous+asymmetry+position-friction",
    "coulomb-viscous+asymmetry+frictional-lag",
    "coulomb-viscous+asymmetry+cogging",
    "coulomb-viscous+asymmetry+stribeck+presliding",
    "coulomb-viscous+asymmetry+stribeck+position-friction",
)
WAYS: tuple[tuple[str, Objective, Loss, int | None], ...] = (
    ("position, in one go", "position", "squares", None),
    ("velocity, in one go", "velocity", "squares", None),
    ("position, windows of 5 s", "position", "squares", 5000),
)


def recording(data: Path, which: str) -> Recording:
    """Return the identification file or the one with pulses, prepared."""
    return ready(read(data / "emps" / f"emps_{which}.csv", columns=COLUMNS, motion=Motion.LINEAR))


def _drive(name: str) -> Drive:
    return Drive(Model.parse(name), None, Motion.LINEAR)


def _error(drive: Drive, values: Mapping[str, float], part: Recording) -> str:
    return f"{1e3 * motion_errors(Simulator(drive, part), values).position:.2f}"


def tables(data: Path, say: Callable[[str], None], *, peers: bool = True) -> dict[str, list[list[str]]]:
    """Return the tables, each a list of rows with its title row first."""
    fitted, pulses = recording(data, "id"), recording(data, "pulses")
    rows = [["the authors' parameters", "prototype [mm]", "identification file [mm]", "pulses file [mm]"]]
    for name, (values, printed) in AUTHORS.items():
        drive = _drive(name)
        rows.append([name, printed, _error(drive, values, fitted), _error(drive, values, pulses)])
    count = min(len(fitted), len(pulses))
    replayed = fitted["position"][:count] - pulses["position"][:count]
    rows.append(["the identification file, replayed", "", "0", f"{1e3 * float(np.sqrt(np.mean(replayed**2))):.2f}"])
    return {
        "The authors' parameters, simulated": rows,
        "The structure chosen on the identification file alone": _chosen(fitted, pulses, say),
        "Every attempt: structure × what was made small": _attempts(fitted, pulses, say),
        "How much of it is the level of friction, which differs between the files": _levels(fitted, pulses),
        "Maximum likelihood with a coloured force": _coloured(fitted, pulses, say),
        "Windows of several lengths at once": _several(fitted, pulses, say),
        "Friction of the pulses file above that of the identification file, at constant speed": _above(data),
        "If the friction of the identification file were known without an error": _replayed(fitted, pulses),
    }


def _chosen(fitted: Recording, pulses: Recording, say: Callable[[str], None]) -> list[list[str]]:
    """Take the ladder of `improve`, fit every rung to the motion, and let the parts that are held out choose."""
    begin = time.process_time()
    ladder = improve(fitted, BASE)
    say(f"improve: {time.process_time() - begin:.0f} s")
    rungs = list({rung.model: rung.comparison for rung in ladder.rungs}.values())
    found = judged([Rung(r.drive, r.estimate.parameters) for r in rungs], rungs[0].train, rungs[0].test)
    titles = ["rung of the ladder", "kept back, by torque", "kept back, fitted to the motion", "behind", "taken"]
    before: dict[str, float] = {}
    rows = [[*titles, "refitted to the whole file: itself", "pulses file", "pulses, parameters of the torque"]]
    for each in found:
        drive = each.rung.drive
        start = each.rung.parameters if each.fit is None else each.fit.parameters
        whole = fit_motion(Simulator(drive, fitted), [start, each.rung.parameters, {**each.rung.parameters, **before}])
        before = dict(whole.parameters)
        rows.append(
            [
                each.rung.name,
                f"{1e3 * each.by_torque.position:.2f}",
                "–" if each.test is None else f"{1e3 * each.test.position:.2f}",
                f"{each.behind[0]:.2f} ({each.behind[1]:.2f})",
                "yes" if each.chosen else "",
                f"{1e3 * whole.errors.position:.2f}",
                _error(drive, whole.parameters, pulses),
                _error(drive, each.rung.parameters, pulses),
            ]
        )
        say(" | ".join(rows[-1]))
    return rows


def _attempts(fitted: Recording, pulses: Recording, say: Callable[[str], None]) -> list[list[str]]:
    rows = [["structure", "by torque", *(f"{title}" for title, *_ in WAYS)]]
    best: dict[str, dict[str, MotionFit]] = {title: {} for title, *_ in WAYS}
    for name in STRUCTURES:
        drive = _drive(name)
        torque = estimate(drive, fitted)[1].parameters
        row = [name, f"{_error(drive, torque, fitted)} → {_error(drive, torque, pulses)}"]
        for title, objective, loss, horizon in WAYS:
            simulator = Simulator(drive, fitted, horizon=horizon)
            smaller = best[title].get(name.rpartition("+")[0])
            starts = [torque, *([] if smaller is None else [{**torque, **smaller.parameters}])]
            try:
                fit = fit_motion(simulator, starts, objective=objective, loss=loss)
            except FricmodelsError as error:
                row.append(str(error).partition(" of ")[0])
                continue
            best[title][name] = fit
            row.append(f"{_error(drive, fit.parameters, fitted)} → {_error(drive, fit.parameters, pulses)}")
        rows.append(row)
        say(" | ".join(row))
    return rows


def _levels(fitted: Recording, pulses: Recording) -> list[list[str]]:
    """Fit on the identification file; then find on the pulses file what is given only, all else held."""
    rows = [["structure", "nothing from the pulses", "the Coulomb friction", "and the offset", "all parameters"]]
    for name in ("coulomb-viscous+asymmetry+torque-offset", "coulomb-viscous+asymmetry+stribeck+torque-offset"):
        drive = _drive(name)
        fit = fit_motion(Simulator(drive, fitted), [{**estimate(drive, fitted)[1].parameters}])
        found = [_refound(drive, fit.parameters, pulses, keys) for keys in (("K_c",), ("K_c", "torque-offset.tau_0"))]
        row = [name, _error(drive, fit.parameters, pulses), *(f"{error:.2f}" for error in found)]
        row.append(f"{1e3 * fit_motion(Simulator(drive, pulses), [fit.parameters]).errors.position:.2f}")
        rows.append(row)
    return rows


def _refound(drive: Drive, values: Mapping[str, float], part: Recording, keys: tuple[str, ...]) -> float:
    """Return the least error [mm] with some parameters found on a recording."""
    from scipy.optimize import least_squares

    simulator = Simulator(drive, part)

    def residual(at: np.ndarray) -> np.ndarray:
        moved = {**values, **dict(zip(keys, at.tolist(), strict=True))}
        return np.asarray(1e3 * (simulator(moved)[0] - part["position"])[simulator.scored])

    found = least_squares(residual, [values[key] for key in keys], diff_step=1e-4)
    return float(np.sqrt(np.mean(found.fun**2)))


def _coloured(fitted: Recording, pulses: Recording, say: Callable[[str], None]) -> list[list[str]]:
    """Fit the asymmetric law as if the unrecorded force were coloured; see :mod:`motion_tables.coloured`."""
    drive = _drive("coulomb-viscous+asymmetry")
    rows = [["unrecorded force", "M [kg]", "K_v [N s/m]", "K_c [N]", "delay [ms]", "identification file", "pulses"]]
    listed = tuple(coloured.PARTS)
    offsets, wave = listed[:2], listed[-1:]
    tried = ((), False), (listed[:1], False), (offsets, False), (listed, False), ((*offsets, *wave), True)
    for parts, delay in tried:
        found = coloured.fitted(fitted, parts, delay=delay)
        told = [f"{found.parameters[key]:.2f} ± {found.errors[key]:.2f}" for key in ("M", "K_v", "K_c")]
        late = f"{1e3 * found.delay:.2f}" if delay else "–"
        errors = [_error(drive, found.parameters, part) for part in (fitted, pulses)]
        rows.append([", ".join(("white", *parts)), *told, late, *errors])
        say(" | ".join(rows[-1]))
    return rows


def _several(fitted: Recording, pulses: Recording, say: Callable[[str], None]) -> list[list[str]]:
    """Fit in windows of many lengths at once, each weighed by what it leaves."""
    rows = [["structure", "one piece to 1/4", "to 1/16", "to 1/256", "1/4 to 1/256"]]
    for name in STRUCTURES[1:3]:
        drive, row = _drive(name), [name]
        torque = estimate(drive, fitted)[1].parameters
        for first, last in ((0, 2), (0, 4), (0, 8), (2, 8)):
            values = in_several_lengths(drive, fitted, torque, range(first, last + 1))
            row.append(f"{_error(drive, values, fitted)} → {_error(drive, values, pulses)}")
        rows.append(row)
        say(" | ".join(row))
    return rows


def _replayed(fitted: Recording, pulses: Recording) -> list[list[str]]:
    r"""Let the pulses' force drive an axis whose friction is, at each instant, that of the identification file.

    Both files follow the same reference, so place, direction and speed agree at each instant. What a model that knows
    the friction of the identification file without an error would be off by is

    .. math:: M\dot v + K v = (F - M\dot\omega)_\text{pulses} - (F - M\dot\omega)_\text{identification}

    with K the change of friction with speed, which is what a wrong speed makes good.
    """
    rows = [["M [kg]", "K forward, backward [N s/m]", "the file's own friction", "mean of its four periods"]]
    mass, step, period = 95.0, fitted.interval, 6240
    count = min(len(fitted), len(pulses))
    whole = count // period * period
    smooth = butter(2, 100 * 2 * step)
    speeds = [filtfilt(*smooth, np.gradient(part["position"][:count], step)) for part in (fitted, pulses)]
    push, late = pulses.torque[:count] - fitted.torque[:count], speeds[1] - speeds[0]
    mean_force = fitted.torque[:whole].reshape(-1, period).mean(axis=0)[np.arange(count) % period]
    mean_speed = speeds[0][:whole].reshape(-1, period).mean(axis=0)[np.arange(count) % period]
    for forward, backward in ((165.0, 240.0), (200.0, 200.0), (140.0, 205.0)):
        found = []
        for more, ahead in ((push, late), (pulses.torque[:count] - mean_force, speeds[1] - mean_speed)):
            momentum, place, placed = mass * ahead[0], 0.0, np.zeros(count)
            for k in range(count):
                off, placed[k] = momentum / mass - ahead[k], place
                momentum += step * (more[k] - (forward if speeds[1][k] > 0 else backward) * off)
                place += step * off
            found.append(f"{1e3 * float(np.sqrt(np.mean(placed**2))):.1f}")
        rows.append([f"{mass:.0f}", f"{forward:.0f}, {backward:.0f}", *found])
    return rows


def _above(data: Path) -> list[list[str]]:
    """Compare the mean forces [N] where the reference's speed is constant and no pulse was within 80 ms."""
    one, two = (np.genfromtxt(data / "emps" / f"emps_{which}.csv", delimiter=",", names=True) for which in FILES)
    step = float(np.mean(np.diff(one["t"])))
    speed = np.gradient(one["pos_ref_m"], step)
    steady = (np.abs(np.gradient(speed, step)) < 1e-2) & (np.abs(speed) > 0.02)
    edges = np.flatnonzero(np.diff(two["pulse_N"]) != 0) + 1
    last = np.searchsorted(edges, np.arange(len(speed)), side="right") - 1
    quiet = (last < 0) | (np.arange(len(speed)) - edges[np.maximum(last, 0)] > 80)
    begins, ends = (np.flatnonzero(np.diff(np.concatenate([[0], steady, [0]])) == sign) for sign in (1, -1))
    found = []
    for begin, end in zip(begins, ends, strict=True):
        if end - begin > 160:
            part = np.arange(begin + 100, end)
            more = np.mean(two["force_N"][part[quiet[part]]]) - np.mean(one["force_N"][part])
            found.append((abs(speed[begin + 100]), one["t"][begin] // 6.24, more * np.sign(speed[begin + 100])))
    rows = [["speed [m/s]", *(f"period {number + 1}" for number in range(4)), "all"]]
    for least, most in ((0.02, 0.06), (0.06, 0.1), (0.1, 0.15), (0.02, 0.15)):
        own = np.array([[n, more] for at, n, more in found if least < at < most])
        means = [f"{np.mean(own[own[:, 0] == number, 1]):.2f}" for number in range(4)]
        rows.append([f"{least} to {most}", *means, f"{np.mean(own[:, 1]):.2f}"])
    return rows
