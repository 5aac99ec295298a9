"""Names the parameters that a recording does not determine, and says why in words."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, deviations
from fricmodels.drive import Drive, DriveParameter
from fricmodels.recording import Recording
from fricmodels.results.words import COMBINED, CONTAINS_ZERO, HELD
from fricmodels.weakform.cases import with_or_without_shift
from fricmodels.weakform.hidden import drowned, lost_in_noise, sign_is_hidden
from fricmodels.weakform.inference import NORMAL_95, is_contradicted
from fricmodels.weakform.nonlinear import Nonlinear, nonlinear_search
from fricmodels.weakform.separable import separable
from fricmodels.weakform.solve import Solved

_NOTHING = "it changes nothing in this recording"
_MEMBER = 0.05
"""Share of a direction of length 1 from which a parameter belongs to it."""
_NO_PART = 1e-6
"""Share below which it does not."""
FAR_WORSE = 2.0
"""Factor of the sum of squares that a fit leaves of the whole recording. One to a part of the rows that leaves more
says what these rows cannot know. Clear of reversals no speed may be low, and a stick torque that decays before the
first of them has no bound: the ratio was 10^11. Of twelve sines with a Stribeck friction two have no name without it.
"""
_ANYTHING = 1e6
"""Variance along a direction that is not determined, in units of the largest that is."""


def identified(found: Solved, left: Callable[[Solved], float] | None = None) -> Solved:
    """Return the fit with what the recording does not determine named, and held at nothing where that costs nothing.

    One parameter after the other is held, the least determined first, as long as all that are held may together be what
    they are held at (Wald test at 5 %). So two that stand for one another are not both dropped. Where something is
    nonlinear, the rows must not contradict it either: an interval may contain zero since an amplitude trades with a
    speed that was sought with it, and without it far more is left. Where only a combination is determined the last of
    its members is held: what the model has without it stays what it is.

    Args:
        found: the fit with nothing held.
        left: sum of squares that a fit leaves of the whole recording, which may not contradict it either: a small shift
            of the reversals may stand for a friction that acts there in the rows, and in nothing else.
    """
    problem, drive = found.problem, found.problem.drive
    recording = problem.recording
    search = nonlinear_search(drive, recording)
    searched = _ranges(drive, search)
    noisy = {} if drive.model.states or not sign_is_hidden(recording) else drowned(drive, recording, found.parameters)
    free = now = with_or_without_shift(found, found.again)
    combined = _combined(drive.keys, free.undetermined)
    held: dict[str, str] = {}
    refused: set[str] = set()
    while True:
        reasons = not_identified(drive, now.values, now.covariance, now.undetermined, searched)
        if held:  # what is said of an interval is said of the one that is given, with nothing held
            given = not_identified(drive, now.values, free.covariance, now.undetermined, searched)
            reasons = {key: given.get(key, reason) for key, reason in reasons.items()}
        reasons = {**lost_in_noise(noisy), **reasons}
        doubtful = set(reasons) - set(held) - refused
        loose = _last_of_a_combination(drive, now.undetermined, doubtful)
        choice = (loose, 0.0) if loose else to_hold(drive, now.values, now.covariance, searched, doubtful, noisy)
        reasons = {**reasons, **combined, **held}
        if choice is None:
            return now.changed(not_identified=reasons, free=free if held else None)
        key, value = choice
        plan = now.holding(key, value)
        if key != loose and key not in lost_in_noise(noisy) and not _may_be(free, plan.held):
            refused.add(key)
            continue
        smaller = with_or_without_shift(found, plan)
        far_worse = left is not None and left(smaller) > FAR_WORSE * left(now)
        if key != loose and (far_worse or _contradict(free, now, smaller)):
            refused.add(key)
            continue
        held[key] = f"{reasons[key]}{HELD}{value:.3g}"
        now = smaller
        idle = _idle(drive, held, search)
        if idle:  # where the search has left them hangs on the last digit
            held |= {idle_key: f"{_NOTHING}{HELD}{at:.3g}" for idle_key, at in idle.items()}
            now = with_or_without_shift(found, replace(plan, held={**plan.held, **idle}))


def _contradict(free: Solved, larger: Solved, smaller: Solved) -> bool:
    """Whether the rows contradict a fit with one parameter more held.

    Of a linear model the Wald test says it all, where its covariance is known: few strokes that are much alike may
    leave an interval that is a hundred times too wide. What far more is left without is not nothing.

    Args:
        free: the fit with nothing held. larger, smaller: with one parameter less, and more, held.
    """
    if all(p.linear for p in larger.problem.drive.parameters):
        if smaller.solution.cost <= FAR_WORSE * free.solution.cost:
            return False
        larger = free
    more = smaller.solution.cost / larger.solution.cost - 1.0
    return is_contradicted(more, len(larger.values), larger.problem.independent)


def _may_be(free: Solved, values: Mapping[str, float]) -> bool:
    """Whether parameters may all have given values: Wald test at 5 %."""
    from scipy.special import chdtrc

    places = [free.problem.drive.keys.index(key) for key in values]
    size = np.linalg.norm(free.solution.jacobian[free.places[places]], axis=1)
    apart = size * (free.values[places] - np.array(list(values.values())))
    spread = np.outer(size, size) * free.covariance[np.ix_(places, places)]
    loose = free.undetermined[places]  # along these anything may be
    spread = spread + _ANYTHING * max(float(np.max(np.diag(spread))), float(apart @ apart)) * (loose @ loose.T)
    statistic = float(apart @ np.linalg.pinv(spread, rcond=1e-12, hermitian=True) @ apart)
    return bool(chdtrc(len(places), statistic) > 0.05)


def not_identified(
    drive: Drive, values: Array, covariance: Array, undetermined: Array, searched: tuple[Array, Array]
) -> dict[str, str]:
    """Return key → reason for each parameter that the recording does not determine.

    Args:
        drive: gives keys and units.
        values, covariance: the estimate, in the order of the drive's parameters.
        undetermined: directions of length 1 along which nothing changes, in columns of unit length, shape (n, any
            number). One of a nuisance alone has nothing here.
        searched: least and greatest value that the data can tell apart, infinite for linear parameters.
    """
    keys = drive.keys
    spread = deviations(covariance)
    contains_zero = np.abs(values) <= NORMAL_95 * spread
    for pair in _pairs(drive):
        contains_zero[pair] = np.all(contains_zero[pair])
    found = _combined(keys, undetermined)
    for i, parameter in enumerate(drive.parameters):
        key = parameter.key
        if key in found:
            continue
        beyond = not (searched[0][i] <= values[i] <= searched[1][i])
        if not (beyond or contains_zero[i]):
            continue
        unit = parameter.declared.unit_for(drive.motion)
        if beyond:
            found[key] = f"its best value {values[i]:.3g} {unit} lies beyond what this motion can tell apart"
        else:
            half = NORMAL_95 * spread[i]
            partner, correlation = _partner(covariance, spread, i)
            found[key] = f"its 95 % interval, {values[i] - half:.3g} to {values[i] + half:.3g} {unit}, {CONTAINS_ZERO}"
            if correlation > 0.9:
                found[key] += f"; it trades with {keys[partner]} (correlation {correlation:.3f})"
    return {key: found[key] for key in keys if key in found}


def _combined(keys: Sequence[str], undetermined: Array) -> dict[str, str]:
    """Return key → reason for each parameter of which only a combination with others is determined, or nothing."""
    found: dict[str, str] = {}
    for direction in undetermined.T:
        members = [keys[i] for i in np.flatnonzero(np.abs(direction) > _MEMBER).tolist()]
        for key in members:
            others = [other for other in members if other != key]
            found[key] = f"{COMBINED} {', '.join(others)}" if others else _NOTHING
    return found


def _idle(drive: Drive, held: Collection[str], search: Nonlinear) -> dict[str, float]:
    """Return the nonlinear parameters of effects of which all else is held, with the middle of the scan of each.

    A wave of no size has any number.
    """
    nonlinear = [p.key for p in drive.parameters if not p.linear]
    starts = dict(zip(nonlinear, search.starts, strict=True))
    found: dict[str, float] = {}
    for effect in drive.model.effects:
        own = {f"{effect.name}.{p.symbol}" for p in effect.parameters}
        linear = own.difference(nonlinear)
        if linear and linear <= set(held):
            found |= {key: float(starts[key][len(starts[key]) // 2]) for key in sorted(own.difference(linear, held))}
    return found


def _last_of_a_combination(drive: Drive, undetermined: Array, doubtful: Collection[str]) -> str:
    """Return the last parameter that may be nothing without a change of the fit; empty where there is none.

    Along a direction in which a nonlinear parameter takes part nothing changes for small steps only.
    """
    nonlinear = [i for i, p in enumerate(drive.parameters) if not p.linear]
    if nonlinear and undetermined.size:
        _, sizes, axes = np.linalg.svd(undetermined[nonlinear])
        undetermined = undetermined @ axes[int(np.sum(sizes > _NO_PART)) :].T
    for i in range(len(drive.parameters) - 1, -1, -1):
        p = drive.parameters[i]
        if p.key in doubtful and _may_be_nothing(drive, p) and np.any(np.abs(undetermined[i]) > _MEMBER):
            return p.key
    return ""


def _may_be_nothing(drive: Drive, p: DriveParameter) -> bool:
    """Whether a parameter is one of those that are held at zero: linear, not the inertia, not a stick torque."""
    return (
        p.linear and p.key != drive.inertia_key and p.at_least is None and p.declared.lower <= 0.0 <= p.declared.upper
    )


def to_hold(
    drive: Drive,
    values: Array,
    covariance: Array,
    searched: tuple[Array, Array],
    doubtful: Collection[str],
    noisy: Mapping[str, float],
) -> tuple[str, float] | None:
    """Return the parameter that the recording determines least, and the value that says least of it.

    That is zero for a linear one, the end of the scan for a nonlinear one beyond it. A stick torque, whose neutral
    value is the slip torque, and the inertia, which is never zero, are not held.

    Args:
        drive, values, covariance, searched: see :func:`not_identified`.
        doubtful: keys among which to choose.
        noisy: how much of what each multiplies is noise; the noisiest is held first.
    """
    spread = deviations(covariance)
    choices: list[tuple[float, float, str, float]] = []
    for i, p in enumerate(drive.parameters):
        if p.key not in doubtful or p.key == drive.inertia_key or spread[i] == 0.0:
            continue
        nearest = float(np.clip(values[i], searched[0][i], searched[1][i]))
        if nearest != values[i]:
            choices.append((-np.inf, 0.0, p.key, nearest))
        elif _may_be_nothing(drive, p):
            choices.append((-noisy.get(p.key, 0.0), abs(values[i]) / spread[i], p.key, 0.0))
    return min(choices)[2:] if choices else None


def searched_range(drive: Drive, recording: Recording) -> tuple[Array, Array]:
    """Return the range of each nonlinear parameter that its scan covers, a factor of ten wider on either side."""
    return _ranges(drive, nonlinear_search(drive, recording))


def _ranges(drive: Drive, search: Nonlinear) -> tuple[Array, Array]:
    lower, upper = np.full(len(drive.keys), -np.inf), np.full(len(drive.keys), np.inf)
    places = [i for i, p in enumerate(drive.parameters) if not p.linear]
    for place, starts, logarithmic in zip(places, search.starts, search.logarithmic, strict=True):
        if logarithmic and len(starts) > 1:
            lower[place], upper[place] = min(starts) / 10.0, max(starts) * 10.0
    return lower, upper


def _pairs(drive: Drive) -> list[list[int]]:
    """Return the amplitudes that share a wave number: one may be zero by the phase alone, all are by the effect."""
    split, shift = separable(drive.model), len(drive.keys) - len(drive.model.parameters)
    return [
        [shift + split.linear[row] for row, place in split.slopes if place == j and row < len(split.linear)]
        for j, index in enumerate(split.nonlinear)
        if drive.model.parameters[index].declared.periodic
    ]


def _partner(covariance: Array, spread: Array, i: int) -> tuple[int, float]:
    scale = spread * spread[i]
    correlation = np.where(scale > 0.0, np.abs(covariance[i]) / np.where(scale > 0.0, scale, 1.0), 0.0)
    correlation[i] = 0.0
    partner = int(np.argmax(correlation))
    return partner, float(correlation[partner])
