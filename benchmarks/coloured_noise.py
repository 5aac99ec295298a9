"""Drives whose sensors are noisy as real ones are: how often a name is given that is not there, and one that is.

A closed loop of its own, which shares no code with the rig or with ``fricmodels.simulation``: a controller at 5 kHz,
four steps of motion to each of its own, logged at 100 Hz to 5 kHz. Noise of the velocity or of the torque is
autoregressive (0.9 to 0.99 from sample to sample, 0.5 to 2 % of the RMS value), or only positions are logged from an
encoder of 10 to 16 bit, or the stamps are false by up to ± 20 %. Everything is drawn from the kind and a number.

    python benchmarks/coloured_noise.py                          all kinds, 25 recordings each with nothing hidden
    python benchmarks/coloured_noise.py --kinds torque --nulls 8 --hidden 1
"""

from __future__ import annotations

import argparse
import json
import time
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.signal import lfilter

from fricmodels.diagnosis import examine
from fricmodels.diagnosis.comparison import compare
from fricmodels.dimension import Motion
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording

Array = NDArray[np.float64]

CONTROL = 5000
"""Steps of the controller per second."""
FINER = 4
SECONDS = 14.0
KINDS = ("velocity", "torque", "encoder", "stamps")
HEADER = "| noise | hidden | recordings | answers | K_c holds | K_v holds | median K_c off | s |"
EFFECTS = ("gravity", "cogging", "stribeck", "asymmetry", "torque-offset", "presliding")
DRIVES: Mapping[str, Mapping[str, float]] = {
    "joint": {"J": 1.2, "K_c": 8.0, "K_v": 5.0, "speed": 1.6, "loop": 50.0},
    "spindle": {"J": 2e-4, "K_c": 0.04, "K_v": 6e-4, "speed": 70.0, "loop": 60.0},
}
"""SI units; ``speed`` is the greatest one wanted, ``loop`` the bandwidth of the controller [rad/s]."""


@njit(cache=True)
def _closed_loop(wanted, rate, gains, drive, effect):  # type: ignore[no-untyped-def]
    """Return torque, velocity and position at every step of the controller; see :func:`simulated` for the arguments."""
    inertia, coulomb, viscous = drive
    stiffness, damping = gains
    gravity, cogging, order, stick, slow, asymmetry, offset, bristle = effect
    step = 1.0 / (rate * FINER)
    count = wanted.shape[1]
    torque, speed, place = np.zeros(count), np.zeros(count), np.zeros(count)
    q, w, z = wanted[0, 0], 0.0, 0.0
    for k in range(count):
        u = stiffness * (wanted[0, k] - q) + damping * (wanted[1, k] - w) + inertia * wanted[2, k] + viscous * w
        torque[k], speed[k], place[k] = u, w, q
        for _ in range(FINER):
            net = u - gravity * np.sin(q) - cogging * np.cos(order * q + 0.4) - offset
            size = coulomb + stick * np.exp(-abs(w) / slow)
            up, down = size * (1.0 + asymmetry), size * (1.0 - asymmetry)
            if bristle > 0.0:
                z += step * w - abs(w) * step * z / bristle
                w += step * (net - viscous * w - coulomb * z / bristle) / inertia
            elif w == 0.0 and -down <= net <= up:
                pass
            else:
                side = np.sign(w) if w != 0.0 else np.sign(net)
                friction = (up if side > 0 else -down) + viscous * w
                after = w + step * (net - friction) / inertia
                w = 0.0 if w * after < 0.0 else after
            q += step * w
    return torque, speed, place


def _course(rng: np.random.Generator, speed: float) -> tuple[str, Array]:
    """Return a kind of motion, and position, velocity and acceleration wanted, shape (3, N)."""
    t = np.arange(int(SECONDS * CONTROL)) / CONTROL
    kind = str(rng.choice(["sines", "sine", "moves", "moves with rests"]))
    if kind == "sine":
        omega = 2 * np.pi * rng.uniform(0.3, 0.8)
        return kind, np.stack(
            [-speed / omega * np.cos(omega * t), speed * np.sin(omega * t), speed * omega * np.cos(omega * t)]
        )
    if kind == "sines":
        omegas = 2 * np.pi * rng.uniform(0.1, 1.2, 6)
        phases = rng.uniform(0, 2 * np.pi, 6)
        sizes = speed * rng.uniform(0.3, 1.0, 6) / 2.2
        angle = np.outer(omegas, t) + phases[:, None]
        return kind, np.stack(
            [-(sizes / omegas) @ np.cos(angle), sizes @ np.sin(angle), (sizes * omegas) @ np.cos(angle)]
        )
    velocity = np.zeros(len(t))
    start, side = 0.3, 1.0
    while start < SECONDS - 2.0:
        top = speed * rng.uniform(0.3, 1.0) * side
        lasts, rise = rng.uniform(0.4, 1.2), rng.uniform(0.08, 0.25)
        up = np.clip((t - start) / rise, 0, 1) - np.clip((t - start - lasts) / rise, 0, 1)
        velocity += top * (3 * up**2 - 2 * up**3)
        start += lasts + rise + (rng.uniform(0.1, 0.5) if "rests" in kind else 0.002)
        side = -side
    return kind, np.stack([np.cumsum(velocity) / CONTROL, velocity, np.gradient(velocity) * CONTROL])


