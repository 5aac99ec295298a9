"""A shift of torque against motion that sampling alone may make, where the printed error falls far without it."""

from __future__ import annotations

from fricmodels.diagnosis.diagnose import Diagnosis
from fricmodels.diagnosis.floor import is_above_noise
from fricmodels.results.diagnosis import Shift


def shift_within_sampling(diagnosis: Diagnosis) -> Shift | None:
    """Return the shift that leaves an adequate model an error far above noise, if it is known that it is there.

    The rows allow one of part of a sample, since a torque that is held makes one by itself: it tells no cause, and is
    not named. Yet the error of single samples has all of it, and falls far with an effect whose parameter is a delay.
    A longer shift than sampling makes is not told here.
    """
    before, policy = diagnosis.comparison, diagnosis.policy
    if diagnosis.verdict != "adequate" or diagnosis.refits is None or diagnosis.result is None:
        return None
    if not is_above_noise(before, policy):
        return None
    for tested in diagnosis.result.tested:
        if not tested.found.delay or max(tested.adjusted, tested.once) >= policy.significance:
            continue
        fitted = diagnosis.refits.with_effect(tested)
        if fitted is None or fitted.errors.held_out_percent > policy.refit_share * before.errors.held_out_percent:
            continue
        symbol = next(p.symbol for p in tested.effect.parameters if p.delay)
        seconds = fitted.estimate.parameters[f"{tested.name}.{symbol}"]
        samples = seconds / before.train.interval
        if abs(samples) <= policy.within_sampling:
            error = fitted.errors.held_out_percent
            return Shift(seconds=seconds, samples=samples, model=fitted.drive.model.name, held_out_percent=error)
    return None
