"""Drives whose motion and torque are formulas: intervals, false names, and names of a hidden effect.

Neither the rig nor a simulator takes part: a motion is written down (sines, a chirp, moves between rests, ramps, steps
of the speed), its torque is computed from inertia and friction, and both are sampled at one instant, at 100 Hz to
2 kHz, with white noise of 0.03 to 3 % on the velocity and 0.1 to 5 % on the torque, or positions of 14 to 19 bits.
The Coulomb torque jumps between two samples, as that of a compensated drive does.

    python benchmarks/closed_form.py intervals [--count 300] [--first 0]
    python benchmarks/closed_form.py nulls [--count 100]
    python benchmarks/closed_form.py singles [--count 80]
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.diagnose import examine
from fricmodels.dimension import Motion
from fricmodels.errors import FricmodelsError
from fricmodels.recording import Recording

Array = NDArray[np.float64]
SIDE = 1.959963984540054
FAR = 4.0
"""Standard errors from which a parameter is printed as an outlier."""
FINE = 16
"""Parts of a sampling interval over which a velocity is integrated."""
EFFECTS = (
    "stribeck", "asymmetry", "torque-offset", "gravity", "stiffness", "nonlinear-viscous", "cogging", "drift",
    "step-change",
)  # fmt: skip


@dataclass(frozen=True)
class Path:
    """A motion: position, velocity, acceleration, shape (N,) each."""

    kind: str
    position: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class Drawn:
    """A recording with what it was made from."""

    path: Path
    recording: Recording
    inertia_given: bool
    true: dict[str, float]
    hidden: str = ""

    @property
    def text(self) -> str:
        """What was drawn, for a line of the output."""
        channels = "+".join(name for name in ("velocity", "position") if name in self.recording)
        given = "inertia given" if self.inertia_given else "inertia estimated"
        rate = 1.0 / self.recording.interval
        return f"{self.hidden or 'nothing'}, {self.path.kind}, {rate:.0f} Hz, {channels}, {given}"


def path(rng: np.random.Generator, time: Array) -> Path:
    """Draw a motion."""
    kind = str(rng.choice(["sines", "moves", "ramps", "chirp", "speeds"]))
    if kind != "sines":  # a position is integrated by trapezia, which at the samples themselves are wrong by 0.1 %
        time = np.linspace(time[0], time[-1], FINE * (len(time) - 1) + 1)
    if kind == "sines":
        count = rng.integers(1, 6)
        rate, phase, size = (
            2 * np.pi * rng.uniform(0.1, 2.5, count),
            rng.uniform(0, 6.28, count),
            rng.uniform(0.3, 3, count),
        )
        angle = np.outer(rate, time) + phase[:, None]
        return Path(kind, -(size / rate) @ np.cos(angle), size @ np.sin(angle), (size * rate) @ np.cos(angle))
    if kind == "chirp":
        first, last, size = 0.1, rng.uniform(0.5, 4), rng.uniform(0.5, 4)
        angle = 2 * np.pi * (first * time + (last - first) * time**2 / 2 / time[-1])
        rate = 2 * np.pi * (first + (last - first) * time / time[-1])
        velocity, acceleration = size * np.sin(angle), size * rate * np.cos(angle)
    else:
        velocity, acceleration = blended(rng, time, kind)
    travelled = np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))
    way = Path(kind, np.concatenate([[0.0], travelled]), velocity, acceleration)
    return Path(kind, *(values[::FINE] for values in (way.position, way.velocity, way.acceleration)))


def blended(rng: np.random.Generator, time: Array, kind: str) -> tuple[Array, Array]:
    """Draw speeds that are held, and joined by fifth-order blends."""
    velocity, acceleration = np.zeros_like(time), np.zeros_like(time)
    now, before = 0.0, 0.0
    while now < time[-1]:
        blend, hold = rng.uniform(0.05, 0.5), rng.uniform(0.05, 1.0)
        drawn = {
            "moves": 0.0 if before else rng.choice([-1, 1]) * rng.uniform(0.5, 4),
            "ramps": rng.uniform(-3, 3),
            "speeds": rng.choice([-1, 1]) * rng.uniform(0.5, 2.5),
        }[kind]
        rising = (time >= now) & (time < now + blend)
        share = (time[rising] - now) / blend
        velocity[rising] = before + (drawn - before) * (10 * share**3 - 15 * share**4 + 6 * share**5)
        acceleration[rising] = (drawn - before) / blend * 30 * share**2 * (1 - share) ** 2
        velocity[(time >= now + blend) & (time < now + blend + hold)] = drawn
        now, before = now + blend + hold, drawn
    return velocity, acceleration


def drawn(seed: int, hide: bool = False) -> Drawn:
    """Draw a drive, its motion and its sensors, and if asked a hidden effect of about the Coulomb torque."""
    rng = np.random.default_rng([seed, 5])
    rate = float(rng.choice([100, 200, 500, 1000, 2000]))
    time = np.arange(int(min(rng.uniform(8, 40) * rate, 40_000))) / rate
    way = path(rng, time)
    inertia = 10 ** rng.uniform(-3, 0)
    true = {"J": inertia, "K_v": rng.uniform(0.5, 5) * inertia, "K_c": rng.uniform(0.5, 8) * inertia}
    velocity = way.velocity
    torque = inertia * way.acceleration + true["K_v"] * velocity + true["K_c"] * np.sign(velocity)
    name = str(rng.choice(EFFECTS)) if hide else ""
    if name:
        torque = torque + extra(rng, name, way, time, rng.uniform(0.15, 0.6) * true["K_c"])
    rest = velocity == 0.0
    torque[rest] = 0.3 * true["K_c"] * np.sin(3 * time[rest])  # anything that friction can hold
    noise = 10 ** rng.uniform(-3.5, -1.5) * velocity.std(), 10 ** rng.uniform(-3, -1.3) * torque.std()
    channels = {"time": time, "torque": torque + noise[1] * rng.standard_normal(len(time))}
    what = rng.choice(["velocity", "both", "position"])
    if what != "position":
        channels["velocity"] = velocity + noise[0] * rng.standard_normal(len(time))
    if what != "velocity":
        step = 2 * np.pi / 2 ** rng.integers(14, 20)
        channels["position"] = np.round(way.position / step) * step
    recording = Recording("closed form", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    return Drawn(way, recording, bool(rng.integers(2)), true, name)


def extra(rng: np.random.Generator, name: str, way: Path, time: Array, size: float) -> Array:
    """Return the torque of a hidden effect, shape (N,)."""
    position, velocity = way.position, way.velocity
    side, run = np.sign(velocity), time / time[-1]
    if name == "stribeck":
        return np.asarray(2 * size * np.exp(-np.abs(velocity) / (rng.uniform(0.03, 0.3) * velocity.std())) * side)
    if name == "cogging":
        return np.asarray(1.4 * size * np.sin(2 * np.pi * rng.uniform(3, 12) * position / np.ptp(position)))
    return np.asarray(
        {
            "asymmetry": size * side * (velocity > 0),
            "torque-offset": size * np.ones(len(time)),
            "gravity": 2 * size * np.sin(position + rng.uniform(0, 6)),
            "stiffness": size * (position - position.mean()) / position.std(),
            "nonlinear-viscous": size * velocity * np.abs(velocity) / velocity.var(),
            "drift": -size * side * run,
            "step-change": size * side * (run > rng.uniform(0.3, 0.7)),
        }[name]
    )


def intervals(seeds: range) -> None:
    """Print how far parameters are from the truth, in standard errors."""
    errors = []
    for seed in seeds:
        case = drawn(seed)
        try:
            found = compare(case.recording, "coulomb-viscous", case.true["J"] if case.inertia_given else None).estimate
        except FricmodelsError as error:
            print(f"{seed}: {case.text}: {error}", flush=True)
            continue
        own = {key: (found.parameters[key] - true) / found.standard_errors[key]
               for key, true in case.true.items() if found.standard_errors.get(key)}  # fmt: skip
        errors += own.values()
        if max(map(abs, own.values()), default=0.0) > FAR:
            print(f"{seed}: {case.text}: " + ", ".join(f"{key} {z:+.1f}" for key, z in own.items()), flush=True)
    z = np.array(errors)
    print(f"{len(seeds)} recordings, {len(z)} intervals: {100 * np.mean(np.abs(z) < SIDE):.1f} % hold the truth, RMS "
          f"of (error / standard error) {np.sqrt(np.mean(z**2)):.2f}, largest {np.max(np.abs(z)):.1f}")  # fmt: skip


def names(seeds: range, hide: bool) -> None:
    """Print what is called missing, and how often that is right."""
    counts: Counter[str] = Counter()
    for seed in seeds:
        case = drawn(seed, hide)
        try:
            compared = compare(case.recording, "coulomb-viscous", case.true["J"] if case.inertia_given else None)
            found = examine(compared)
        except FricmodelsError as error:
            print(f"{seed}: {case.text}: {error}", flush=True)
            continue
        named = [finding.names for finding in found.findings]
        right = bool(named) and case.hidden in named[0] if hide else found.verdict == "adequate"
        counts["right" if right else "a wrong name" if named else found.verdict] += 1
        if not right:
            said = "; ".join(" or ".join(each) for each in named)
            print(f"{seed}: {case.text}: {found.verdict} {said} (test error {compared.errors.held_out_percent:.3g} %, "
                  f"noise {compared.noise_floor_percent:.3g} %)", flush=True)  # fmt: skip
    print(f"{sum(counts.values())} recordings: " + ", ".join(f"{n} {what}" for what, n in counts.most_common()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["intervals", "nulls", "singles"])
    parser.add_argument("--count", type=int)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    args = parser.parse_args()
    count = args.count or {"intervals": 300, "nulls": 100, "singles": 80}[args.what]
    seeds = range(args.first, args.first + count)
    if args.what == "intervals":
        intervals(seeds)
    else:
        names(seeds, args.what == "singles")


if __name__ == "__main__":
    main()
