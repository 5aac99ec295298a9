"""A drive that moves richly under known parameters: are they determined, and does an estimator find them?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import Array
from fricmodels.dimension import INERTIA as INERTIA_DIMENSION
from fricmodels.dimension import VISCOUS, parse_unit
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError, FricmodelsError
from fricmodels.fit import Fit, Status
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.signals import Preparation, prepare
from fricmodels.term import SIGNALS, Effect, Law, Term
from fricmodels.testing.faults import Fault, SkipTest
from fricmodels.testing.rich_motion import rich_motion
from fricmodels.testing.subject import Subject, in_order
from fricmodels.weakform.ranges import scan_size

if TYPE_CHECKING:
    from fricmodels.estimator import Estimator

INERTIA = 0.02
DISPLACEMENT = parse_unit("rad")
_BASE = {"K_v": 0.01, "K_c": 0.08}
_SHARE = 0.25
"""Torque of the term over the RMS motor torque, about."""
_MOST = {INERTIA_DIMENSION: 0.3 * INERTIA}
"""A part of the drive's inertia, as a link behind a spring, cannot be more than the whole."""
_MOST_OF_LAW = {VISCOUS: 0.8 * _BASE["K_v"]}
"""Nor can the viscous friction that lags be more than the law's."""
_WORST_CONDITION = 1e-3
_INSIDE = 0.85
"""Where in the travel a place stands: a share of the samples lies below it."""
_UNBOUNDED = 1e12
"""RMS value that no memory has on a motion of some rad in SI units."""
_STEP = 1e-3
"""Relative step of a sensitivity; an instant or a width must move by more than a sample to be seen."""


@dataclass(frozen=True)
class Case:
    """A model, its true parameters by key, and the recording of its motion."""

    drive: Drive
    truth: Mapping[str, float]
    own: tuple[str, ...]
    recording: Recording


def model_of(cls: type[Term]) -> tuple[Model, dict[str, float], str]:
    """Return the model in which a term is tried, the parameters of the rest of it, and the prefix of its own."""
    term = cls()
    if isinstance(term, Law):
        return Model(term), {}, ""
    if not isinstance(term, Effect):
        raise Fault(f"{cls.__name__} is neither a Law nor an Effect; derive it from one of them")
    return Model(plugins.load().laws["coulomb-viscous"](), [term]), dict(_BASE), f"{term.name}."


_OFF_ZERO = 0.2
"""Where zero is in the middle of a scan, so much of the natural size stands for it."""


def suggested_truth(subject: Subject) -> dict[str, float]:
    """Return values of a term's parameters that matter in the rich motion.

    A nonlinear one is in the middle of its scan, a wave number near its initial value; a linear one makes up for its
    share of the torque over a motion that the term takes no part in, and at its peak not for more than all of it.
    """
    reference = _reference(type(subject.term))
    terms = subject.term.parameters
    linear = dict(zip((p.symbol for p in terms), subject.linear, strict=True))
    values = {p.symbol: _nonlinear_value(p, reference) for p in terms if not linear[p.symbol]}
    values |= {symbol: float(np.quantile(reference["position"], _INSIDE)) for symbol in _places(subject)}
    values = {p.symbol: float(np.clip(values[p.symbol], p.lower, p.upper)) for p in terms if p.symbol in values}
    drive = Drive(subject.model, INERTIA)
    columns, _ = drive.regressors(reference, [values[p.symbol] for p in terms if not linear[p.symbol]])
    sizes = np.sqrt(np.mean(np.square(columns), axis=1))
    torque = reference.rms_torque
    if subject.term.states and not np.all(sizes < _UNBOUNDED):
        names = ", ".join(z.symbol for z in subject.term.states)
        raise Fault(
            f"on a rich motion the memory ({names}) grows without bound: look at the signs in rates(); what is pushed "
            "along decays again, as in dz/dt = (ω − |ω|·z)/x_s"
        )
    most = torque / np.maximum(np.max(np.abs(columns), axis=1), np.finfo(float).tiny)
    solved = [p for p in terms if linear[p.symbol]]
    for i, (p, size) in enumerate(zip(solved, sizes, strict=True)):
        share = _SHARE * (1.0 + 0.3 * (i % 3)) / len(solved) ** 0.5 * torque / (size or 1.0)
        values[p.symbol] = min(share, float(most[i]))
    for p in in_order(terms):
        if p.at_least is not None:
            values[p.symbol] = max(values[p.symbol], 1.6 * values[p.at_least])
        most = min(p.upper, (_MOST | (_MOST_OF_LAW if p.part_of_drive else {})).get(p.dimension, np.inf))
        values[p.symbol] = float(np.clip(values[p.symbol], p.lower, most))
    return {p.symbol: values[p.symbol] for p in terms}


