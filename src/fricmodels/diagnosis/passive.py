"""Whether a fitted friction only ever takes energy from the drive, and whether an effect is larger than the drive."""

from __future__ import annotations

import numpy as np

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.term import Effect
from fricmodels.weakform.acting import acting


def driving_share(comparison: Comparison) -> float:
    r"""Return the work by which a model's friction drives, as a share of the work that it takes away.

    .. math:: s = \frac{\int \max(-\tau_F\,\omega, 0)\,dt}{\int \max(\tau_F\,\omega, 0)\,dt}

    with the torque τ_F of the law and of the effects that are friction, see :attr:`fricmodels.term.Effect.friction`,
    where the drive moves. It is 0 for a friction, whatever its form: τ_F ω ≥ 0. Half the difference of two Coulomb
    torques that is more than their mean drives the joint one way, as an offset or gravity does.
    """
    drive, recording, problem = comparison.drive, comparison.problem.recording, comparison.problem
    effects = [effect for effect in drive.model.effects if effect.friction]
    friction = Drive(Model(drive.model.law, effects), drive.inertia, drive.motion)
    torque = friction.friction(recording, comparison.estimate.parameters, velocity=problem.smooth)
    power = np.where(problem.resting, 0.0, torque * problem.smooth)
    weight = np.gradient(recording.time)
    driven, taken = float(weight @ np.maximum(-power, 0.0)), float(weight @ np.maximum(power, 0.0))
    return driven / taken if taken > 0.0 else float(np.inf if driven > 0.0 else 0.0)


def own_torque(comparison: Comparison, effect: Effect) -> float:
    """Return the RMS torque of one effect of a fitted model, over the RMS motor torque, as the rows see both.

    It may be more than 1 where another torque balances it, as a spring balances gravity. Two waves of nearly one wave
    number may have any size with opposite signs: of such the recording tells the sum only.
    """
    problem, values = comparison.problem, comparison.estimate.parameters
    alone = problem.alone(effect)
    linear = np.array(alone.model.linear)
    fitted = np.array([values[parameter.key] for parameter in alone.model.parameters])
    columns, rest = problem.columns(alone, fitted[~linear].tolist())
    torque = fitted[linear] @ columns + rest
    return float(np.sqrt(np.sum(torque**2) / np.sum(acting(problem) ** 2)))
