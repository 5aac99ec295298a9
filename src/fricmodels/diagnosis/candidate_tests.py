"""Tests every candidate effect on the residual of a model."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import Array
from fricmodels.diagnosis.journal import searched
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.progress import each
from fricmodels.recording import RUN, channel_of
from fricmodels.term import Effect
from fricmodels.weakform.acting import acting
from fricmodels.weakform.candidate import NonlinearOptimum
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import LEAST_P, Evidence, Regression, compare, unwarned
from fricmodels.weakform.shifted import noise_within, regression_of

_ROUNDING = 1e-9
"""Squared share of a column, of what the model leaves of it, below which it is rounding."""


@dataclass(frozen=True)
class CandidateTest:
    """One candidate effect and what speaks for it.

    Attributes:
        effect: the candidate.
        found: its nonlinear parameters and columns.
        evidence: see :class:`fricmodels.weakform.regression.Evidence`.
        p_value: corrected for the values tried within the effect; ``adjusted`` also for the number of effects.
        once: as ``adjusted``, with what repeats counted once, see :mod:`fricmodels.weakform.repeats`: what a name has
            to pass besides.
    """

    effect: Effect
    found: NonlinearOptimum
    evidence: Evidence
    p_value: float
    adjusted: float = 1.0
    once: float = 1.0

    @property
    def name(self) -> str:
        """The effect's name."""
        return self.effect.name

    @property
    def size(self) -> int:
        """Number of the effect's parameters."""
        return len(self.effect.parameters)

    @property
    def parameters(self) -> dict[str, float]:
        """Estimated parameters by symbol, in SI units."""
        symbols = [p.symbol for p in self.effect.parameters]
        coefficients = np.zeros(len(self.found.kept))
        coefficients[self.found.kept] = self.evidence.coefficients
        linear = dict(zip(self._linear_symbols, coefficients, strict=True))
        nonlinear = [symbol for symbol in symbols if symbol not in linear]
        values = {**linear, **dict(zip(nonlinear, self.found.nonlinear, strict=True))}
        values |= {p.symbol: self.found.delay for p in self.effect.parameters if p.delay and self.found.delay}
        return {symbol: float(values[symbol]) for symbol in symbols}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each linear parameter that counts, by symbol, in SI units."""
        kept = [symbol for symbol, used in zip(self._linear_symbols, self.found.kept, strict=True) if used]
        spread = np.sqrt(np.maximum(np.diag(self.evidence.covariance), 0.0))
        return dict(zip(kept, spread.tolist(), strict=True))

    @property
    def _linear_symbols(self) -> list[str]:
        from fricmodels.model import Model

        flags = Model.only(self.effect).linear
        return [p.symbol for p, is_linear in zip(self.effect.parameters, flags, strict=True) if is_linear]


@dataclass(frozen=True)
class CandidateTests:
    """All candidates on one residual.

    Attributes:
        problem, regression: the rows.
        parameters: the model's estimated parameters.
        tested: candidates that could be tested, the one with the least residual on held-out blocks first.
        untested: candidates that could not be tested, with the reason.
        policy: decides what passes.
    """

    problem: WeakFormProblem
    regression: Regression
    parameters: Mapping[str, float]
    tested: tuple[CandidateTest, ...]
    untested: Mapping[str, str]
    policy: Policy = POLICY


def candidate_tests(
    problem: WeakFormProblem,
    parameters: Mapping[str, float],
    *,
    leave_out: Iterable[str] = (),
    only: Iterable[str] | None = None,
    also: Array | None = None,
    found: Iterable[str] = (),
    several: Collection[str] | None = None,
    policy: Policy = POLICY,
) -> CandidateTests:
    """Test every registered effect that the model does not have.

    Args:
        problem: drive and recording.
        parameters: the model's estimated parameters.
        leave_out: names of effects that are not considered.
        only: names of the effects to consider; all by default.
        also: columns that are taken to be in the model already, shape (k, rows).
        found: names of the effects that these columns are of.
        several: kinds of effects of which another one is considered where one is there; all by default.
        policy: decides how much noise a column may hold, and what passes.
    """
    model = problem.drive.model
    there = {*(effect.name for effect in model.effects), *found}
    regression = regression_of(problem, parameters, also)
    skipped = set(leave_out)
    tested: list[CandidateTest] = []
    untested: dict[str, str] = {}
    registered = plugins.load().effects
    # The search for an effect with memory is long, and goes on only as far as it may yet compare with the others, and
    # with what sampling leaves by itself.
    rival = policy.sampling_leaves**2 * float(np.sum(acting(problem) ** 2))
    total = float(regression.residual @ regression.residual)
    names = [name for name in registered if only is None or name in only]
    for name in each(f"testing effects on {model.name}", sorted(names, key=lambda name: bool(registered[name].states))):
        candidates = registered[name].candidates(problem.recording)
        if not candidates and name not in skipped:
            untested[name] = registered[name].absent
        for effect in not_yet(candidates, there, several):
            if effect.name in skipped:
                continue
            try:
                outcome = _candidate(problem, regression, effect, rival, policy, there)
            except Exception as error:  # an effect of a plugin may do anything; the others go on
                outcome = f"it could not be tested: {type(error).__name__}: {error}"
            if isinstance(outcome, str):
                untested[effect.name] = outcome
            else:
                tested.append(outcome)
                rival = max(rival, outcome.evidence.explained * total)
    adjusted = corrected([t.p_value for t in tested]).tolist()
    once = corrected([min(1.0, t.evidence.p_once * t.found.trials) for t in tested]).tolist()
    ranked = [
        replace(t, adjusted=max(p, LEAST_P), once=max(p_once, LEAST_P))
        for t, p, p_once in zip(tested, adjusted, once, strict=True)
    ]
    ranked.sort(key=lambda t: t.evidence.left)
    return CandidateTests(problem, regression, parameters, tuple(ranked), untested, policy)


def corrected(p_values: Sequence[float]) -> Array:
    r"""Return p-values corrected for how many there are, shape (m,), whatever the dependence between the tests.

    Below a level α they say that the chance of any false one among them is at most α (Holm 1979):

    .. math:: \tilde p_{(i)} = \max_{j \le i} \min\{1, (m - j + 1)\, p_{(j)}\}, \qquad p_{(1)} \le \dots \le p_{(m)}
    """
    values = np.asarray(p_values, dtype=float)
    order = np.argsort(values, kind="stable")
    raised = np.minimum(values[order] * np.arange(len(order), 0, -1), 1.0)
    result = np.empty(len(order))
    result[order] = np.maximum.accumulate(raised)
    return result


def not_yet(
    candidates: Iterable[Effect], there: Collection[str], several: Collection[str] | None = None
) -> Iterator[Effect]:
    """Yield candidates that are not there; of one that is, the next of its kind, if there may be several."""
    for candidate in candidates:
        effect: Effect | None = candidate
        while effect is not None and effect.name in there:
            effect = effect.another() if several is None or candidate.name in several else None
        if effect is not None:
            yield effect


def _candidate(
    problem: WeakFormProblem,
    regression: Regression,
    effect: Effect,
    rival: float,
    policy: Policy,
    there: Collection[str],
) -> CandidateTest | str:
    """Test one effect, or say why it cannot be tested.

    Args:
        problem, regression: the model and its rows.
        effect: the candidate.
        rival: sum of squares that another one explains.
        policy: decides how much noise a column may hold.
        there: names of the effects of the model.
    """
    if effect.angular and problem.drive.motion is Motion.LINEAR:
        return "a linear axis does not turn"
    if effect.only_beside and effect.only_beside not in there:
        return f"it is considered beside {effect.only_beside} only"
    alone = problem.alone(effect)
    missing = [signal for signal in sorted(alone.model.required) if not _has(problem, signal)]
    if missing:
        return f"the recording has no {channel_of(missing[0]).replace('_', ' ')}"
    found = searched(problem, regression, effect, alone, rival)
    # What an estimated inertia takes up may leave a rest or none; the reason is the same.
    if is_taken_up(problem, regression, _first_columns(problem, effect, alone) if found is None else found.columns):
        return "the inertia is estimated, and the model with it can be all that this would add; give it to see more"
    if found is None:
        return "what it would add to the residual cannot be told from what the model already has"
    if np.any(found.kept):
        share = noise_share(problem, problem.perturbed, regression, effect, found)
        if is_noise(share, found.explained / float(regression.residual @ regression.residual), policy):
            return "noise of the velocity hides what it would add beyond what the model already has"
    return tested_at(regression, effect, found)


def _first_columns(problem: WeakFormProblem, effect: Effect, alone: Drive) -> Array:
    """Return an effect's linear columns at the initial values of its nonlinear parameters, shape (q, rows)."""
    return problem.columns(alone, [p.declared.initial for p in alone.model.nonlinear_parameters])[0]