def _places(subject: Subject) -> list[str]:
    """Return the parameters that are a place: moved together with the position they change nothing."""
    import casadi

    e = subject.model.expression()
    if "position" not in e.needs or subject.term.states:
        return []
    given = casadi.vertcat(*e.signals.values(), e.parameters, e.states, e.width)
    rng, found = np.random.default_rng(15), []
    for p, symbol in zip(subject.term.parameters, casadi.vertsplit(e.parameters), strict=True):
        if p.dimension != DISPLACEMENT or p.periodic:
            continue
        slopes = casadi.jacobian(e.torque, casadi.vertcat(e.signals["position"], symbol))
        at = casadi.Function("slopes", [given], [casadi.densify(slopes)])
        pairs = np.array([np.array(at(subject.column(rng))).ravel() for _ in range(8)])
        size = float(np.max(np.abs(pairs)))
        if size > 0 and np.max(np.abs(pairs.sum(axis=1))) <= 1e-9 * size:
            found.append(p.symbol)
    return found


def check_places(subject: Subject) -> None:
    """A parameter that is a point of the travel says so, and is sought there wherever the position has its zero."""
    for symbol in _places(subject):
        p = next(p for p in subject.term.parameters if p.symbol == symbol)
        if not p.place and not p.constant:
            raise Fault(
                f"{symbol} is a place in the travel, not a length: moved together with the position it changes "
                "nothing; declare place=True, with a scan in shares of the travel, scan=(0.1, 0.3, 0.5, 0.7, 0.9), so "
                "that it is found far from zero too"
            )


