"""How long a diagnosis takes, and how much memory: many samples with nothing, a listed or an unlisted effect.

A drive under three sines at 1 kHz, whose velocity, position and torque are measured with noise. Each recording is
diagnosed in a process of its own; of short ones the least of three diagnoses counts, as the first one compiles.

    python benchmarks/diagnosis_time.py [--samples 20000 2000000] [--hidden nothing listed unlisted]
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time

import numpy as np

from fricmodels.diagnosis import diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

INERTIA, VISCOUS, COULOMB, INTERVAL = 0.05, 0.1, 0.6, 1e-3
HIDDEN = ("nothing", "listed", "unlisted")
LONG = 100_000
"""Samples from which on one diagnosis is enough."""


def recorded(samples: int, hidden: str) -> Recording:
    """Return the recording: a Stribeck friction is listed, a torque of |acceleration| is not."""
    rng, time_of = np.random.default_rng(0), INTERVAL * np.arange(samples)
    turns, sizes = 2 * np.pi * np.array([0.31, 0.83, 1.7]), np.array([3.0, 2.0, 1.0])
    angle = np.outer(time_of, turns) + rng.uniform(0.0, 6.0, 3)
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / turns)
    slope = np.cos(angle) @ (sizes * turns)
    torque = INERTIA * slope + VISCOUS * velocity + COULOMB * np.sign(velocity) + 0.01 * rng.standard_normal(samples)
    if hidden == "listed":
        torque += 0.25 * np.exp(-np.abs(velocity) / 0.1) * np.sign(velocity)
    if hidden == "unlisted":
        torque += 0.08 * np.abs(slope) / np.std(slope)
    channels = {
        "time": time_of,
        "velocity": velocity + 0.003 * rng.standard_normal(samples),
        "position": position + 1e-5 * rng.standard_normal(samples),
        "torque": torque,
    }
    return Recording("long", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))


def measure(samples: int, hidden: str) -> str:
    """Return one line: what was found, and what it took."""
    taken = []
    for _ in range(1 if samples >= LONG else 3):
        recording = recorded(samples, hidden)  # a new one, of which nothing is remembered
        begun = time.process_time()
        diagnosis = diagnose(recording, "coulomb-viscous", INERTIA)
        taken.append(time.process_time() - begun)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    names = [list(finding.names) for finding in diagnosis.findings]
    return f"{samples:>9} {hidden:<9} {diagnosis.verdict} {names}: {min(taken):.2f} s of CPU, {peak:.2f} GB at most"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--samples", type=int, nargs="+", default=[20_000, 2_000_000])
    parser.add_argument("--hidden", choices=HIDDEN, nargs="+", default=[*HIDDEN])
    parser.add_argument("--here", action="store_true", help="in this process")
    given = parser.parse_args()
    for samples in given.samples:
        for hidden in given.hidden:
            if given.here:
                print(measure(samples, hidden), flush=True)
            else:
                again = [sys.executable, __file__, "--here", "--samples", str(samples), "--hidden", hidden]
                subprocess.run(again, check=True)


if __name__ == "__main__":
    main()
