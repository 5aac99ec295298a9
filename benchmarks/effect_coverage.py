"""Do the intervals hold on drives of another make? Coverage of the 95 % intervals by effect, on the rough drives.

A drive of `rough_drives.py` with one hidden effect (or none) is recorded as its logger would, and the true model is
fitted as ``compare`` fits it. Every parameter of law and effect whose true value follows from the simulator's equations
is set beside its estimate. The simulator shares nothing with the rig, and its sensors are rough: encoders of 12 to 20
bit, derived or low-passed velocities, coloured noise, jitter.

    python benchmarks/effect_coverage.py --count 20 --seed 1 --processes 2 [--keep FILE] [--effects backlash,gravity]

Printed for each parameter: how many of the intervals hold the truth, how many parameters have none and say why, the
median and the largest distance in standard errors.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from fricmodels.diagnosis import compare
from fricmodels.errors import FricmodelsError
from rough.effects import Change
from rough.record import PAUSE, Case, record
from rough.trials import BASE, case_of

SIDE = 1.959963984540054
NONE = "nothing"
WAVES = {"cogging": 1.0, "position-friction": 1.0, "torque-ripple": -1.0}
"""Sign with which a wave of the simulator counts as torque against the motion."""
EXPONENTS = {0.5: "a", 2.0: "b"}
EFFECTS = (
    NONE, "asymmetry", "torque-offset", "stribeck", "nonlinear-viscous", "load-friction", "directional-efficiency",
    "torque-gain", "inertia-error", "gravity", "stiffness", *WAVES, "presliding", "rising-stiction", "backlash",
    "joint-compliance", "step-change", "sensor-delay",
)  # fmt: skip
Row = dict[str, Any]


def truth(case: Case) -> dict[str, float]:
    """Return the true parameters, by key, as far as the simulator's equations give them."""
    d, p = case.drive, case.drive.plant
    found = {"J": p.inertia, "M": p.inertia, "K_v": p.viscous_forward, "K_c": p.coulomb_forward}
    for one in case.changes:
        own = wave(one) if one.name in WAVES else _of_fields(case, one, one.fields)
        if one.course == "step":
            own = {"c": one.coulomb * p.coulomb_forward, "d": 0.0, "t_0": one.at * d.runs * (d.duration + PAUSE)}
        if one.name == "sensor-delay":
            own = {"T": one.delay + case.lag}
        if one.name == "nonlinear-viscous" and not own:  # the model's two powers stand for another one, and so does K_v
            del found["K_v"], found["K_c"]
        found |= {f"{one.name}.{symbol}": value for symbol, value in own.items()}
    return found


