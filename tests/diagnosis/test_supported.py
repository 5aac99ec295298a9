"""A name has to stand against views of the residual: it is given to the effect, and refused to what resembles it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import fricmodels.diagnosis.floor as errors_floor
from fricmodels.diagnosis import candidate_tests as surveys
from fricmodels.diagnosis import compare, diagnose, examine, improve, rivals, supported
from fricmodels.diagnosis.basis_functions import basis_functions
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.comparison import SlidingErrors
from fricmodels.diagnosis.effect_set import Rest, as_predictor, member_of
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.predictability import passing_predictors
from fricmodels.diagnosis.supported import judge
from fricmodels.diagnosis.verdict import LookAlikes, select_effect
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.weakform.estimate import estimate

Made = Callable[..., Recording]
LAW = Model.parse("coulomb-viscous")

HIDDEN = {
    "gravity": ({"a": 1.0, "b": 0.5}, "position"),
    "asymmetry": ({"c": 0.3, "d": -0.2}, "speed, the same in both directions"),
    "step-change": ({"c": 0.8, "d": 0.0, "t_0": 7.0}, "time, in one jump"),
    "inertia-error": ({"dJ": 0.1}, "acceleration"),
}


def named(result: CandidateTests, candidates: list[str]) -> list[str]:
    """Return the effects that are supported, where no others are candidates."""
    first = select_effect(result)
    others = set(load().effects).difference(candidates)
    return [found.first.name for found in judge(result, others, first).supported(result.policy)]


@pytest.mark.parametrize("effect", HIDDEN)
def test_the_channel_of_the_effect_is_the_best_predictor(made: Made, effect: str) -> None:
    values, channel = HIDDEN[effect]
    recording = made(f"coulomb-viscous+{effect}", {f"{effect}.{key}": value for key, value in values.items()})
    problem, found = estimate(Drive(LAW, 2.0), recording)
    result = candidate_tests(problem, found.parameters, only=[effect])
    by_name = {view.channels: view for view in passing_predictors(result)}
    assert by_name[channel].evidence.gain == pytest.approx(result.tested[0].evidence.gain, abs=0.01)
    assert result.tested[0].evidence.gain > 0.65
    assert by_name[channel].evidence.gain == pytest.approx(max(v.evidence.gain for v in by_name.values()), abs=0.1)


@pytest.mark.long
@pytest.mark.parametrize("effect", HIDDEN)
def test_named_when_it_is_a_candidate_and_unknown_when_it_is_not(made: Made, effect: str) -> None:
    values, _ = HIDDEN[effect]
    recording = made(f"coulomb-viscous+{effect}", {f"{effect}.{key}": value for key, value in values.items()})
    whole = diagnose(recording, LAW, 2.0)
    assert effect in whole.findings[0].names
    rest = diagnose(recording, LAW, 2.0, leave_out=whole.findings[0].names)
    assert (rest.verdict, rest.findings) == ("unknown-effect", ())
    assert rest.view is not None


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_nothing_predicts_a_clean_drive(made: Made, seed: int) -> None:
    diagnosis = diagnose(made(seed=seed, noise=1.0), LAW, 2.0)
    assert (diagnosis.verdict, diagnosis.view) == ("adequate", None)


@pytest.mark.long
def test_cogging_of_several_orders_is_cogging(made: Made) -> None:
    """Poles and slots have each their own order; the strongest is found first, and each has its own number."""
    name = "coulomb-viscous+cogging"
    first = {"cogging.a": 0.5, "cogging.b": 0.2, "cogging.k": 7.3}
    recording = made(name, first, samples=4000)
    wave = 0.35 * np.cos(12.5 * recording["position"] + 1.0) + 0.3 * np.sin(4.4 * recording["position"])
    diagnosis = diagnose(recording.with_channels(derived=False, torque=recording.torque + wave), LAW, 2.0)
    assert [finding.names for finding in diagnosis.findings] == [("cogging",), ("cogging(2)",), ("cogging(3)",)]
    numbers = [finding.tested.parameters["k"] for finding in diagnosis.findings]
    assert numbers == pytest.approx([7.3, 12.5, 4.4], rel=0.01)


@pytest.mark.long
@pytest.mark.parametrize("beside", [0.0, 0.5, 1.0])
def test_an_effect_is_there_whatever_else_is_missing(made: Made, beside: float) -> None:
    """A load that comes and goes with time is no candidate and leaves more than the cogging, which is named."""
    recording = made("coulomb-viscous+cogging", {"cogging.a": 0.8, "cogging.b": 0.3, "cogging.k": 7.3})
    load = beside * np.sin(2 * np.pi * 1.5 * recording.time / float(np.ptp(recording.time)))
    recording = recording.with_channels(derived=False, torque=recording.torque + load)
    problem, found = estimate(Drive(LAW, 2.0), recording)
    result = candidate_tests(problem, found.parameters, only=["cogging"])
    assert named(result, ["cogging"]) == ["cogging"]


@pytest.mark.long
def test_an_effect_beside_a_bump_at_one_position(made: Made) -> None:
    """The bump is on no list: the effect is named all the same, and what remains is said with its place."""
    recording = made("coulomb-viscous+asymmetry", {"asymmetry.c": 0.3, "asymmetry.d": 0.8}, samples=4000)
    position = recording["position"]
    middle, width = float(np.median(position)), 0.015 * float(np.ptp(position))
    bump = 4.0 * np.exp(-0.5 * ((position - middle) / width) ** 2)
    ladder = improve(recording.with_channels(derived=False, torque=recording.torque + bump), LAW, 2.0)
    assert ladder.rungs[1].added == "asymmetry"
    assert ladder.last.verdict == "unknown-effect"
    rest = ladder.last.remaining
    assert rest is not None
    assert rest.place is not None
    assert rest.place.channel == "position"
    assert rest.place.low - width < middle < rest.place.high + width
    assert rest.place.torque > 0.1


@pytest.mark.long
@pytest.mark.parametrize(("ends", "noise"), [((0.35, 0.6), 0.05), ((0.3, 0.7), 1.0)])
def test_a_zone_of_friction_is_no_wave(made: Made, ends: tuple[float, float], noise: float) -> None:
    """One or several waves and a description of what they leave draw the zone, with more terms than one stretch.

    Hats over a wide zone are as many terms as waves are; one torque all over it is not.
    """
    recording = made(noise=noise)
    position = recording["position"]
    low, high = (float(q) for q in np.quantile(position, ends))
    more = 2.0 * np.sign(recording.velocity) * ((position > low) & (position < high))
    diagnosis = diagnose(recording.with_channels(derived=False, torque=recording.torque + more), "coulomb-viscous", 2.0)
    assert diagnosis.verdict == "unknown-effect"
    assert not diagnosis.findings
    assert diagnosis.place is not None
    assert diagnosis.place.direction == "along the motion"
    assert (diagnosis.place.low, diagnosis.place.high) == pytest.approx((low, high), abs=0.1 * (high - low))
    assert diagnosis.place.torque == pytest.approx(2.0, rel=0.1)


@pytest.mark.long
@pytest.mark.parametrize("seed", [9, 10, 12])
def test_a_walk_of_friction_is_no_drift(made: Made, seed: int) -> None:
    """A line, a step or a fall draws a part of any slow course; another course of time tells it from these."""
    recording = made(noise=0.1)
    walk = np.cumsum(np.random.default_rng(seed).standard_normal(len(recording)))
    walk = (walk - walk.mean()) / walk.std()
    torque = recording.torque + 2.0 * walk * np.sign(recording.velocity)
    diagnosis = diagnose(recording.with_channels(derived=False, torque=torque), LAW, 2.0)
    assert diagnosis.verdict == "unknown-effect"
    assert diagnosis.view is not None
    assert diagnosis.view.channels == "time, finely, along the motion"


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.long) for seed in (10, 18, 30)])
def test_a_walk_that_a_line_or_a_jump_follows_is_neither(made: Made, seed: int) -> None:
    """Of forty such walks seven were a drift or a step while none was thought of in the noise."""
    recording = made(noise=0.5, samples=4000, rate=250.0)
    walk = np.cumsum(np.random.default_rng(seed).standard_normal(len(recording)))
    walk = (walk - walk.mean()) / walk.std()
    walking = recording.with_channels(derived=False, torque=recording.torque + walk * np.sign(recording.velocity))
    comparison = compare(walking, LAW, 2.0)
    assert examine(comparison).verdict == "unknown-effect"
    without = examine(comparison, policy=replace(POLICY, walk_significance=1.1))
    assert [finding.names for finding in without.findings] in [[("drift",)], [("step-change",)]]


@pytest.mark.parametrize(("seed", "kept"), [(10, False), (None, True)])
def test_a_look_alike_of_the_time_is_one_only_if_a_walk_would_not_do(made: Made, seed: int | None, kept: bool) -> None:
    values = {"drift.a": 0.6, "drift.b": 0.05, "drift.T": 8.0}
    recording = made(noise=0.5, samples=4000, rate=250.0) if seed is not None else made("coulomb-viscous+drift", values)
    if seed is not None:
        walk = np.cumsum(np.random.default_rng(seed).standard_normal(len(recording)))
        torque = recording.torque + (walk - walk.mean()) / walk.std() * np.sign(recording.velocity)
        recording = recording.with_channels(derived=False, torque=torque)
    comparison = compare(recording, LAW, 2.0)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=["asymmetry", "drift"])
    asymmetry, drift = sorted(result.tested, key=lambda tested: tested.name)
    found = member_of(result, LookAlikes(asymmetry, (asymmetry, drift)))
    assert drift.p_value < 0.01  # by itself it is significant
    rest = Rest.of(result, [found])
    assert supported._without_walks(result, found, [], rest).names == ["asymmetry", "drift"][: 1 + kept]


@pytest.mark.parametrize("effect", ["drift", pytest.param("step-change", marks=pytest.mark.long)])
def test_what_happens_once_as_its_equation_says_has_its_name(made: Made, effect: str) -> None:
    values = {"drift.a": 0.6, "drift.b": 0.05, "drift.T": 8.0, "step-change.c": 0.5, "step-change.t_0": 7.0}
    own = {key: value for key, value in values.items() if key.startswith(effect)}
    diagnosis = diagnose(made(f"coulomb-viscous+{effect}", own, noise=0.5), LAW, 2.0)
    assert [finding.names[0] for finding in diagnosis.findings] == [effect]


@pytest.mark.long
@pytest.mark.parametrize("inertia", [2.0, None])
def test_a_torque_of_the_size_of_the_acceleration_is_seen_in_the_acceleration(
    made: Made, inertia: float | None
) -> None:
    """It is the same in both directions, whichever way the drive speeds up; an offset is what comes nearest.

    With an inertia that is estimated the acceleration itself is in the model, and what is left of it is rounding.
    """
    recording = made(samples=4000)
    torque = recording.torque + 0.1 * np.abs(np.gradient(recording.velocity, recording.time))
    diagnosis = diagnose(recording.with_channels(derived=False, torque=torque), LAW, inertia)
    assert diagnosis.verdict == "unknown-effect"
    assert diagnosis.view is not None
    assert diagnosis.view.channels == "acceleration"


@pytest.mark.long
@pytest.mark.parametrize("inertia", [2.0, None])
def test_two_effects_that_one_channel_does_with_fewer_terms_are_not_named(inertia: float | None) -> None:
    """Under one sine an asymmetry and a wave over position add up to what goes with the size of the acceleration."""
    time, rng = np.arange(6000) / 500.0, np.random.default_rng(1)
    phase = 2 * np.pi * 0.7 * time
    velocity, acceleration = 5.0 * np.sin(phase), 5.0 * 2 * np.pi * 0.7 * np.cos(phase)
    torque = 2.0 * acceleration + 3.0 * np.sign(velocity) + 0.2 * velocity + 0.3 * np.abs(acceleration)
    channels = {
        "time": time,
        "velocity": velocity + 1e-3 * rng.standard_normal(6000),
        "position": -5.0 / (2 * np.pi * 0.7) * np.cos(phase),
        "torque": torque + 0.02 * rng.standard_normal(6000),
    }
    recording = Recording("sine", Motion.ROTARY, channels, np.zeros(6000, dtype=np.int64))
    diagnosis = diagnose(recording, LAW, inertia)
    assert (diagnosis.verdict, diagnosis.findings) == ("unknown-effect", ())
    assert diagnosis.view is not None
    assert diagnosis.view.channels == "acceleration"


@pytest.mark.long
def test_a_wave_of_friction_is_no_zone(made: Made) -> None:
    values = {"position-friction.a": 0.6, "position-friction.b": 0.4, "position-friction.k": 0.5}
    diagnosis = diagnose(made("coulomb-viscous+position-friction", values, noise=0.5), "coulomb-viscous", 2.0)
    assert diagnosis.findings[0].names[0] == "position-friction"


@pytest.mark.parametrize(
    ("effect", "channels"),
    [
        ("torque-offset", "a constant torque, as in 'torque-offset'"),
        ("inertia-error", "acceleration, as in 'inertia-error'"),
        ("presliding", "the course of the motion before, as in 'presliding'"),
    ],
)
def test_what_is_refused_still_tells_the_channel(made: Made, effect: str, channels: str) -> None:
    problem, found = estimate(Drive(LAW, 2.0), made("coulomb-viscous+asymmetry", {"asymmetry.c": 0.3}))
    result = candidate_tests(problem, found.parameters, only=[effect])
    assert as_predictor(result, result.tested[0]).channels == channels


def test_an_effect_that_only_resembles_gives_way_or_is_refused(made: Made) -> None:
    """Stiction that rises between two samples explains a Stribeck curve, and is not named for it."""
    values = {"stribeck.F_s": 3.0, "stribeck.omega_s": 0.2, "stribeck.delta": 1.0}
    problem, found = estimate(Drive(LAW, 2.0), made("coulomb-viscous+stribeck", values))
    both = candidate_tests(problem, found.parameters, only=["stribeck", "rising-stiction"])
    best = select_effect(both)
    assert best is not None
    assert best.first.name == "stribeck"
    alone = candidate_tests(problem, found.parameters, only=["rising-stiction"])
    assert named(alone, ["rising-stiction"]) == []


def test_an_error_that_nothing_predicts_is_not_adequate(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    comparison = compare(made(noise=1.0, samples=4000), LAW, 2.0)
    assert examine(comparison).verdict == "adequate"
    line = replace(comparison.errors.headline, noise_floor_percent=0.1, fit_noise_percent=0.1)
    comparison = replace(comparison, errors=replace(comparison.errors, headline=line))
    assert examine(comparison).verdict == "adequate"
    spoilt = replace(comparison, sliding=SlidingErrors(9.0, 1.0, 1.0, 1.0))
    assert examine(spoilt).verdict == "adequate"  # the recording itself has no such error
    monkeypatch.setattr(errors_floor, "_beyond_sampling", lambda comparison: (9.0, 1.0))
    assert examine(comparison).verdict == "adequate"  # so much may be noise
    diagnosis = examine(spoilt)
    assert (diagnosis.verdict, diagnosis.view, diagnosis.findings) == ("unknown-effect", None, ())


def at_search_bound(tested: surveys.CandidateTest) -> surveys.CandidateTest:
    return replace(tested, found=replace(tested.found, at_search_bound=True))


def test_what_is_at_its_search_bound_comes_after_all_others_and_describes(made: Made) -> None:
    """An offset stands for an asymmetry alone until the asymmetry, at its search bound, shows its lack."""
    problem, found = estimate(
        Drive(LAW, 2.0), made("coulomb-viscous+asymmetry", {"asymmetry.c": 0.3, "asymmetry.d": 0.2})
    )
    result = candidate_tests(problem, found.parameters, only=["asymmetry", "torque-offset"])
    best, other = result.tested
    assert (best.name, other.name) == ("asymmetry", "torque-offset")
    doubted = replace(result, tested=(at_search_bound(best), other))
    first = select_effect(doubted)
    assert first is not None
    assert first.first.name == "torque-offset"
    assert named(replace(result, tested=(at_search_bound(best),)), ["asymmetry"]) == []


def test_two_effects_are_both_there(made: Made) -> None:
    """What is left beside them is white noise of the torque, which nothing predicts."""
    values = {"asymmetry.c": 0.5, "asymmetry.d": 0.0, "gravity.a": 0.8, "gravity.b": 0.0}
    recording = made("coulomb-viscous+asymmetry+gravity", values)
    shaken = np.convolve(np.random.default_rng(3).standard_normal(len(recording)), np.ones(60) / 60**0.5, mode="same")
    recording = recording.with_channels(derived=False, torque=recording.torque + 0.05 * shaken)
    problem, found = estimate(Drive(LAW, 2.0), recording)
    result = candidate_tests(problem, found.parameters, only=["asymmetry", "gravity"])
    assert sorted(named(result, ["asymmetry", "gravity"])) == ["asymmetry", "gravity"]


@pytest.mark.long
@pytest.mark.parametrize("samples", [10, 20])
def test_friction_that_lags_is_no_wrong_inertia(made: Made, samples: int) -> None:
    """To first order it is an inertia that depends on speed, and only at some speeds it is there."""
    lagging = {"F_s": 3.0, "omega_s": 1.0, "T": samples * 2e-3, "r": 0.0}
    recording = made("coulomb-viscous+frictional-lag", {f"frictional-lag.{key}": x for key, x in lagging.items()})
    comparison = compare(recording, "coulomb-viscous+stribeck", 2.0)
    assert examine(comparison).findings[0].names == ("frictional-lag",)
    result = candidate_tests(replace(comparison.problem), comparison.estimate.parameters, only=["inertia-error"])
    (wrong,) = result.tested
    assert wrong.evidence.gain > 0.1
    (lag,) = [v for v in passing_predictors(result) if v.channels == "acceleration and speed"]
    assert lag.evidence.explained > wrong.evidence.explained + 0.1
    assert named(result, ["inertia-error"]) == []


def test_an_error_is_above_noise_by_the_noise_of_its_own_part(made: Made) -> None:
    comparison = compare(made(noise=1.0), LAW, 2.0)
    assert errors_floor.is_above_noise(replace(comparison, sliding=SlidingErrors(1.0, 9.0, 1.0, 1.0)))
    assert not errors_floor.is_above_noise(replace(comparison, sliding=SlidingErrors(1.0, 9.0, 1.0, 8.0)))


@pytest.mark.long
@pytest.mark.parametrize("samples", [0.8, 1.0])
def test_a_delay_is_named_though_the_past_of_the_torque_can_be_all_of_it(samples: float) -> None:
    """With half a sample by which the torque is held it is little longer than what sampling alone may do."""
    rig = Rig.model_validate(
        {
            "inertia": 0.02,
            "friction": {"viscous": 0.05, "coulomb": 0.3},
            "effects": [{"name": "sensor-delay", "delay": samples / 100}],
            "excitation": {"kind": "multisine", "amplitude": 2.0, "frequency": 0.4, "lines": 20},
            "sensors": {"velocity_noise_percent": 0.3, "position": True},
            "rate": 100,
            "samples": 4000,
            "seed": 2,
        }
    )
    diagnosis = diagnose(rig.simulate(), LAW, 0.02)
    (finding,) = diagnosis.findings
    assert finding.names == ("sensor-delay",)
    assert finding.tested.parameters["T"] == pytest.approx((samples + 0.5) / 100, rel=0.02)


@pytest.mark.parametrize(("terms", "better"), [(3, True), (4, False)])
def test_of_two_equally_simple_forms_the_better_one_is_better_without_a_test(
    monkeypatch: pytest.MonkeyPatch, terms: int, better: bool
) -> None:
    """An effect of two torques and a wave number has three terms; a rival that no test prefers may have no more."""
    monkeypatch.setattr(rivals, "compare", lambda *_: (0.0, 1.0))
    monkeypatch.setattr(rivals, "predicts_beside", lambda *_: False)
    loss = np.ones(5)
    effect: Any = SimpleNamespace(found=SimpleNamespace(columns=np.ones((2, 5)), nonlinear=(7.0,)))
    regression = SimpleNamespace(loss=loss, terms=8)
    gain: Any = SimpleNamespace(regression=regression, without=regression, columns=np.ones((2, 5)))
    result: Any = SimpleNamespace(policy=POLICY)
    instead = rivals.Instead(np.ones((terms, 5)), frozenset({"position, in one stretch"}), 30, terms)
    other: Any = regression
    assert rivals.is_better(result, effect, gain, 0.9, other, loss, instead) is better


@pytest.mark.parametrize(("left", "better"), [(3.5, True), (1.5, True), (0.5, False)])
def test_an_effect_that_adds_next_to_nothing_to_a_channel_lies_within_it(
    monkeypatch: pytest.MonkeyPatch, left: float, better: bool
) -> None:
    """The effect leaves 100, the channel 4, both together less: each predicts something beside the other."""
    monkeypatch.setattr(rivals, "compare", lambda *_: (0.0, 1.0))
    monkeypatch.setattr(rivals, "predicts_beside", lambda *_: True)
    monkeypatch.setattr(rivals, "visible_of", lambda _, columns: columns)
    effect: Any = SimpleNamespace(found=SimpleNamespace(columns=np.ones((1, 5)), nonlinear=()))
    regression = SimpleNamespace(loss=np.full(5, 20.0), terms=8)
    gain: Any = SimpleNamespace(regression=regression, without=regression, columns=np.ones((1, 5)))
    result: Any = SimpleNamespace(policy=POLICY)
    other: Any = SimpleNamespace(test=lambda _: SimpleNamespace(loss=np.full(5, left / 5)))
    instead = rivals.Instead(np.ones((4, 5)), frozenset({"motor torque"}), 30, 4)
    assert rivals.is_better(result, effect, gain, 0.9, other, np.full(5, 0.8), instead) is better


def test_the_channel_of_the_motor_torque_holds_a_torque_that_falls_short_of_the_current(made: Made) -> None:
    problem, found = estimate(Drive(LAW, 2.0), made())
    regression = candidate_tests(problem, found.parameters, only=[]).regression
    columns = basis_functions(problem, regression, POLICY)["motor torque"]()
    torque = problem.motor_torque
    droop = problem.integrals((np.abs(torque) * torque)[None])[0]
    left = droop - np.linalg.lstsq(columns.T, droop, rcond=None)[0] @ columns
    assert left @ left < 1e-12 * droop @ droop
