"""Draws recordings whose hidden effects matter: to the drive, and to a model to which the true effect is added."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from fricmodels import plugins
from fricmodels.diagnosis import Comparison, compare_model, kept_back, ready
from fricmodels.diagnosis import comparison as comparisons
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig, random_rig
from fricmodels.rig.effects import HIDDEN

MATTERS = 0.9
"""Held-out error without the effect in the drive over that with it; at or below this the effect matters to the drive.
And held-out error with the effect in the model over that without it."""
LARGER = (1.0, 1.7, 1.7, 1.7)
"""Steps by which a size is raised until the effect matters."""
DRAWS = 4

EFFECTS = tuple(name for name in plugins.load().effects if name in HIDDEN)
"""The registered effects that a rig can hide."""


@dataclass(frozen=True)
class Case:
    """A rig, its recording, the base law fitted to it, and what the base law leaves without the effects.

    Attributes:
        true: the base law with the true effect, fitted, where the size was chosen by it.
        unmet: kinds of motion that were given up because no size mattered.
        too_small: smaller sizes that matter to the drive, but adding the true effect does not lower the error enough.
    """

    rig: Rig
    recording: Recording
    comparison: Comparison
    clean_error: float
    true: Comparison | None = None
    unmet: tuple[str, ...] = ()
    too_small: tuple[Case, ...] = ()

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
    """Return the held-out RMS torque error [N m or N] over the window that the noise asks for."""
    return comparison.sliding.held_out_percent / 100 * rms(comparison.test.torque)


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


def with_effect(
    comparison: Comparison, effect: str, parameters: Mapping[str, float] | None = None
) -> Comparison | None:
    """Fit the model with one effect more, from the survey's estimate of it if no other is given."""
    if parameters is None:
        result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=[effect])
        parameters = result.tested[0].parameters if result.tested else {}
    try:
        return comparisons.with_effect(comparison, plugins.load().effects[effect](), parameters)
    except FricmodelsError:
        return None


def mattering(rng: np.random.Generator, effect: str) -> Case | None:
    """Draw until an effect matters. A size that is too small is raised a few times, then another rig is drawn."""
    unmet: list[str] = []
    too_small: list[Case] = []
    for _ in range(DRAWS):
        rig = random_rig(rng, [effect])
        for trial in grown(rig):
            if trial.true is not None:
                return replace(trial, unmet=tuple(unmet), too_small=tuple(too_small))
            too_small.append(trial)
        unmet.append(rig.excitation.kind)
    return None


def grown(rig: Rig, *, both_ways: bool = True) -> Iterator[Case]:
    """Yield a rig with one effect at rising sizes from the first that matters to the drive, until adding it helps.

    The last has a model with the true effect, ``true``, with which the held-out error is a tenth lower, unless there is
    no such size.
    """
    clean_error: float | None = None
    factor = 1.0
    for step in LARGER:
        factor *= step
        try:
            trial = case(rig.with_strength(factor) if factor != 1.0 else rig, clean_error)
        except (FricmodelsError, ValueError):  # a share beyond its range, a drive that is stuck or runs away
            continue
        clean_error = trial.clean_error
        if not slides(trial.recording, both_ways=both_ways):
            return
        if trial.ratio > MATTERS:
            continue
        true = with_effect(trial.comparison, rig.effects[0].name)
        if true is not None and held_out(true) <= MATTERS * trial.error:
            yield replace(trial, true=true)
            return
        yield trial


def helping(rig: Rig) -> Case | None:
    """Return the rig with one effect at the smallest size at which it matters and adding it helps, or ``None``."""
    return next((trial for trial in grown(rig) if trial.true is not None), None)
