"""A model fitted to a recording: how far off it is, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import rms
from fricmodels.diagnosis.candidate_tests import not_yet
from fricmodels.diagnosis.journal import estimated
from fricmodels.diagnosis.where import Regime, where
from fricmodels.display import Displayed
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.fitted_runs import numbered_as_fitted
from fricmodels.model import Model
from fricmodels.once import once
from fricmodels.processes import give_back
from fricmodels.progress import steps
from fricmodels.recording import Recording, check_recording
from fricmodels.score.bands import Errors, torque_errors
from fricmodels.score.proportional import recorded_inertia
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.score.zeroed import levelled, unknown_runs, zeroed
from fricmodels.signals.coasting import coasting
from fricmodels.signals.lanczos import even_weights, lanczos_value
from fricmodels.signals.switched import torque_noise
from fricmodels.split import Split, split
from fricmodels.term import Effect
from fricmodels.weakform.estimate import Estimate
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.row_noise import velocity_noise_like

_AS_GOOD = 1.01
"""Errors that differ by less than a hundredth are those of one optimum."""


@dataclass(frozen=True)
class SlidingErrors:
    """RMS of :func:`fricmodels.score.filtered_torque_error` over the window of :func:`sliding_half_width`, in %.

    A statistic of the decisions, whose bounds were found with it. The window is long where the noise is large, so that
    little of it is left. It is printed nowhere: what is averaged away depends on the recording.

    Attributes:
        percent, held_out_percent: of the RMS motor torque, on what was fitted and on what was kept back.
        noise_percent, held_out_noise_percent: what sensor noise alone would leave of each. Some noise is larger where
            the drive is fast, and blocks that were kept back may be just there.
    """

    percent: float
    held_out_percent: float
    noise_percent: float
    held_out_noise_percent: float


@dataclass(frozen=True, repr=False)
class Comparison(Displayed):
    """A model fitted to a recording, and where it fails.

    Attributes:
        drive, estimate: the model and its parameters.
        train, test: what was fitted and what was kept back, prepared.
        errors: RMS torque errors in bands.
        sliding: the error that decisions are made by.
        where: shares of the squared error of the headline by regime of motion.
        problem: the rows that it was fitted to.
    """

    drive: Drive
    estimate: Estimate
    train: Recording
    test: Recording
    errors: Errors
    sliding: SlidingErrors
    where: tuple[Regime, ...]
    problem: WeakFormProblem

    @property
    def offsets_of_runs(self) -> int:
        """Number of the runs whose offset is taken from them, for the model was held and not fitted to them."""
        return len(unknown_runs(self.drive, self.train)) if self.drive.model.known.fixed else 0

    @property
    def noise_floor_percent(self) -> float:
        """Test error of the headline that sensor noise alone would leave, in % of the RMS motor torque there."""
        return self.errors.headline.noise_floor_percent

    @property
    def noise_channel(self) -> str:
        """The channel whose noise makes most of that: the torque, or that from which the acceleration is derived."""
        inertia = recorded_inertia(self.drive, self.estimate.parameters)
        of_motion, of_torque = noise_torques(self.train, inertia, sliding_half_width(self.train))
        motion = "position" if "velocity" in self.train.derived else "velocity"
        return "torque" if of_torque >= of_motion else motion


def kept_back(prepared: Recording, how: Split | None = None) -> tuple[Recording, Recording]:
    """Return what is fitted and what is kept back, by the rule of every tournament if no other is asked for.

    See :class:`fricmodels.split.Split`. What remembers does so through both: a block does not begin with a drive that
    was at rest.
    """
    return split(prepared.remembering(), how)


def compare_model(
    train: Recording, test: Recording, drive: Drive, start: Mapping[str, float] | None = None
) -> Comparison:
    """Fit a model and say where it fails.

    Args:
        train, test: prepared; see :func:`ready` and :func:`kept_back`.
        drive: the model, and its inertia or ``None``.
        start: nonlinear parameters to begin from.
    """
    drive = Drive(drive.model.on(train), drive.inertia, drive.motion)
    problem, found = estimated(drive, train, start)
    return _compared(problem, found, train, test)


def refitted(comparison: Comparison, model: Model, start: Mapping[str, float]) -> Comparison:
    """Return another model fitted to the same data, with the same inertia if that is given.

    Args:
        comparison: whose data.
        model: the other model.
        start: nonlinear parameters to begin from, by key.
    """
    drive = comparison.drive
    return compare_model(comparison.train, comparison.test, Drive(model, drive.inertia, drive.motion), start)


def with_effect(comparison: Comparison, effect: Effect, parameters: Mapping[str, float]) -> Comparison:
    """Return the model with one more effect, fitted anew from the effect's parameters by symbol.

    Raises:
        InputError: when the recording moves too little to fit it.
    """
    start = {f"{effect.name}.{symbol}": value for symbol, value in parameters.items()}
    model = comparison.drive.model.plus(effect)
    return refitted(comparison, model, {**comparison.estimate.parameters, **start})


def numbered(comparison: Comparison) -> Comparison:
    """Return the same model with the effects of each kind numbered from the first on, where one was taken away."""
    effects, called = comparison.drive.model.effects, dict[str, Effect]()
    for effect in sorted(effects, key=lambda effect: effect.name):
        there = {other.name for other in called.values()}
        called[effect.name] = next(not_yet([effect.first_of_kind()], there), effect)
    if all(name == effect.name for name, effect in called.items()):
        return comparison
    start = {}
    for key, value in comparison.estimate.parameters.items():
        name, dot, symbol = key.rpartition(".")
        start[f"{called[name].name if dot else ''}{dot}{symbol}"] = value
    model = Model(comparison.drive.model.law, [called[effect.name] for effect in effects])
    return refitted(comparison, model, start)


def from_scratch(comparison: Comparison) -> Comparison:
    """Return the same model fitted without a start, as `compare` and `batch` fit it.

    A search that began elsewhere may end elsewhere in its last digits; one model has one answer. The fit that was given
    stays where the one without a start leaves clearly more.
    """
    if all(p.linear and not p.declared.delay for p in comparison.drive.parameters):
        return comparison  # there is nothing to start from
    try:
        other = compare_model(comparison.train, comparison.test, comparison.drive)
    except InputError:  # a search without a start may end where the drive would not move
        return comparison
    return other if other.sliding.percent <= _AS_GOOD * comparison.sliding.percent else comparison


def compare_fit(
    train: Recording, test: Recording, drive: Drive, parameters: Mapping[str, float], errors: Mapping[str, float]
) -> Comparison:
    """Say where a model fails whose parameters are known already.

    Args:
        train, test: prepared; see :func:`ready` and :func:`kept_back`.
        drive: the model, and its inertia or ``None``.
        parameters, errors: value of every parameter by key, the inertia among them, and standard errors.

    Raises:
        InputError: when a parameter of the model has no value.
    """
    if not drive.model.known.fixed:  # one that is held stays as it was fitted, whatever the runs here
        drive = Drive(drive.model.on(train), drive.inertia, drive.motion)
    for p in drive.parameters:
        if p.key not in parameters:
            raise InputError(f"there is no value for '{p.key}' of '{drive.model.name}'; fit it again with this version")
    problem = WeakFormProblem.of(drive, train, parameters)
    return _compared(replace(problem, estimated=dict(parameters)), Estimate(parameters, errors), train, test)


def _compared(problem: WeakFormProblem, found: Estimate, train: Recording, test: Recording) -> Comparison:
    drive = problem.drive
    fitted, scored = (zeroed(drive, found.parameters, part) for part in (train, test))
    errors, error = torque_errors(drive, found.parameters, fitted, scored)
    rows = tuple(where(error, train))
    sliding = _sliding(drive, found.parameters, train, scored)
    give_back(len(train) + len(test))
    return Comparison(drive, found, train, test, errors, sliding, rows, problem)


def _sliding(drive: Drive, values: Mapping[str, float], train: Recording, test: Recording) -> SlidingErrors:
    half_width, inertia = sliding_half_width(train), recorded_inertia(drive, values)

    def percent(torque: float, part: Recording) -> float:
        return 100 * torque / part.rms_torque

    def error(part: Recording) -> float:
        left = filtered_torque_error(drive, values, part, half_width)
        return percent(rms(left), part)

    def noise(part: Recording) -> float:
        return percent(float(np.hypot(*noise_torques(part, inertia, half_width))), part)

    return SlidingErrors(error(train), error(test), noise(train), noise(test))


def noise_torques(recording: Recording, inertia: float, half_width: int, draw: int = 0) -> tuple[float, float]:
    """Return the RMS torques [N m or N] that noise of the velocity and of the torque alone leaves in filtered signals.

    Args:
        recording: prepared.
        inertia: see :func:`fricmodels.score.proportional.recorded_inertia`.
        half_width: of the filter, in samples.
        draw: seed of the noise of the velocity, which is drawn.
    """
    rate, torque = _filtered_noise(recording, half_width, draw)
    return inertia * rate, torque


@once
def _filtered_noise(recording: Recording, half_width: int, draw: int) -> tuple[float, float]:
    """Return the noise of the acceleration and of the torque that is left in filtered signals."""
    like = velocity_noise_like(recording, np.random.default_rng(draw))
    rate = float(np.std(lanczos_value(recording.time, like, half_width, recording.run, order=1)))
    return rate, torque_noise(recording).after(even_weights(half_width)[0])


_PARTS = 3
"""Of a comparison: the recording is prepared, the model fitted, its errors judged."""


def compare(
    recording: Recording, model: Model | str, inertia: float | None = None, *, how: Split | None = None
) -> Comparison:
    """Fit a model to seven tenths of a recording and say where it fails.

    Args:
        recording: as read.
        model: law plus effects, or its name such as ``coulomb-viscous+cogging``; a fit begins from what it knows of its
            parameters, and is none where that is fixed, see :class:`fricmodels.model.Known`.
        inertia: J [kg m²] or M [kg]; estimated if not given.
        how: what is kept back; blocks or runs spread over the record if not given.

    Raises:
        InputError: for an unknown model, or a recording that lacks what it needs or does not move enough.
    """
    check_recording(recording)
    drive = Drive(Model.of(model), inertia, recording.motion)
    known = drive.model.known
    with steps(f"fitting {drive.model.name}", _PARTS) as done:
        known_inertia = known.values.get(drive.inertia_key) if known.fixed and inertia is None else inertia
        prepared = ready(coasting(recording, known_inertia))
        if known.fixed:
            values = {**known.values, **({} if inertia is None else {drive.inertia_key: inertia})}
            prepared = levelled(drive, values, numbered_as_fitted(prepared, drive.model))
        train, test = kept_back(prepared, how)
        done()
        if known.fixed:
            return compare_fit(train, test, drive, values, known.standard_errors)
        drive = Drive(drive.model.on(train), drive.inertia, drive.motion)
        problem, found = estimated(drive, train, known.values)
        done()
        return _compared(problem, found, train, test)
