"""A shift of torque against motion that sampling alone may make, where the printed error falls without it."""

from __future__ import annotations

from fricmodels.diagnosis.comparison import with_effect
from fricmodels.diagnosis.diagnose import Diagnosis
from fricmodels.diagnosis.floor import is_above_noise, is_noticed
from fricmodels.errors import FricmodelsError
from fricmodels.once import once
from fricmodels.results.diagnosis import Shift


@once
def shift_within_sampling(diagnosis: Diagnosis) -> Shift | None:
    """Return the shift that leaves an adequate model an error above noise, if it is known that it is there.

    The rows allow one of part of a sample, since a torque that is held makes one by itself: it tells no cause, and is
    not named. Yet the error of single samples has all of it, and falls with an effect whose parameter is a delay. It
    is known where the fit saw it, or where the test of such an effect passes. A longer shift than sampling makes is
    not told here.
    """
    before, policy = diagnosis.comparison, diagnosis.policy
    if diagnosis.verdict != "adequate" or diagnosis.result is None:
        return None
    error = before.errors.held_out_percent
    far = is_above_noise(before, policy)
    if not far and not (before.estimate.shift and is_noticed(before, error, policy)):
        return None
    for tested in diagnosis.result.tested:
        symbol = next((p.symbol for p in tested.effect.parameters if p.delay), None)
        passes = tested.found.delay and max(tested.adjusted, tested.once) < policy.significance
        if symbol is None or not (passes or before.estimate.shift):
            continue
        start = tested.parameters if passes else {symbol: before.estimate.shift}
        try:
            fitted = with_effect(before, tested.effect, start)
        except FricmodelsError:
            continue
        left = fitted.errors.held_out_percent
        seconds = fitted.estimate.parameters[f"{tested.name}.{symbol}"]
        samples = seconds / before.train.interval
        if left <= policy.refit_share * error and abs(samples) <= policy.within_sampling:
            return Shift(seconds=seconds, samples=samples, model=fitted.drive.model.name, held_out_percent=left)
    return None
