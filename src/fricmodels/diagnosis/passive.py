"""Whether a fitted friction only ever takes energy from the drive, and whether an effect is larger than the drive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.term import Effect
from fricmodels.weakform.acting import acting
from fricmodels.weakform.problem import WeakFormProblem

_FASTER, _STEPS = 5.0, 201
"""Times the fastest motion up to which the friction is looked at, and in how many steps: a drive is seldom identified
further below its speed."""
_STEP, _SAMPLES = 0.1, 20_000
"""Standard errors over which the friction's slope in a parameter is taken, and about how many samples are looked at."""


def driving_share(comparison: Comparison, significance: float) -> float:
    r"""Return the share of the samples in motion in which a model's friction drives by more than its error.

    The torque τ_F of the law and of the effects that are friction, see :attr:`fricmodels.term.Effect.friction`, takes
    energy, whatever its form: τ_F ω ≥ 0. With the covariance C of the p parameters it drives where

    .. math:: -\tau_F\,\mathrm{sgn}\,\omega > \sqrt{\chi^2_{p,\,1-\alpha}\; g^\top C\,g},
              \qquad g = \partial\tau_F/\partial\theta

    (Scheffé 1953): for all instants at once, so that a true friction is found to drive anywhere with the chance α at
    most. Half the difference of two Coulomb torques that is more than their mean drives the joint one way, as an offset
    or gravity does.

    Args:
        comparison: a fitted model.
        significance: α.
    """
    from scipy.stats import chi2

    drive, recording, problem = comparison.drive, comparison.problem.recording, comparison.problem
    effects = [effect for effect in drive.model.effects if effect.friction]
    friction = Drive(Model(drive.model.law, effects), drive.inertia, drive.motion)
    values, errors = comparison.estimate.parameters, comparison.estimate.standard_errors
    some = slice(None, None, max(1, len(recording) // _SAMPLES))
    side, moving = np.sign(problem.smooth[some]), ~problem.resting[some]

    def at(parameters: Mapping[str, float]) -> Array:
        return np.asarray(friction.friction(recording, parameters, velocity=problem.smooth)[some] * side)

    taken, linear = at(values), {p.key for p in friction.model.linear_parameters}
    nonlinear = {p.key: p.declared for p in friction.model.nonlinear_parameters}
    slopes = np.zeros((len(errors), len(taken)))
    with np.errstate(over="ignore", invalid="ignore"):  # a step may lead to where the friction has no value
        for slope, (key, error) in zip(slopes, errors.items(), strict=True):
            step = _STEP * error
            if key in linear and step > 0.0:
                slope[:] = (at({**values, key: values[key] + step}) - taken) / step
            if key in nonlinear and step > 0.0:
                less, more = _within(nonlinear[key], values[key], step)
                slope[:] = (at({**values, key: more}) - at({**values, key: less})) / (more - less)
    slopes[~np.isfinite(slopes)] = 0.0
    covariance = comparison.estimate.covariance
    if covariance is None:
        covariance = np.diag(np.array(list(errors.values())) ** 2)
    free = int(np.sum(np.any(slopes != 0.0, axis=1)))
    with np.errstate(over="ignore"):  # of a torque whose error has no square nothing is known
        variance = np.maximum(np.sum(slopes * (covariance @ slopes), axis=0), 0.0)
        drives = -taken > np.sqrt(chi2.isf(significance, max(free, 1)) * variance)
    return float(np.mean(drives[moving])) if np.any(moving) else 0.0


def _within(parameter: Parameter, value: float, step: float) -> tuple[float, float]:
    """Return a value less a step, and with a step more; the value itself where that is beyond a physical bound."""
    inside = [value, *(v for v in (value - step, value + step) if parameter.lower < v < parameter.upper)]
    return min(inside), max(inside)


def drives_from(comparison: Comparison) -> float | None:
    """Return the speed [rad/s or m/s] from which a model's friction would drive; ``None`` where it brakes.

    A curve that fits as far as the recording goes may fall beyond it, and no friction falls through zero. Looked at are
    the law and the effects that are functions of the speed alone, in both directions, up to :data:`_FASTER` times the
    fastest motion.
    """
    drive, values = comparison.drive, comparison.estimate.parameters
    terms = [effect for effect in drive.model.effects if effect.friction and of_speed(Model.only(effect))]
    if not of_speed(Model(drive.model.law, ())):
        return None
    friction = Drive(Model(drive.model.law, terms), drive.inertia, drive.motion)
    speeds = comparison.train.peak_speed * np.linspace(1.0, _FASTER, _STEPS)
    none = np.zeros(len(speeds))
    for side in (1.0, -1.0):
        channels = {"time": np.arange(len(speeds), dtype=float), "torque": none, "velocity": side * speeds}
        torque = side * friction.friction(Recording("speeds", drive.motion, channels, none.astype(np.int64)), values)
        if torque[0] > 0.0 and torque.min() < 0.0:
            after = int(np.argmax(torque < 0.0))
            share = torque[after - 1] / (torque[after - 1] - torque[after])
            return float(speeds[after - 1] + share * (speeds[after] - speeds[after - 1]))
    return None


def of_speed(model: Model) -> bool:
    """Whether a model is a function of the speed alone, in both directions."""
    return model.needs <= {"velocity"} and not model.states


def own_torque(comparison: Comparison, effect: Effect) -> float:
    """Return the RMS torque of one effect of a fitted model, over the RMS motor torque, as the rows see both.

    It may be more than 1 where another torque balances it, as a spring balances gravity. Two waves of nearly one wave
    number may have any size with opposite signs: of such the recording tells the sum only. What the law's own terms
    could be as well does not count: a friction that thins with the temperature is a change of theirs from 0 °C on.
    """
    problem, values = comparison.problem, comparison.estimate.parameters
    law = Drive(Model(comparison.drive.model.law, ()), comparison.drive.inertia, comparison.drive.motion)
    torque, (own, _) = _torque(problem, problem.alone(effect), values), _columns(problem, law, values)
    torque = torque - np.linalg.lstsq(own.T, torque, rcond=None)[0] @ own
    return float(np.sqrt(np.sum(torque**2) / np.sum(acting(problem) ** 2)))


def _torque(problem: WeakFormProblem, drive: Drive, values: Mapping[str, float]) -> Array:
    """Return the torque of a part of the model as the rows see it, shape (rows,)."""
    columns, rest = _columns(problem, drive, values)
    return np.asarray(np.array(drive.model.linear_of(values)) @ columns + rest)


def _columns(problem: WeakFormProblem, drive: Drive, values: Mapping[str, float]) -> tuple[Array, Array]:
    return problem.columns(drive, drive.model.nonlinear_of(values))