def _of_fields(case: Case, one: Change, f: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of an effect that changes fields of the plant."""
    p = case.drive.plant
    match one.name:
        case "asymmetry":
            return {"c": f["coulomb_forward"], "d": f["viscous_forward"]}
        case "torque-offset":
            return {"tau_0": f["offset"]}
        case "stribeck":
            return {"F_s": f["stribeck_rise"], "omega_s": f["stribeck_speed"], "delta": f["stribeck_exponent"]}
        case "nonlinear-viscous":
            own = EXPONENTS.get(f["power_exponent"])
            return {s: f["power_coefficient"] * (s == own) for s in EXPONENTS.values()} if own else {}
        case "load-friction":
            return {"mu": f["load_friction"]}
        case "directional-efficiency":
            return {"mu_d": f["driving_loss"], "mu_b": f["driven_loss"]}
        case "torque-gain":
            return {"g": f["gain"]}
        case "inertia-error":
            return {"dJ": f["inertia"]}
        case "gravity":
            return {"a": f["gravity_cosine"], "b": f["gravity_sine"]}
        case "stiffness":
            return {"k": f["stiffness"], "tau_0": -f["stiffness"] * f["neutral"]}
        case "presliding":
            both = p.coulomb_forward
            return {"F_1": both, "F_2": both, "D": f["presliding_damping"], "x_s": f["presliding_distance"]}
        case "rising-stiction":
            return {"F": f["ageing_rise"], "T": f["ageing_time"], "x_s": f["ageing_distance"]}
        case "backlash":
            own_friction = f["link_friction"] * p.coulomb_forward
            a, speed = own_friction / f["link_inertia"], p.coulomb_forward / p.viscous_forward
            return {"J_l": f["link_inertia"], "w": f["gap"], "a": a, "omega_v": speed, "F": own_friction, "b": 0.0}
        case "joint-compliance":
            natural = math.sqrt(f["contact_stiffness"] / f["link_inertia"])
            zeta = f["contact_damping"] / (2 * f["link_inertia"] * natural)
            return {"J_l": f["link_inertia"], "omega_n": natural, "zeta": zeta}
        case _:
            return {}


def wave(one: Change) -> dict[str, float]:
    """Return the amplitudes and the wave number of a periodic effect: A cos(k q + φ), with or without its harmonic."""
    sign, found = WAVES[one.name], {"a_2": 0.0, "b_2": 0.0, "k": one.waves[0][1]}
    for suffix, (_, _, amplitude, phase) in zip(("", "_2"), one.waves, strict=False):
        found |= {f"a{suffix}": sign * amplitude * math.cos(phase), f"b{suffix}": -sign * amplitude * math.sin(phase)}
    return found


def trial(task: tuple[str, int, int]) -> Row:
    """Fit the true model to one recording."""
    name, index, seed = task
    case, _, _ = case_of("null" if name == NONE else "single", name, index, seed)
    recording, true, began = record(case), truth(case), time.process_time()
    if "step-change.t_0" in true:
        true["step-change.t_0"] -= float(recording.time[0])  # instants are told from the first sample
    row: Row = {"effect": name, "index": index, "seed": seed, "motion": case.motion, "status": "ok"}
    try:
        found = compare(recording, BASE if name == NONE else f"{BASE}+{name}", case.inertia)
    except FricmodelsError as refused:
        return {**row, "status": "refused", "message": str(refused), "seconds": time.process_time() - began}
    estimate, asked = found.estimate, dict(true)
    if case.inertia is not None:
        asked = {key: value for key, value in asked.items() if key not in ("J", "M")}
    parameters = {
        key: {
            "true": asked[key],
            "value": value,
            "error": estimate.standard_errors.get(key),
            "why": estimate.not_identified.get(key, ""),
        }
        for key, value in estimate.parameters.items()
        if key in asked
    }
    errors = {"test": found.errors.held_out_percent, "floor": found.noise_floor_percent}
    return {**row, **errors, "parameters": parameters, "seconds": time.process_time() - began}


def printed(rows: Sequence[Row]) -> Iterator[str]:
    """Yield a table: one line for each parameter of each effect, the law's by themselves, and the sums."""
    yield "| effect | parameter | hold the truth | 95 % of it | without an interval | median, largest distance [SE] |"
    yield "|---|---|---|---|---|---|"
    everything: list[Mapping[str, Any]] = []
    for name in EFFECTS:
        mine = [row for row in rows if row["effect"] == name and row["status"] == "ok"]
        keys = dict.fromkeys(key for row in mine for key in row["parameters"])
        for key in keys:
            found = [row["parameters"][key] for row in mine if key in row["parameters"]]
            everything += found
            yield f"| `{name}` | {key.rpartition('.')[2]} | {_held(found)} |"
    yield f"| all | | {_held(everything)} |"
    refused = sum(row["status"] != "ok" for row in rows)
    yield f"\n{len(rows)} recordings, {refused} refused, {np.mean([row['seconds'] for row in rows]):.1f} s each."


def _held(found: Sequence[Mapping[str, Any]]) -> str:
    """Return the cells of one line. What is named as not identified makes no promise, and counts as no interval."""
    from scipy.stats import binomtest

    given = [p for p in found if p["error"] and not p["why"]]
    distances = [abs(p["value"] - p["true"]) / p["error"] for p in given]
    if not distances:
        return f"– | – | {len(found)} | –"
    hold = sum(distance <= SIDE for distance in distances)
    likely = binomtest(hold, len(distances)).proportion_ci(0.95)
    between = f"{100 * likely.low:.0f}–{100 * likely.high:.0f}"
    spread = f"{np.median(distances):.2f}, {max(distances):.3g}"
    return f"{hold} of {len(distances)} | {between} % | {len(found) - len(given)} | {spread}"


def collected(tasks: Sequence[tuple[str, int, int]], processes: int, kept: Path | None) -> list[Row]:
    """Return the rows of all trials; those in the file ``kept`` are not run again, and new ones go there."""
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept and kept.exists() else []
    done = {(row["effect"], row["index"], row["seed"]) for row in rows}
    left = [task for task in tasks if task not in done]
    began = time.perf_counter()
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for count, row in enumerate(pool.imap_unordered(trial, left), start=1):
            rows.append(row)
            if kept:
                with kept.open("a") as file:
                    file.write(json.dumps(row) + "\n")
            if count % 20 == 0 or count == len(left):
                rate = count / (time.perf_counter() - began)
                print(f"{count} of {len(left)}, {(len(left) - count) / rate / 60:.1f} min left", file=sys.stderr)
    wanted = set(tasks)
    return [row for row in rows if (row["effect"], row["index"], row["seed"]) in wanted]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--effects", default=",".join(EFFECTS), help="names with commas; 'nothing' is none")
    parser.add_argument("--count", type=int, default=20, help="recordings of each")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=None, help="file of rows (JSON lines) to resume from and add to")
    arguments = parser.parse_args()
    if arguments.keep:
        arguments.keep.parent.mkdir(parents=True, exist_ok=True)
    names = arguments.effects.split(",")
    tasks = [(name, index, arguments.seed) for index in range(arguments.count) for name in names]
    print("\n".join(printed(collected(tasks, arguments.processes, arguments.keep))))


if __name__ == "__main__":
    main()
