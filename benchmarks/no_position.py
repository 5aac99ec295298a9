"""Drives of which a log has the torque and a velocity, and no position: its integral stands for it.

A drive keeps one speed after the other, between 0.02 and 8 rad/s, with one stop in seven, for 20 s at 1 kHz; the torque
has noise of 0.5 % of its RMS value. Hidden is nothing, or gravity of three fifths of the Coulomb torque, or cogging of
a fifth of it, seven waves a radian. The drive begins at any place. A mean of 20 samples is late: there a
`sensor-delay` is no wrong name. Of the true model it is printed by what factor the amplitude of the wave is off on
average, how many standard errors its parameters are off, in the mean square, and how many intervals of 95 % hold: of
K_v, K_c, the amplitude and the wave number.

    python benchmarks/no_position.py [--seeds 12]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from derivative_width import FINE, steps
from fricmodels import compare, diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

Array = NDArray[np.float64]
INERTIA, LAW = 1e-3, {"K_v": 3e-3, "K_c": 0.05}
SIZE, WAVES = {"gravity": 0.03, "cogging": 0.01}, {"gravity": 1.0, "cogging": 7.0}
RATE, NOISE, SECONDS, FIRST = 1000, 5e-4, 20.0, 40
RPM = np.pi / 30.0


def drawn(seed: int, hidden: str) -> tuple[Array, Array, dict[str, float]]:
    """Return velocity and torque at the samples, and the true parameters, of the place where the log begins."""
    rng = np.random.default_rng(seed)
    velocity, every = steps(seed, 8.0, SECONDS), FINE // RATE
    torque = INERTIA * np.gradient(velocity) * FINE + LAW["K_v"] * velocity + LAW["K_c"] * np.sign(velocity)
    true, begin = dict(LAW), rng.uniform(0.0, 2.0 * np.pi)
    if hidden:
        size, k = SIZE[hidden], WAVES[hidden]
        way = np.cumsum(velocity) / FINE
        torque = torque + size * np.sin(k * way + begin)
        true |= {f"{hidden}.k": k} if hidden == "cogging" else {}
    mean = np.convolve(torque, np.full(every, 1.0 / every), "same")[::every]
    return velocity[::every], mean + NOISE * rng.standard_normal(len(mean)), true


def sensors(seed: int, velocity: Array) -> Iterator[tuple[str, Array]]:
    """Yield what each kind of sensor makes of a velocity."""
    rng, size = np.random.default_rng(1000 + seed), float(np.sqrt(np.mean(velocity**2)))
    for share in (0.01, 0.2):
        yield f"noise of {100 * share:g} %", velocity + share * size * rng.standard_normal(len(velocity))
    yield "rounded to 1 rpm", RPM * np.round(velocity / RPM)
    yield "mean of 20 samples", np.convolve(velocity, np.full(20, 1.0 / 20.0))[: len(velocity)]
    noise = 0.01 * size * rng.standard_normal(len(velocity))
    yield "an offset of 0.5 %, noise of 1 %", velocity + 0.005 * size + noise


def tried(recording: Recording, hidden: str, true: Mapping[str, float]) -> tuple[bool, bool, list[float], float]:
    """Return whether the answer is right, whether it is a wrong name, and how far off the true model is."""
    late = "mean" in recording.name
    names = [one.names for one in diagnose(recording, "coulomb-viscous", INERTIA).findings]
    names = [each for each in names if not (late and "sensor-delay" in each)]
    if not hidden:
        return not names, bool(names), [], float("nan")
    fit = compare(recording, f"coulomb-viscous+{hidden}", INERTIA).estimate
    errors = {key: fit.standard_errors.get(key, 0.0) for key in true}
    off = [(fit.parameters[key] - value) / errors[key] for key, value in true.items() if errors[key] > 0.0]
    wave = [f"{hidden}.a", f"{hidden}.b"]
    a, b = (fit.parameters[key] for key in wave)
    size, places = float(np.hypot(a, b)), [list(fit.standard_errors).index(key) for key in wave]
    if fit.covariance is not None and size > 0.0:
        along = np.array([a, b]) / size
        error = float(np.sqrt(along @ fit.covariance[np.ix_(places, places)] @ along))
        off.extend([(size - SIZE[hidden]) / error] if error > 0.0 else [])
    amplitude = size / SIZE[hidden]
    right = bool(names) and hidden in names[0]
    return right, bool(names) and not right, off, amplitude


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=12, help="drives of each kind")
    count = parser.parse_args().seeds
    found: dict[tuple[str, str], list[tuple[bool, bool, list[float], float]]] = {}
    for seed in range(FIRST, FIRST + count):
        for hidden in ("", *SIZE):
            velocity, torque, true = drawn(seed, hidden)
            time = np.arange(len(velocity)) / RATE
            for name, seen in sensors(seed, velocity):
                channels = {"time": time, "torque": torque, "velocity": seen}
                recording = Recording(name, Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
                found.setdefault((name, hidden), []).append(tried(recording, hidden, true))
    print(f"{'velocity':<34}{'hidden':<9} right  wrong name  amplitude  standard errors off  intervals that hold")
    for (name, hidden), rows in found.items():
        line = f"{name:<34}{hidden or 'nothing':<9} {sum(r[0] for r in rows):>5}  {sum(r[1] for r in rows):>10}"
        off = np.array([value for row in rows for value in row[2]])
        if len(off):
            line += f"  {np.mean([row[3] for row in rows]):>9.3f}  {np.sqrt(np.mean(off**2)):>19.2f}"
            line += f"  {np.mean(np.abs(off) < 1.96):>8.0%}"
        print(f"{line}   of {len(rows)} drives")


if __name__ == "__main__":
    main()
