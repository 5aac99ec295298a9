"""Draws recordings whose hidden effects matter, judged without any effect's own expression."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.diagnosis import Comparison, compare_model, kept_back, ready
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig, random_rig

MATTERS = 0.9
"""Held-out error without the effect over that with it; at or below this the effect matters."""
LARGER = (1.0, 1.7, 1.7, 1.7)
"""Steps by which a size is raised until the effect matters."""
DRAWS = 4

EFFECTS = (
    "asymmetry",
    "torque-offset",
    "stribeck",
    "nonlinear-viscous",
    "load-friction",
    "directional-efficiency",
    "torque-gain",
    "inertia-error",
    "gravity",
    "stiffness",
    "cogging",
    "position-friction",
    "torque-ripple",
    "presliding",
    "frictional-lag",
    "rising-stiction",
    "backlash",
    "sensor-delay",
    "thermal",
    "drift",
    "step-change",
    "joint-compliance",
)


@dataclass(frozen=True)
class Case:
    """A rig, its recording, the base law fitted to it, and what the base law leaves without the effects."""

    rig: Rig
    recording: Recording
    comparison: Comparison
    clean_error: float
    tries: int = 1
    unmet: tuple[str, ...] = ()

    @property
    def error(self) -> float:
        """Held-out RMS torque error of the base law [N m or N]."""
        return held_out(self.comparison)

    @property
    def ratio(self) -> float:
        """Held-out error of the base law without the effects over that with them."""
        return self.clean_error / self.error if self.error > 0 else 1.0

    @property
    def size_percent(self) -> float:
        """RMS torque that the effects add to the held-out error, in % of the RMS torque."""
        torque = rms(self.comparison.test.torque)
        return 100 * float(np.sqrt(max(self.error**2 - self.clean_error**2, 0.0))) / torque


def generator(seed: int, *words: object) -> np.random.Generator:
    """Return a generator that depends on the seed and on words, the same on every machine."""
    return np.random.default_rng([seed, *(zlib.crc32(str(word).encode()) for word in words)])


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def held_out(comparison: Comparison) -> float:
    """Return the held-out RMS torque error [N m or N]."""
    return comparison.errors.held_out_percent / 100 * rms(comparison.test.torque)


def blank(rig: Rig) -> Rig:
    """Return the same rig with nothing hidden; a drive that warms still warms, without any consequence."""
    warming = tuple(effect.scaled(0.0) for effect in rig.effects if effect.name == "thermal")
    return rig.model_copy(update={"effects": warming})


def fitted(rig: Rig, recording: Recording, model: str = "") -> Comparison:
    """Fit the rig's own law, or another model, with the inertia that the rig states."""
    train, test = kept_back(ready(recording))
    return compare_model(train, test, Drive(Model.parse(model or rig.friction.law), rig.inertia, recording.motion))


def case(rig: Rig, clean_error: float | None = None) -> Case:
    """Simulate a rig and fit the base law with and without its effects."""
    recording = rig.simulate()
    comparison = fitted(rig, recording)
    if clean_error is None:
        clean = blank(rig)
        clean_error = held_out(fitted(clean, clean.simulate()))
    return Case(rig, recording, comparison, clean_error)


def slides(recording: Recording, *, both_ways: bool) -> bool:
    """Whether the drive slides in both directions, or all the time forward."""
    speed = recording.velocity
    slow = 0.02 * float(np.quantile(np.abs(speed), 0.99))
    if not both_ways:
        return bool(np.mean(speed > slow) > 0.999)
    return bool(min(np.mean(speed > slow), np.mean(speed < -slow)) > 0.1)


def mattering(rng: np.random.Generator, effects: Sequence[str], samples: int = 20_000) -> Case | None:
    """Draw until the effects, together, lower the held-out error by a tenth when they are not there.

    A size that is too small is raised a few times, then another rig is drawn; ``unmet`` lists what was given up.
    """
    unmet: list[str] = []
    tries = 0
    for _ in range(DRAWS):
        rig = random_rig(rng, effects, samples=samples)
        tried = grown(rig)
        tries += len(LARGER)
        if tried is not None:
            return Case(tried.rig, tried.recording, tried.comparison, tried.clean_error, tries, tuple(unmet))
        unmet.append(rig.excitation.kind)
    return None


def grown(rig: Rig, *, both_ways: bool = True) -> Case | None:
    """Return the rig at the smallest of a few sizes at which its effects matter, or ``None``."""
    clean_error: float | None = None
    factor = 1.0
    for step in LARGER:
        factor *= step
        try:
            trial = case(rig.with_strength(factor) if factor != 1.0 else rig, clean_error)
        except (FricmodelsError, ValueError):  # a share beyond its range, or a drive that is stuck
            return None
        clean_error = trial.clean_error
        if not slides(trial.recording, both_ways=both_ways):
            return None
        if trial.ratio <= MATTERS:
            return trial
    return None
