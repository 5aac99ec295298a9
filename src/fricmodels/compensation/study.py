"""Identifies a simulated drive, compensates its friction by what was found, and compares the tracking errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fricmodels.diagnosis import compare, improve
from fricmodels.errors import FricmodelsError
from fricmodels.progress import Token, Watcher, each, stage, watched
from fricmodels.rig import Rig
from fricmodels.saved import FittedModel, keep
from fricmodels.tracking import Experiment, Figures, Run, Settings

NONE, COULOMB, IMPROVED, TRUE = "none", "coulomb-viscous", "improved", "true"


@dataclass(frozen=True)
class Way:
    """One way of compensating, over all motions.

    Attributes:
        name: :data:`NONE`, :data:`COULOMB`, :data:`IMPROVED`, :data:`TRUE`, or the place of a model file.
        model: name of the model, empty without one.
        figures: of each motion; none where it could not be run.
        message: why not.
    """

    name: str
    model: str
    figures: tuple[Figures, ...]
    message: str = ""

    @property
    def rms_error(self) -> float:
        """RMS of the tracking error over all motions [rad or m]; infinite where it was not run, or ran away."""
        errors = [one.rms_error for one in self.figures]
        value = math.sqrt(np.mean(np.square(errors))) if errors else math.inf
        return value if math.isfinite(value) else math.inf

    @property
    def largest_error(self) -> float:
        """Greatest tracking error [rad or m]."""
        return max((one.largest_error for one in self.figures), default=math.inf)

    @property
    def limit_cycle(self) -> bool:
        """Whether it swings on at rest after any motion."""
        return any(one.limit_cycle for one in self.figures)

    def over(self, other: Way) -> tuple[float, float, float]:
        """Return the RMS error over that of another way: over all motions, in the best and in the worst of them."""
        shares = [a.rms_error / b.rms_error for a, b in zip(self.figures, other.figures, strict=True)]
        if not shares or not all(map(math.isfinite, shares)):
            return math.inf, math.inf, math.inf
        return self.rms_error / other.rms_error, min(shares), max(shares)


@dataclass(frozen=True)
class Study:
    """What compensation is worth on one drive.

    Attributes:
        rig: the drive. experiments: one a motion.
        ways: none, Coulomb and viscous, the improved model (or the models of files), and the truth.
        verdict: of the diagnosis that led to the improved model; empty where models came from files.
        named: effects that the ladder added.
        models: those that were fitted here, by the way that used them.
    """

    rig: Rig
    experiments: tuple[Experiment, ...]
    ways: tuple[Way, ...]
    verdict: str
    named: tuple[str, ...]
    models: dict[str, FittedModel]

    def way(self, name: str) -> Way:
        """Return the way of that name."""
        return next(way for way in self.ways if way.name == name)

    @property
    def best(self) -> Way:
        """The model's way that was improved or given, the last but the truth."""
        return self.ways[-2]


def study(
    rig: Rig,
    settings: Settings | None = None,
    *,
    start: str | None = None,
    given: Sequence[tuple[str, FittedModel]] = (),
    motions: int = 3,
    progress: Watcher | None = None,
    token: Token | None = None,
) -> Study:
    """Compare tracking errors with and without compensation.

    The drive is recorded along its own excitation and identified from that recording alone, with the inertia that it
    states. Then it follows other motions, without compensation, with Coulomb and viscous friction compensated, with the
    model to which the ladder leads, and with what its own equations ask for.

    Args:
        rig: the drive. settings: of controller and motion.
        start: model from which the ladder begins; the law of the rig if not given.
        given: places and models of files, in place of the ladder's.
        motions: number of motions; only the seed tells them apart.
        progress: called with a :class:`~fricmodels.progress.Progress` at every part of the work.
        token: stops it, with :class:`~fricmodels.progress.Cancelled`.

    Raises:
        FricmodelsError: where the drive cannot be simulated, controlled or identified.
    """
    with watched(progress, token):
        return _study(rig, settings or Settings(), start, given, motions)


def _study(
    rig: Rig, settings: Settings, start: str | None, given: Sequence[tuple[str, FittedModel]], motions: int
) -> Study:
    stage("recording")
    recording = rig.simulate()
    experiments = tuple(
        Experiment(rig, settings.model_copy(update={"seed": settings.seed + number})) for number in range(motions)
    )
    stage("fitting Coulomb and viscous friction")
    simple = "asymmetric-coulomb-viscous" if rig.friction.asymmetric else "coulomb-viscous"
    models = {COULOMB: keep(compare(recording, simple, rig.inertia))}
    verdict, named = "", tuple[str, ...]()
    if given:
        models |= dict(given)
    else:
        ladder = improve(recording, start or rig.friction.law, rig.inertia)
        models[IMPROVED] = keep(ladder)
        verdict = ladder.first.verdict
        begun = {effect.name for effect in ladder.rungs[0].comparison.drive.model.effects}
        named = tuple(e.name for e in models[IMPROVED].model.effects if e.name not in begun)
    return Study(rig, experiments, _ways(rig, models, experiments), verdict, named, models)


def _ways(rig: Rig, models: Mapping[str, FittedModel], experiments: Sequence[Experiment]) -> tuple[Way, ...]:
    """Follow every motion in every way: without, with each model, and with what the drive's equations ask for."""
    names = {NONE: "", **{name: model.name for name, model in models.items()}, TRUE: rig.true_model}
    figures: dict[str, list[Figures]] = {name: [] for name in names}
    failed: dict[str, str] = {}
    for name, one in each("following motions", [(name, one) for name in names for one in experiments]):
        if name in failed:
            continue
        try:
            found = one.run_true() if name == TRUE else one.run(None) if name == NONE else run_with(models[name], one)
            figures[name].append(found.figures)
        except FricmodelsError as error:
            if name in (NONE, TRUE):
                raise
            failed[name] = str(error)
    return tuple(
        Way(name, model, () if name in failed else tuple(figures[name]), failed.get(name, ""))
        for name, model in names.items()
    )


def run_with(model: FittedModel, experiment: Experiment) -> Run:
    """Return the run with a fitted model's compensation."""
    return experiment.run(experiment.compensator(model.drive, model.parameters, model.document.rest_width))
