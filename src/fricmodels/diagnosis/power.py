"""What a recording could have shown: the smallest effect that would have been found, or what is missing for it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import rms
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.floor import above_noise
from fricmodels.signals.order_spectrum import LEAST_PERIODS
from fricmodels.weakform.acting import acting
from fricmodels.weakform.lines import Whitened, fast_band, smallest_line
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import LEAST_P
from fricmodels.weakform.search import fastest_in_rows
from fricmodels.weakform.steps import Steps

_TOO_LITTLE = "only more than all of the motor torque would stand out; to see it, record longer, with less noise, and "
_HIDDEN = "it acts where the direction of motion is not certain; to see it, record "


@dataclass(frozen=True)
class Visibility:
    """Whether an effect that was not found would have been seen.

    Attributes:
        smallest_percent: RMS torque of the smallest such effect that would have been found, in % of the RMS motor
            torque; not a number where the recording cannot show the effect at all.
        smallest_torque: the same in N m or N.
        missing: what the recording lacks; empty where the effect could have been seen.
        band: least and greatest wave number [1/rad or 1/m] of a wave of which this is true; ``None`` of other effects.
    """

    smallest_percent: float
    smallest_torque: float
    missing: str
    band: tuple[float, float] | None = None


def visibility(result: CandidateTests, found: Iterable[str]) -> dict[str, Visibility]:
    """Return, for every effect that was not found, what the recording could have shown of it."""
    effects = plugins.load().effects
    names = set(found)
    rows: dict[str, Visibility] = {}
    fast = _smallest_fast_wave(result)
    for tested in result.tested:
        if tested.name not in names:
            rows[tested.name] = _over_band(result, tested, _smallest(result, tested), fast)
    for name, reason in result.untested.items():
        needed = effects[name].needs_motion
        text = reason + (f"; to see it, record {needed}" if needed else "")
        rows[name] = Visibility(float("nan"), float("nan"), text)
    return dict(sorted(rows.items()))


def _smallest(result: CandidateTests, tested: CandidateTest) -> Visibility:
    """Return the RMS torque at which both gates would be passed in half of all recordings like this one.

    First gate: the Wald statistic reaches its critical value. Second gate: the residual, but for what noise leaves of
    it, falls by the least gain g: an effect takes √(1/(1 − g)² − 1) times as much torque for it as is left without it.
    """
    problem, regression, policy = result.problem, result.regression, result.policy
    reference = rms(acting(problem))
    residual = float(np.sqrt(above_noise(problem, float(np.sum(regression.residual**2)), policy) / problem.rows))
    columns = tested.found.columns
    gain_needed = residual * float(np.sqrt(max(1 / (1 - policy.least_gain) ** 2 - 1, 0.0)))
    if not len(columns):
        needed = gain_needed
    else:
        q = len(columns)
        freedom = max(regression.terms_once - q + 1, 1)
        level = policy.significance / (tested.found.trials * max(len(result.tested), 1))
        critical = critical_f(max(level, LEAST_P), q, freedom) * regression.terms_once * q / freedom
        free = regression.project_out(columns)
        # A coefficient vector of Wald statistic equal to the critical one, along its least certain direction.
        spread, directions = np.linalg.eigh(tested.evidence.covariance)
        theta = directions[:, -1] * np.sqrt(critical * max(spread[-1], 0.0))
        needed = max(gain_needed, rms(theta @ free))
    beyond = _beyond_rows(problem, tested)
    share = beyond * max(needed / reference, policy.least_torque) if reference > 0 else float("nan")
    if share > 1.0:  # more than all of the torque
        why = _HIDDEN if beyond > 1.0 else _TOO_LITTLE
        return Visibility(float("nan"), float("nan"), why + tested.effect.needs_motion)
    torque = share * problem.recording.rms_torque
    return Visibility(100 * share, torque, "")


def _beyond_rows(problem: WeakFormProblem, tested: CandidateTest) -> float:
    """Return the RMS torque of an effect over all motion, in units of that in the rows whose direction is certain.

    Friction that falls with speed does nearly all that it does about standstill, where there are no rows: as much of it
    as they would show is far more of the whole. Of several columns that counts of which the rows see least.
    """
    every = problem.including_uncertain_motion
    if every.rows == problem.rows or not problem.rows:
        return 1.0
    alone, found = problem.alone(tested.effect), tested.found
    whole, seen = (np.mean(of.columns(alone, found.nonlinear, found.delay)[0] ** 2, axis=1) for of in (every, problem))
    acts = whole > 0.0
    if not np.any(acts):
        return 1.0
    ratio = np.divide(whole[acts], seen[acts], out=np.full(int(acts.sum()), np.inf), where=seen[acts] > 0.0)
    return max(1.0, float(np.sqrt(ratio.max())))


def critical_f(level: float, q: int, n: int) -> float:
    """Return the value that an F of q and n degrees of freedom exceeds at a level; n / (n + q F) is a beta variable."""
    from scipy.special import betaincinv  # scipy.stats takes longer to import than most fits

    return (1.0 / float(betaincinv(0.5 * n, 0.5 * q, level)) - 1.0) * n / q


def _over_band(
    result: CandidateTests, tested: CandidateTest, found: Visibility, fast: tuple[float, tuple[float, float]] | None
) -> Visibility:
    """Return the smallest wave of an effect that would have been found wherever in the band of its wave numbers.

    The rows show slow waves, the samples fast ones; the greater of the two sizes holds for all. No wave is seen of
    which less than one period was passed, or of which the samples are half a wave apart.
    """
    periodic = [p for p in tested.effect.parameters if p.periodic]
    if not periodic or found.missing:
        return found
    position = result.problem.recording["position"]
    slowest = max(periodic[0].lower, 2 * np.pi * LEAST_PERIODS / float(np.ptp(position)))
    fastest = fastest_in_rows(result.problem) or slowest
    if fast is None:
        return replace(found, band=(slowest, max(fastest, slowest)))
    torque, (low, high) = fast
    band = (slowest, high) if fastest >= low else (slowest, fastest)
    if fastest < low or torque <= found.smallest_torque:
        return replace(found, band=band)
    return replace(
        found,
        smallest_percent=100 * torque / result.problem.recording.rms_torque,
        smallest_torque=torque,
        band=band,
    )


def _smallest_fast_wave(result: CandidateTests) -> tuple[float, tuple[float, float]] | None:
    """Return the smallest wave that would have been found in the samples, and the band of which this is true."""
    band = fast_band(result.problem)
    if band is None:
        return None
    white = Whitened(Steps.of(result.problem, result.parameters))
    level = result.policy.significance * np.pi / ((band[1] - band[0]) * white.steps.span)
    torque = smallest_line(white, band, level)
    return (torque, band) if np.isfinite(torque) else None
