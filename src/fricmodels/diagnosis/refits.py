"""A model fitted again with one effect more, once for each effect: what says whether the test error falls with it."""

from __future__ import annotations

from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.comparison import Comparison, with_effect
from fricmodels.diagnosis.passive import driving_share, own_torque
from fricmodels.diagnosis.policy import Policy
from fricmodels.errors import FricmodelsError
from fricmodels.progress import stage
from fricmodels.results.words import NORMAL_95
from fricmodels.split import WHOLE_RUNS
from fricmodels.term import Effect
from fricmodels.weakform.candidate import within_recording
from fricmodels.weakform.search import is_at_end
from fricmodels.weakform.shifted import FREE_SHIFT

_CLOSE = 1e-6
"""Relative distance within which a value is a bound itself."""
Key = tuple[str, tuple[float, ...]]


class Refits:
    """Fits of a model with one effect more.

    Args:
        comparison: the model without it.
        policy: the constants that decide.
    """

    def __init__(self, comparison: Comparison, policy: Policy) -> None:
        self.comparison, self.policy = comparison, policy
        self._found: dict[Key, Comparison | None] = {}
        self._beside: dict[Key, Refits] = {}

    def with_effect(self, tested: CandidateTest) -> Comparison | None:
        """Return the model with an effect, fitted from the estimate of it.

        ``None`` where that fails, or where the effect comes out as nothing, as a slow change that is over at once, or
        as a delay that the free shift of the rows is as well, unless the error falls far: a smaller error is then not
        its doing. Nor is a friction that drives what it says it is, and of one of whose torques none is determined the
        form is not known, but for constants of runs that are kept back; nor of one so large that only another cancels
        it. And a model that has more in it does not leave far more of what it was fitted to: what acts in samples that
        no row has is not known there.
        """
        key = _key(tested)
        if key not in self._found:
            stage(f"fitting {self.comparison.drive.model.name}+{tested.name}")
            try:
                fitted = with_effect(self.comparison, tested.effect, tested.parameters)
            except FricmodelsError:
                self._found[key] = None
            else:
                own = next(e for e in fitted.drive.model.effects if e.name == tested.name)  # as it is beside others
                useless = (
                    (is_undetermined(fitted, own.name) and not self._is_of_kept_back_runs(fitted, own))
                    or _is_over_at_once(fitted, own)
                    or self._is_within_free_shift(fitted, own)
                    or self._fits_far_worse(fitted)
                )
                self._found[key] = None if useless or self._is_unphysical(fitted, own) else fitted
        return self._found[key]

    def beside(self, tested: CandidateTest) -> Refits | None:
        """Return the fits of the model that has this effect already; ``None`` where it cannot be fitted."""
        model, key = self.with_effect(tested), _key(tested)
        if model is not None and key not in self._beside:
            self._beside[key] = Refits(model, self.policy)
        return self._beside.get(key)

    def ends_at_bound(self, tested: CandidateTest) -> bool:
        """Whether the fit took a size of an effect with memory as far as this recording can tell."""
        fitted = self.with_effect(tested)
        if fitted is None or not tested.effect.states:
            return False
        found = fitted.estimate.parameters
        sizes = [within_recording(fitted.problem, p) for p in tested.effect.parameters if p.scan]
        return any(is_at_end(p, found[f"{tested.name}.{p.symbol}"]) for p in sizes)

    def _is_unphysical(self, fitted: Comparison, effect: Effect) -> bool:
        """Whether an effect that is a part of the friction makes of it one that drives, or is too large to be there."""
        drives = effect.friction and driving_share(fitted, self.policy.significance) > self.policy.driving_friction
        return drives or own_torque(fitted, effect) > self.policy.own_torque

    def _is_of_kept_back_runs(self, fitted: Comparison, effect: Effect) -> bool:
        """Whether an effect of each run is one of runs that are kept back whole: no run that is fitted tells of it."""
        if effect.fitted_runs is None or not fitted.test.provenance.get(WHOLE_RUNS):
            return False
        return fitted.errors.held_out_percent <= self.policy.refit_share * self.comparison.errors.held_out_percent

    def _fits_far_worse(self, fitted: Comparison) -> bool:
        """Whether far more is left of what was fitted than without the effect, by the printed error."""
        return fitted.errors.percent**2 > self.policy.fits_worse * self.comparison.errors.percent**2

    def _is_within_free_shift(self, fitted: Comparison, effect: Effect) -> bool:
        """Whether a fit made of a delay one that every row may have by itself, and the test error does not fall far.

        It was found beside a free shift of that size: it is more than that, or the error must say that it is there.
        """
        values, most = fitted.estimate.parameters, FREE_SHIFT * fitted.train.interval
        within = any(abs(values[f"{effect.name}.{p.symbol}"]) <= most for p in effect.parameters if p.delay)
        before, after = (c.errors.held_out_percent for c in (self.comparison, fitted))
        return within and after > self.policy.refit_share * before

    def test_error(self, tested: CandidateTest) -> float:
        """Return the test error of the decisions with an effect [%]; infinite where it cannot be fitted."""
        fitted = self.with_effect(tested)
        return float("inf") if fitted is None else fitted.sliding.held_out_percent

    def leaves_as_much(self, tested: CandidateTest, least: float) -> bool:
        """Whether a model with an effect leaves no more than a look-alike may of a test error [%], or of its noise."""
        most = self.policy.far_worse * max(least, self.comparison.sliding.held_out_noise_percent)
        return self.test_error(tested) <= most

    def fit_error(self, tested: CandidateTest) -> float:
        """Return the fit error of the decisions with an effect [%]; infinite where it cannot be fitted."""
        fitted = self.with_effect(tested)
        return float("inf") if fitted is None else fitted.sliding.percent

    def lowers_test_error(self, tested: CandidateTest) -> bool:
        """Whether the test error falls with an effect, see :func:`falls_from`."""
        other = self.with_effect(tested)
        return other is not None and falls_from(self.comparison, other, self.policy)

    def lowers_error_within(self, tested: CandidateTest, window_ms: float) -> bool:
        """Whether the test error of single samples falls with an effect, or that of a window no wider than some time.

        What alternates faster is averaged away in a wider one.
        """
        other = self.with_effect(tested)
        if other is None:
            return False
        pairs = zip(_within(other, window_ms), _within(self.comparison, window_ms), strict=True)
        return any(after < before for after, before in pairs)

    def is_better_within(self, tested: CandidateTest, other: CandidateTest, window_ms: float) -> bool:
        """Whether with an effect these test errors are lower than with another one by the margin of an exchange.

        With a simpler effect they may be higher by that margin: two harmonics more always gain a little.
        """
        one, two = self.with_effect(tested), self.with_effect(other)
        if one is None or two is None:
            return one is not None
        simpler = len(tested.effect.parameters) < len(other.effect.parameters)
        most = 1.0 + (self.policy.exchange_margin if simpler else -self.policy.exchange_margin)
        return all(a <= most * b for a, b in zip(_within(one, window_ms), _within(two, window_ms), strict=True))