def _has(problem: WeakFormProblem, signal: str) -> bool:
    return signal in ("motor_torque_rate", RUN) or channel_of(signal) in problem.recording


def noise_share(
    problem: WeakFormProblem,
    perturbed: WeakFormProblem,
    regression: Regression,
    effect: Effect,
    found: NonlinearOptimum,
) -> float:
    """Return the share of noise in the torque that a candidate adds: of all its columns, or of that with most noise.

    The same noise is in the inertia torque on the other side of the equation, so that a torque which is mostly noise
    explains part of the residual, at most its share, without any effect. It counts against what the columns make
    together: under one frequency position goes with acceleration, and a spring with an offset is the inertia torque
    without its noise, though position alone, far from zero, is mostly offset; and a column that is mostly noise, beside
    the model, does no harm while it adds next to nothing. Columns that cancel each other count with the noise of each.
    """
    columns, _ = perturbed.columns(problem.alone(effect), found.nonlinear, found.delay)
    noise = noise_within(problem, regression, found.columns, columns[found.kept])
    signal = regression.project_out(found.columns)
    together = np.linalg.lstsq(signal.T, regression.residual, rcond=1e-10)[0]
    power = float(np.sum((together @ signal) ** 2))
    parts = np.vstack([together @ noise, together[:, None] * noise])
    return float(np.max(np.sum(parts**2, axis=1))) / power if power > 0.0 else 0.0


