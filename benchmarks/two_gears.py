"""Two waves of one kind over position, as of motor and gear: how often both are named with their wave numbers.

Drives of the rig, logged at 100 Hz: Coulomb and viscous friction, and two waves whose numbers have a ratio drawn
between 1/5 and 5, not near 1/2, 1 or 2 (a second harmonic belongs to a wave). The larger has 5 % of the friction
torque, the smaller 0.4 to 1 of that. ``python benchmarks/two_gears.py`` prints the table of
docs/decisions/fast-ripple.md.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from fricmodels.diagnosis import improve
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.rig import Rig

RATE, COULOMB, SHARE = 100.0, 10.0, 0.05
KINDS = (("cogging", "cogging"), ("position-friction", "position-friction"), ("cogging", "position-friction"))


@dataclass(frozen=True)
class Trial:
    """A recording and its two waves: names of the effects, and their wave numbers."""

    recording: Recording
    names: tuple[str, str]
    numbers: tuple[float, float]


def trial(names: tuple[str, str], seed: int, *, samples: int = 6000) -> Trial:
    """Return a drive drawn at random: its motion, speed, sensors, and both waves."""
    rng = np.random.default_rng(seed)
    rotary = seed % 2 == 0
    speed, frequency = rng.uniform(0.7, 1.4), rng.uniform(0.07, 0.2)
    ratio = 1.0
    while min(abs(ratio / near - 1.0) for near in (0.5, 1.0, 2.0)) < 0.06:
        ratio = float(np.exp(rng.uniform(-np.log(5.0), np.log(5.0))))
    per_wave = float(np.exp(rng.uniform(np.log(5.0), np.log(60.0))))  # samples, of the faster one
    k = 2 * np.pi * RATE / (0.75 * speed * per_wave) / max(1.0, ratio)
    numbers = (k, ratio * k)
    amplitude = np.sqrt(2.0) * SHARE * (COULOMB + 2.0 * 0.75 * speed)
    amplitudes = amplitude, amplitude * rng.uniform(0.4, 1.0)
    effects: dict[str, list[dict[str, float]]] = {}
    for name, number, size in zip(names, numbers, amplitudes, strict=True):
        lead = {"order": number} if rotary else {"period": 2 * np.pi / number}
        effects.setdefault(name, []).append({**lead, "amplitude": size, "phase": float(rng.uniform(0, 6))})
    rig = Rig.model_validate(
        {
            "motion": Motion.ROTARY if rotary else Motion.LINEAR,
            "inertia": 2.0,
            "friction": {"viscous": 2.0, "coulomb": COULOMB},
            "effects": [{"name": name, "harmonics": waves} for name, waves in effects.items()],
            "excitation": {
                "kind": "tracking",
                "velocity": speed,
                "frequency": frequency,
                "bandwidth": rng.uniform(1.0, 4.0),
            },
            "sensors": {
                "velocity_noise_percent": float(rng.choice([0.1, 0.5, 1.0])),
                "encoder_step": float(rng.choice([0.0, 2e-5, 1e-4])),
            },
            "rate": RATE,
            "samples": samples,
            "seed": seed,
        }
    )
    return Trial(rig.simulate(), names, numbers)


@dataclass(frozen=True)
class Outcome:
    """What the ladder ends with.

    Attributes:
        found: how many of the two waves it has, with their kind and number.
        others: effects that are not there.
    """

    found: int
    others: tuple[str, ...]


def judged(one: Trial) -> Outcome:
    """Improve a model of a trial."""
    end = improve(one.recording, "coulomb-viscous", 2.0).rungs[-1].comparison
    resolution = 2 * np.pi / float(np.ptp(one.recording["position"]))
    values, missing, others = end.estimate.parameters, list(zip(one.names, one.numbers, strict=True)), []
    for effect in end.drive.model.effects:
        number = values.get(f"{effect.name}.k", np.inf)
        kind = effect.name.partition("(")[0]
        right = [true for true in missing if true[0] == kind and abs(true[1] - number) < resolution / 2]
        if right:
            missing.remove(right[0])
        else:
            others.append(effect.name)
    return Outcome(2 - len(missing), tuple(others))


def main() -> None:
    """Print a line for each pair of kinds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=20, help="drives of each pair of kinds")
    parser.add_argument("--first", type=int, default=0, help="the first random seed")
    given = parser.parse_args()
    print("| waves | both found | one | none | with an effect that is not there | these |\n|---|---|---|---|---|---|")
    for names in KINDS:
        done = [judged(trial(names, given.first + i)) for i in range(given.trials)]
        counts = [sum(one.found == n for one in done) for n in (2, 1, 0)]
        wrong = sorted(name for one in done for name in one.others)
        print(
            f"| {' + '.join(names)} | {counts[0]} of {len(done)} | {counts[1]} | {counts[2]} | "
            f"{sum(bool(one.others) for one in done)} | {', '.join(wrong)} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