def _within(comparison: Comparison, window_ms: float) -> list[float]:
    """Return the test errors of the windows that are no wider than some time, of single samples at least [%]."""
    bands = comparison.errors.bands
    return [band.held_out_percent for band in bands if band.window_ms <= window_ms or band is bands[0]]


def falls_from(here: Comparison, other: Comparison, policy: Policy) -> bool:
    """Whether the test error falls from a model to another: that of the decisions, and that of some printed window.

    The printed one must fall by ``least_gain`` of its square: what cannot be seen to fall is not said to. What rings
    fast shows in single samples, what is slow in wide windows, and an impact, which no difference of velocities tells,
    in the balance of momentum only. Where the error of the decisions rises, the printed one must fall
    far, and by as much more. What falls below noise counts for nothing there: an effect that takes away a part of the
    inertia takes away the noise of the acceleration with it.
    """
    if other.sliding.held_out_percent >= here.sliding.held_out_percent:
        noise = policy.noise_known_to * here.errors.headline.noise_floor_percent
        both = [c.sliding.held_out_percent * max(c.errors.held_out_percent, noise) for c in (here, other)]
        return both[1] <= policy.refit_share * both[0]
    pairs = zip(other.errors.bands, here.errors.bands, strict=True)
    left = 1.0 - policy.least_gain
    return any(after.held_out_percent**2 <= left * before.held_out_percent**2 for after, before in pairs)


def is_void(fitted: Comparison, name: str) -> bool:
    """Whether an effect of a fitted model is none: all coefficients that it is linear in are zero, or it takes away all
    of the drive's inertia that it may.

    What only accompanies its torques is not the effect. Under one sine a spring and an inertia are the same, and with
    both in a model one may cancel the other, down to a bound.
    """
    values, inertia = fitted.estimate.parameters, fitted.drive.inertia
    own = [values[key] for key in _linear_in(fitted, name)]
    bounded = [p for p in fitted.drive.model.parameters if p.declared.less_of_drive and p.key.startswith(f"{name}.")]
    if any(values[p.key] <= -p.declared.less_of_drive * (inertia or float("inf")) * (1.0 - _CLOSE) for p in bounded):
        return True
    return bool(own) and not any(own)


def is_undetermined(fitted: Comparison, name: str) -> bool:
    """Whether an effect has no torque, or several of which the recording determines none: its form is not known then.

    A single one that the rows need is there, though its size may trade with a speed that was sought with it; one that
    is zero at its bound leaves the other a single one. Nor is one unknown of which the recording tells only the sum
    with another one of the effect: with that held at 0 its interval is clear of zero.
    """
    estimate = fitted.estimate
    values, unknown, errors = estimate.parameters, estimate.not_identified, estimate.standard_errors
    none = {p.key for p in fitted.drive.model.linear_parameters if p.declared.lower == values[p.key] == 0.0}
    own = [key for key in _linear_in(fitted, name) if key not in none]

    def may_be_nothing(key: str) -> bool:
        return values[key] == 0.0 or (key in unknown and abs(values[key]) < NORMAL_95 * errors.get(key, float("inf")))

    return is_void(fitted, name) or (len(own) > 1 and all(may_be_nothing(key) for key in own))


def _linear_in(fitted: Comparison, name: str) -> list[str]:
    """Return the keys of the coefficients that an effect of a model is linear in, and that make it what it is."""
    own = [p for p in fitted.drive.model.linear_parameters if p.key.startswith(f"{name}.")]
    return [p.key for p in own if not p.declared.accompanies]


def _is_over_at_once(fitted: Comparison, effect: Effect) -> bool:
    """Whether a fit made of a slow change one that is over sooner than any that is sought."""
    slow = [within_recording(fitted.problem, p) for p in effect.parameters if p.slow]
    return any(fitted.estimate.parameters[f"{effect.name}.{p.symbol}"] < p.lower * (1 - _CLOSE) for p in slow)


def _key(tested: CandidateTest) -> Key:
    return tested.name, (*tested.found.nonlinear, tested.found.delay)
