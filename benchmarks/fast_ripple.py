"""Waves over position that pass within a few samples: how often the diagnosis names them, how large, at what cost.

Drives of the rig, logged at 100 Hz: Coulomb and viscous friction, and a wave of 5 % of the friction torque that passes
within 3 to 20 samples half of the time, alone, with a second harmonic twice as large, or in proportion to friction.
And as many drives without a wave, with encoders down to 12 bits. ``python benchmarks/fast_ripple.py`` prints the table
of docs/decisions/fast-ripple.md.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmodels.diagnosis import Diagnosis, compare, diagnose
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.power import visibility
from fricmodels.diagnosis.ripple import fast_ripple
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.rig import Rig

RATE, COULOMB, SHARE = 100.0, 10.0, 0.05
KINDS = {
    "cogging": ("cogging", {1.0: 1.0}),
    "cogging, k and 2k (1 : 2)": ("cogging", {1.0: 0.5, 2.0: 1.0}),
    "position-friction": ("position-friction", {1.0: 1.0}),
}


@dataclass(frozen=True)
class Trial:
    """A recording and its wave.

    Attributes:
        recording: of a drive with it.
        name: of the effect; empty without.
        k: wave number of the first harmonic.
        amplitude: of all harmonics together, root of the sum of squares [N m or N].
    """

    recording: Recording
    name: str
    k: float
    amplitude: float


def trial(kind: str, per_wave: float, seed: int, *, samples: int = 6000) -> Trial:
    """Return a drive drawn at random: its motion, speed, sensors, the wave's phase; ``kind`` empty for none."""
    rng = np.random.default_rng(seed)
    motion = Motion.LINEAR if seed % 2 else Motion.ROTARY
    speed, frequency = rng.uniform(0.7, 1.4), rng.uniform(0.07, 0.2)
    name, harmonics = KINDS[kind] if kind else ("", {})
    fastest = max(harmonics, default=1.0)
    k = 2 * np.pi * RATE / (0.75 * speed * per_wave) / fastest * rng.uniform(0.9, 1.1)
    amplitude = np.sqrt(2.0) * SHARE * (COULOMB + 2.0 * 0.75 * speed)
    rotary = motion is Motion.ROTARY
    size = float(np.sqrt(sum(part**2 for part in harmonics.values()))) or 1.0
    waves = [
        {
            "order" if rotary else "period": m * k if rotary else 2 * np.pi / (m * k),
            "amplitude": amplitude * part / size,
            "phase": float(rng.uniform(0, 6)),
        }
        for m, part in harmonics.items()
    ]
    motion_of = {"kind": "tracking", "velocity": speed, "frequency": frequency, "bandwidth": rng.uniform(1.0, 4.0)}
    rig = Rig.model_validate(
        {
            "motion": motion,
            "inertia": 2.0,
            "friction": {"viscous": 2.0, "coulomb": COULOMB},
            "effects": [{"name": name, "harmonics": waves}] if name else [],
            "excitation": motion_of,
            "sensors": {
                "velocity_noise_percent": float(rng.choice([0.1, 0.5, 1.0])),
                "encoder_step": float(rng.choice([0.0, 2e-5, 1e-4] if name else [0.0, 1e-4, 5e-4, 1.5e-3])),
            },
            "rate": RATE,
            "samples": samples,
            "seed": seed,
        }
    )
    return Trial(rig.simulate(), name, k, amplitude)


@dataclass(frozen=True)
class Outcome:
    """What the diagnosis said.

    Attributes:
        named, right, double: whether any effect was named; the hidden one with its k; it or another with 2k or k/2.
        error: relative error of the amplitude after the fit; not a number where it was not named.
        false: names of other effects.
        seconds: processor time.
    """

    named: bool
    right: bool
    double: bool
    error: float
    false: tuple[str, ...]
    seconds: float


def judged(one: Trial) -> Outcome:
    """Diagnose a trial."""
    start = time.process_time()
    found = diagnose(one.recording, "coulomb-viscous", 2.0)
    seconds = time.process_time() - start
    resolution = 2 * np.pi / float(np.ptp(one.recording["position"]))
    right = double = False
    error = float("nan")
    false = []
    for finding in found.findings:
        k = finding.tested.parameters.get("k", float("nan"))
        if one.name in finding.names and abs(k - one.k) < resolution:
            right, error = True, _amplitude(found, finding.tested.name) / one.amplitude - 1
        elif abs(k - 2 * one.k) < resolution or abs(k - one.k / 2) < resolution:
            double = True
        elif one.name not in finding.names:
            false.append(finding.tested.name)
    return Outcome(bool(found.findings), right, double, error, tuple(false), seconds)


def _amplitude(found: Diagnosis, name: str) -> float:
    """Return the amplitude of both harmonics in the model that was fitted with the effect."""
    finding = next(f for f in found.findings if f.tested.name == name)
    fitted = None if found.refits is None else found.refits.with_effect(finding.tested)
    if fitted is None:
        return float("nan")
    values = fitted.estimate.parameters
    return float(np.sqrt(sum(values[f"{name}.{symbol}"] ** 2 for symbol in ("a", "b", "a_2", "b_2"))))


def table(trials: int, first: int) -> Iterator[str]:
    """Yield the lines of the table."""
    yield "| hidden | samples a wave | right k | k/2 or 2k | amplitude, median (worst) | other names | s, median |"
    yield "|---|---|---|---|---|---|---|"
    for kind in KINDS:
        for per_wave in (3.0, 5.0, 8.0, 20.0):
            done = [judged(trial(kind, per_wave, first + i)) for i in range(trials)]
            errors = np.abs([one.error for one in done if one.right])
            size = f"{100 * np.median(errors):.1f} % ({100 * np.max(errors):.0f} %)" if len(errors) else ""
            others = sum(bool(one.false) for one in done)
            seconds = np.median([one.seconds for one in done])
            yield (
                f"| {kind} | {per_wave:g} | {sum(one.right for one in done)} of {trials} | "
                f"{sum(one.double for one in done)} | {size} | {others} | {seconds:.1f} |"
            )
    clean = [judged(trial("", 5.0, 100 + first + i)) for i in range(4 * trials)]
    names = sum(one.named for one in clean)
    seconds = np.median([one.seconds for one in clean])
    yield f"| nothing | | | | | {names} of {4 * trials} | {seconds:.1f} |"


def cost() -> str:
    """Return what the search for fast waves and the statement of its band add to 20 000 samples, in words."""
    compared = compare(trial("", 5.0, 0, samples=20_000).recording, "coulomb-viscous", 2.0)
    parameters = compared.estimate.parameters
    only = candidate_tests(compared.problem, parameters, only=["cogging"])
    seconds = []
    for _ in range(5):
        start = time.process_time()
        fast_ripple(compared.problem, parameters, (), POLICY)
        middle = time.process_time()
        visibility(only, ())
        seconds.append((middle - start, time.process_time() - middle))
    search, band = np.median(seconds, axis=0)
    return f"20 000 samples without a wave: {search:.3f} s for the search, {band:.3f} s for its band."


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=6, help="drives a row; four times as many without a wave")
    parser.add_argument("--first", type=int, default=0, help="the first random seed")
    given = parser.parse_args()
    for line in table(given.trials, given.first):
        print(line, flush=True)
    print(cost())