def _nonlinear_value(p: Parameter, reference: Recording) -> float:
    if p.scan:
        middle = sorted(p.scan)[(len(p.scan) - 1) // 2] * scan_size(reference, p)
        return middle or _OFF_ZERO * scan_size(reference, p)  # of nothing no share can be found again
    return 1.02 * p.initial if p.periodic else p.initial


@lru_cache(maxsize=16)
def _reference(cls: type[Term]) -> Recording:
    """Return the rich motion under Coulomb and viscous friction alone, with every channel."""
    drive = Drive(Model(plugins.load().laws["coulomb-viscous"]()), INERTIA)
    simulated = rich_motion(drive, _BASE, cls(), frozenset(SIGNALS), "rich motion without the term")
    return prepare(simulated, Preparation())


def rich_case(subject: Subject, truth: Mapping[str, float] | None = None) -> Case:
    """Simulate the rich motion of a drive with a term.

    Raises:
        Fault: where a true value is missing or unknown, or the drive cannot be simulated with the term.
    """
    return _rich_case(type(subject.term), tuple(sorted((truth or suggested_truth(subject)).items())))


@lru_cache(maxsize=16)
def _rich_case(cls: type[Term], truth: tuple[tuple[str, float], ...]) -> Case:
    model, values, prefix = model_of(cls)
    values |= {prefix + symbol: value for symbol, value in truth}
    keys = [p.key for p in model.parameters]
    if set(values) != set(keys):
        differs = sorted(set(values) ^ set(keys))
        raise Fault(f"truth does not match the parameters: '{differs[0]}' is missing or unknown")
    drive = Drive(model, INERTIA)
    try:
        recording = rich_motion(drive, values, cls(), model.needs, f"rich motion with {cls.name}")
    except FricmodelsError as error:
        raise Fault(f"the drive cannot be simulated with it: {error}") from None
    if not np.all(np.isfinite(recording.velocity)):
        raise Fault("simulated, the velocity stops being finite; look at signs: friction that pushes runs away")
    return Case(drive, values, tuple(prefix + symbol for symbol, _ in truth), recording)


def ready(case: Case) -> Recording:
    """Return the recording with the acceleration, where the model needs it."""
    return prepare(case.recording, Preparation()) if "acceleration" in case.drive.model.needs else case.recording


def check_identifiable(subject: Subject, truth: Mapping[str, float] | None) -> None:
    """On the rich motion every parameter changes the torque in a way that the others cannot."""
    case = rich_case(subject, truth)
    constant = {p.key for p in case.drive.model.parameters if p.declared.constant}
    keys = [p.key for p in case.drive.model.parameters if p.key not in constant]
    sensitivity = _sensitivity(case, keys)
    size = np.linalg.norm(sensitivity, axis=1)
    for key in [own for own in case.own if own not in constant]:
        if size[keys.index(key)] < 1e-6 * np.linalg.norm(case.recording.torque):
            raise Fault(
                f"{key} does not change the torque at {key} = {case.truth[key]:.3g} on a rich motion; give truth = "
                "{…} with values that matter, or take the parameter out"
            )
    unit = sensitivity / size[:, None]
    _, singular, directions = np.linalg.svd(unit @ unit.T)
    if singular[-1] < _WORST_CONDITION**2:
        weights = np.abs(directions[-1])
        mixed = [keys[i] for i in np.argsort(-weights) if weights[i] > 0.2]
        raise Fault(
            f"{' and '.join(sorted(mixed))} cannot be told apart on a rich motion: a change of one is undone by the "
            "others; keep one of them, or write the torque with their product or sum"
        )


def _sensitivity(case: Case, keys: Sequence[str]) -> Array:
    """Return the change of the torque for a relative change of each parameter, states included, shape (p, N)."""
    recording = ready(case)
    rows = []
    for key in keys:
        value = case.truth[key]
        step = _STEP * (abs(value) or 1.0)
        ends = [case.drive.friction(recording, {**case.truth, key: value + h}) for h in (-step, step)]
        rows.append((ends[1] - ends[0]) / (2 * _STEP))
    return np.array(rows)


def check_recovered(
    subject: Subject, estimator: type[Estimator], truth: Mapping[str, float] | None, tolerance: float
) -> None:
    """An estimator finds the true parameters again.

    Raises:
        SkipTest: where the estimator says that it cannot carry such a model.
    """
    case = rich_case(subject, truth)
    if case.drive.model.states and not estimator.carries_states:
        raise SkipTest(f"'{estimator.name}' does not carry terms with memory")
    try:
        fit = estimator().fit(case.drive, ready(case), seed=0)
    except EstimationError as error:
        raise SkipTest(f"'{estimator.name}': {error}") from None
    _check_fit(case, fit, tolerance)


def _check_fit(case: Case, fit: Fit, tolerance: float) -> None:
    if fit.status is not Status.OK:
        raise Fault(f"'{fit.estimator}' does not find the parameters: {fit.status}: {fit.message}")
    spread = fit.standard_errors
    constant = {p.key for p in case.drive.model.parameters if p.declared.constant}
    held = [key for key in case.own if key not in fit.estimated and key not in constant]
    if held:
        raise SkipTest(f"'{fit.estimator}' does not estimate {', '.join(held)}, but holds it at a value of its scan")
    wrong = []
    for key in case.own:
        true, found = case.truth[key], fit.parameters[key]
        error = spread.get(key, 0.0)
        allowed = tolerance * abs(true) + 4.0 * min(error, tolerance * abs(true))
        if not abs(found - true) <= allowed:
            wrong.append(f"{key} = {found:.4g} ± {error:.1g} for a true {true:.4g}")
    if wrong:
        raise Fault(
            f"'{fit.estimator}' does not find the true parameters: {'; '.join(wrong)}; look at scan (does it reach the "
            "true value?), at bounds, and whether two parameters do the same"
        )