@unwarned
def is_taken_up(problem: WeakFormProblem, regression: Regression, columns: Array) -> bool:
    """Whether columns, shape (k, rows), hold nothing but what the model can do with an inertia that is estimated.

    So it is with any column of the acceleration and of what the model is linear in, such as its own motor torque:
    without a known inertia or load no torque has a known scale.
    """
    if problem.drive.inertia is not None:
        return False
    left = regression.project_out(beside_inertia(problem, regression, columns))
    return float(np.sum(left**2)) < _ROUNDING * float(np.sum(regression.project_out(columns) ** 2))


def beside_inertia(problem: WeakFormProblem, regression: Regression, columns: Array) -> Array:
    """Return columns, shape (k, rows), without their part that an estimated inertia can do.

    The inertia torque of the model comes from the changes of the velocity. So does that of a column, but for the part
    in which noise hides the difference from a smoothed acceleration. What is left between the two is how derivatives
    are taken, in the column and in the residual alike, and belongs to no cause.
    """
    if problem.drive.inertia is not None:
        return columns
    smoothed = problem.integrals(problem.quadrature.recording["acceleration"][None])
    own = regression.project_out(smoothed)[0]
    size = float(own @ own)
    return columns - np.outer(columns @ own / size, own) if size > 0 else columns


def is_noise(share: float, explained: float, policy: Policy) -> bool:
    """Whether noise makes up too much of columns for the share of the squared residual that they explain."""
    return share > max(policy.noise_share, policy.noise_share_of_explained * explained)


def tested_at(regression: Regression, effect: Effect, found: NonlinearOptimum) -> CandidateTest:
    """Return an effect with what speaks for it at its nonlinear parameters."""
    if not np.any(found.kept):  # it would need a coefficient beyond its physical bounds
        return CandidateTest(effect, found, no_evidence(regression), 1.0)
    evidence = _whole_shift(regression, found) if found.delay else regression.test(found.columns)
    return CandidateTest(effect, found, evidence, min(1.0, evidence.p_value * found.trials))


def no_evidence(regression: Regression) -> Evidence:
    """Return the evidence for an effect of which no column is left: it explains nothing."""
    return Evidence(np.zeros(0), np.zeros((0, 0)), 1.0, 1.0, 0.0, 0.0, 1.0, regression.loss)


def _whole_shift(regression: Regression, found: NonlinearOptimum) -> Evidence:
    """Return the evidence for a shift in time by a whole delay: how well its column explains is not left to fit."""
    own = regression.unshifted
    after = own.less(found.delay * found.columns[0])
    gain, gain_p_value = compare(regression.loss, after.loss, regression.terms)
    left, total = (float(r.residual @ r.residual) for r in (after, regression))
    return replace(
        own.test(found.columns, regression),
        explained=1 - left / total if total > 0 else 0.0,
        gain=gain,
        gain_p_value=gain_p_value,
        loss=after.loss,
    )