def coloured(rng: np.random.Generator, count: int, correlation: float) -> Array:
    """Return autoregressive noise of variance 1, stationary from its first sample on."""
    white = rng.standard_normal(count)
    white[1:] *= np.sqrt(1 - correlation**2)
    return np.asarray(lfilter([1.0], [1.0, -correlation], white))


def simulated(kind: str, effect: str, number: int) -> tuple[Recording, float | None, dict[str, Any]]:
    """Return a recording, the inertia if it is given, and what was drawn.

    Args:
        kind: one of :data:`KINDS`. effect: hidden, one of :data:`EFFECTS`, or empty. number: of the recording.
    """
    rng = np.random.default_rng(zlib.crc32(f"{kind}/{effect}#{number}".encode()))
    name = str(rng.choice(list(DRIVES)))
    drive = DRIVES[name]
    motion, wanted = _course(rng, drive["speed"])
    size = rng.uniform(0.15, 0.35) * drive["K_c"] * np.sqrt(2)
    turns = {"joint": 6.0, "spindle": 1.0}[name] * rng.uniform(0.8, 1.6)
    effects = {
        "gravity": size if effect == "gravity" else 0.0,
        "cogging": size if effect == "cogging" else 0.0,
        "order": turns,
        "stick": 3 * size if effect == "stribeck" else 0.0,
        "slow": 0.1 * drive["speed"],
        "asymmetry": size / drive["K_c"] / 1.4 if effect == "asymmetry" else 0.0,
        "offset": size / 1.4 if effect == "torque-offset" else 0.0,
        "bristle": 0.01 * drive["speed"] if effect == "presliding" else 0.0,
    }
    gains = (drive["J"] * drive["loop"] ** 2, 1.6 * drive["J"] * drive["loop"])
    true = (drive["J"], drive["K_c"], drive["K_v"])
    torque, velocity, position = _closed_loop(wanted, CONTROL, gains, true, tuple(effects.values()))
    if kind == "encoder":
        rate = int(rng.choice([100, 200, 500, 1000, 2500, 5000]))
    else:
        rate = int(rng.choice([250, 500, 1000, 1000, 1000, 2500]))
    keep = slice(0, None, CONTROL // rate)
    torque, velocity, position = torque[keep].copy(), velocity[keep].copy(), position[keep].copy()
    time_stamps = np.arange(len(torque)) / rate
    drawn = {"drive": name, "motion": motion, "rate": rate, "effect": effect}
    share, correlation = rng.uniform(0.005, 0.02), float(rng.choice([0.9, 0.95, 0.98, 0.99]))
    channels = {"time": time_stamps, "torque": torque, "velocity": velocity}
    with_position = effect in ("gravity", "cogging") or rng.random() < 0.3
    if kind == "velocity":
        channels["velocity"] = velocity + share * np.std(velocity) * coloured(rng, len(torque), correlation)
        drawn |= {"size %": 100 * share, "correlation": correlation}
    elif kind == "torque":
        channels["torque"] = torque + share * np.std(torque) * coloured(rng, len(torque), correlation)
        drawn |= {"size %": 100 * share, "correlation": correlation}
    elif kind == "encoder":
        bits = int(rng.integers(10, 17))
        step = 2 * np.pi / 2**bits
        del channels["velocity"]
        channels["position"] = step * np.floor(position / step)
        drawn |= {"bits": bits}
    else:
        false = rng.uniform(0.05, 0.2)
        channels["time"] = time_stamps + false / rate * rng.uniform(-1, 1, len(torque))
        drawn |= {"false": false}
    if kind in ("torque", "stamps"):
        channels["velocity"] = velocity + 0.002 * np.std(velocity) * rng.standard_normal(len(torque))
    if with_position and kind != "encoder":
        step = 2 * np.pi / 2**14
        channels["position"] = step * np.floor(position / step)
        drawn |= {"position": True}
    inertia = drive["J"] if rng.random() < 0.75 else None
    drawn |= {"inertia": "given" if inertia else "estimated", "K_c": drive["K_c"], "K_v": drive["K_v"]}
    run = np.zeros(len(torque), dtype=np.int64)
    return Recording(f"{kind}-{effect}-{number}", Motion.ROTARY, channels, run), inertia, drawn


def judged(kind: str, effect: str, number: int) -> dict[str, Any]:
    """Diagnose one recording and return what was said."""
    recording, inertia, drawn = simulated(kind, effect, number)
    row: dict[str, Any] = {"kind": kind, "number": number, **drawn}
    began = time.perf_counter()
    try:
        comparison = compare(recording, "coulomb-viscous", inertia)
        row["fit_seconds"] = time.perf_counter() - began
        diagnosis = examine(comparison)
    except FricmodelsError as error:
        return {**row, "verdict": f"error: {error}", "names": []}
    found, sizes = comparison.estimate, comparison.estimate.standard_errors
    for key in ("K_c", "K_v"):
        row[f"{key} off %"] = 100 * (found.parameters[key] / drawn[key] - 1)
        row[f"{key} z"] = (found.parameters[key] - drawn[key]) / sizes[key] if sizes.get(key) else None
    names = list(diagnosis.findings[0].names) if diagnosis.findings else []
    row |= {
        "seconds": time.perf_counter() - began,
        "verdict": diagnosis.verdict,
        "names": names,
        "view": diagnosis.view.channels if diagnosis.view else "",
        "noise": getattr(diagnosis, "noise", None) and str(diagnosis.noise),
        "percent": comparison.errors.held_out_percent,
        "floor": comparison.noise_floor_percent,
        "sliding": (comparison.sliding.held_out_percent, comparison.sliding.noise_percent),
        "width": comparison.problem.test_functions.width,
        "h": comparison.problem.half_width,
    }
    return row


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the lines of a Markdown table."""
    lines = [HEADER, "|" + "---|" * 8]
    for kind, hidden in dict.fromkeys((row["kind"], bool(row["effect"])) for row in rows):
        mine = [row for row in rows if row["kind"] == kind and bool(row["effect"]) == hidden]
        answers = Counter(_answer(row) for row in mine)
        said = ", ".join(f"{count} {answer}" for answer, count in answers.most_common())
        holds, off = [], "–"
        for key in ("K_c", "K_v"):
            z = [abs(row[f"{key} z"]) for row in mine if row.get(f"{key} z") is not None]
            holds.append(f"{sum(v < 1.96 for v in z)} of {len(z)}" if not hidden else "–")
        if not hidden:
            off = f"{np.median([abs(row['K_c off %']) for row in mine if 'K_c off %' in row]):.2g} %"
        seconds = np.median([row.get("seconds", np.nan) for row in mine])
        cells = [kind, "one" if hidden else "none", str(len(mine)), said, *holds, off, f"{seconds:.2g}"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def _answer(row: Mapping[str, Any]) -> str:
    if not row["names"]:
        return str(row["verdict"]).partition(":")[0]
    if row["names"][0] == row["effect"]:
        return "right"
    return "right class" if row["effect"] in row["names"] else "WRONG NAME"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--nulls", type=int, default=25, help="recordings of each kind with nothing hidden")
    parser.add_argument("--hidden", type=int, default=1, help="recordings of each kind and hidden effect")
    parser.add_argument("--first", type=int, default=0, help="number of the first recording")
    parser.add_argument("--out", type=Path, default=None, help="file of rows (JSON lines) to add to")
    parser.add_argument("--quiet", action="store_true")
    arguments = parser.parse_args()
    rows = []
    for kind in arguments.kinds.split(","):
        tasks = [("", arguments.first + i) for i in range(arguments.nulls)]
        tasks += [(effect, arguments.first + i) for effect in EFFECTS for i in range(arguments.hidden)]
        for effect, number in tasks:
            row = judged(kind, effect, number)
            rows.append(row)
            if not arguments.quiet:
                print({k: float(f"{v:.3g}") if isinstance(v, float) else v for k, v in row.items()}, flush=True)
            if arguments.out:
                with arguments.out.open("a") as file:
                    file.write(json.dumps(row, default=str) + "\n")
    print("\n".join(summary(rows)))


if __name__ == "__main__":
    main()
