"""Effects with memory that act where rows are silent are found on all motion, if the error falls with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from tests.conftest import Made

from fricmodels.diagnosis import examine, refits
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.comparison import Comparison, compare, with_effect
from fricmodels.diagnosis.floor import beyond_sampling_percent
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.refit_check import _falls_far, _helps, _led_by_fit, _share_in_rows, refit_check
from fricmodels.diagnosis.refits import Refits, falls_from
from fricmodels.diagnosis.verdict import LookAlikes, passing_all_gates, select_effect, significant, torque_share
from fricmodels.effects.presliding import Presliding
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.weakform.candidate import within_recording

MASS, COULOMB = 90.0, 20.0
BENT = {"name": "presliding", "kind": "maxwell-slip", "width": 0.0009, "damping_ratio": 0.5}


def axis(*effects: dict[str, object], seed: int) -> Rig:
    """Return an axis that rests between moves: its contact bends within the few samples about each rest."""
    return Rig.model_validate(
        {
            "motion": "linear",
            "inertia": MASS,
            "friction": {"viscous": 60.0, "coulomb": COULOMB},
            "effects": effects,
            "excitation": {
                "kind": "trapezoid",
                "velocity": 0.45,
                "acceleration": 0.7,
                "span": 1.2,
                "rests": [0.1, 3.0],
                "slowest": 0.4,
                "bandwidth": 4.0,
                "damping_ratio": 0.8,
            },
            "sensors": {"velocity_noise_percent": 1.0, "position": True},
            "rate": 100,
            "samples": 12_000,
            "seed": seed,
        }
    )


@pytest.fixture(scope="module", params=(5, pytest.param(6, marks=pytest.mark.long)))
def bent(request: pytest.FixtureRequest) -> Comparison:
    """A contact that bends; the rows see a gap in one recording and nothing at all in the other."""
    return compare(axis(BENT, seed=request.param).simulate(), "coulomb-viscous", MASS)


@pytest.fixture(scope="module")
def stiff() -> Comparison:
    return compare(axis(seed=5).simulate(), "coulomb-viscous", MASS)


def first(comparison: Comparison, *names: str) -> LookAlikes | None:
    """Return what the rows name."""
    return select_effect(
        candidate_tests(replace(comparison.problem), comparison.estimate.parameters, only=names or None)
    )


def test_the_rows_alone_do_not_see_the_contact_bend(bent: Comparison) -> None:
    seen = first(bent)
    assert seen is None or "presliding" not in seen.names


@pytest.mark.long
def test_it_is_named_on_all_motion_with_the_friction_that_it_has(bent: Comparison) -> None:
    diagnosis = examine(bent)
    (finding,) = diagnosis.findings
    assert finding.names == ("presliding",)
    assert finding.tested.parameters["F_1"] == pytest.approx(COULOMB, rel=0.2)
    assert finding.tested.parameters["F_2"] == pytest.approx(COULOMB, rel=0.2)


@pytest.mark.long
def test_nothing_is_named_on_the_same_motion_of_a_stiff_contact(stiff: Comparison) -> None:
    assert examine(stiff).verdict == "adequate"
    result = candidate_tests(replace(stiff.problem), stiff.estimate.parameters)
    assert refit_check(Refits(stiff, POLICY), result, (), None) is None


@pytest.mark.long
def test_an_effect_whose_size_the_fit_takes_to_a_bound_is_not_named(
    bent: Comparison, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A contact that closes within two samples of a reversal does what sampling does."""
    refits = Refits(bent, POLICY)
    result = candidate_tests(replace(bent.problem), bent.estimate.parameters, only=["presliding"])
    tested = result.tested[0]
    assert not refits.ends_at_bound(tested)
    assert _helps(refits, tested, POLICY)
    assert refit_check(refits, result, (), None) is not None
    fitted = refits.with_effect(tested)
    assert fitted is not None
    least = within_recording(fitted.problem, Presliding.x_s).lower
    values = {**fitted.estimate.parameters, "presliding.x_s": least}
    at_bound = replace(fitted, estimate=replace(fitted.estimate, parameters=values))
    monkeypatch.setattr(Refits, "with_effect", lambda self, other: at_bound if other.name == tested.name else None)
    assert refits.ends_at_bound(tested)
    assert not _helps(refits, tested, POLICY)
    assert refit_check(refits, result, (), None) is None


@pytest.mark.parametrize("far", [False, True])
@pytest.mark.parametrize("rises", [False, True])
def test_what_does_not_fall_far_must_fall_in_what_sampling_does_not_hide(
    bent: Comparison, rises: bool, far: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def beyond(comparison: Comparison) -> float:
        return 1.0 if (comparison.drive.model.effects != ()) is rises else 0.5

    monkeypatch.setattr("fricmodels.diagnosis.refit_check.beyond_sampling_percent", beyond)
    monkeypatch.setattr("fricmodels.diagnosis.refit_check._falls_far", lambda *_: far)
    result = candidate_tests(replace(bent.problem), bent.estimate.parameters, only=["presliding"])
    assert _helps(Refits(bent, POLICY), result.tested[0], POLICY) is (far or not rises)


def test_what_sampling_does_not_hide_falls_with_a_contact_that_bends(bent: Comparison) -> None:
    result = candidate_tests(replace(bent.problem), bent.estimate.parameters, only=["presliding"])
    fitted = Refits(bent, POLICY).with_effect(result.tested[0])
    assert fitted is not None
    assert beyond_sampling_percent(fitted) < beyond_sampling_percent(bent)


@pytest.mark.long
def test_without_it_no_other_one_takes_its_place(bent: Comparison) -> None:
    assert not examine(bent, leave_out=["presliding"]).findings


@pytest.mark.parametrize(
    ("name", "helps"),
    [("backlash", False), ("presliding", True)],
)
@pytest.mark.long
def test_what_the_rows_name_stands_only_if_the_error_falls_with_it(bent: Comparison, name: str, helps: bool) -> None:
    result = candidate_tests(replace(bent.problem), bent.estimate.parameters, only=[name])
    (tested,) = result.tested
    assert torque_share(result, tested.evidence) < 0.2 * bent.sliding.held_out_percent / 100
    with_it = with_effect(bent, tested.effect, tested.parameters)
    assert (with_it.sliding.held_out_percent < (1 - POLICY.least_gain) * bent.sliding.held_out_percent) is helps
    found = refit_check(Refits(bent, POLICY), result, ["presliding"], LookAlikes(tested, (tested,)))
    assert (found is not None) is helps


def test_an_effect_without_memory_is_left_as_the_rows_name_it(stiff: Comparison) -> None:
    result = candidate_tests(replace(stiff.problem), stiff.estimate.parameters, only=["torque-offset"])
    named = LookAlikes(result.tested[0], result.tested)
    assert refit_check(Refits(stiff, POLICY), result, (), named) is named


def test_the_model_with_it_is_fitted_to_all_motion(bent: Comparison, request: pytest.FixtureRequest) -> None:
    with_it = with_effect(bent, Presliding(), {"F_1": 60.0, "F_2": 60.0, "D": 100.0, "x_s": 3e-4})
    assert with_it.drive.inertia == MASS
    bent_torque, error = (
        each["presliding.F_1"] for each in (with_it.estimate.parameters, with_it.estimate.standard_errors)
    )
    assert bent_torque == pytest.approx(COULOMB, rel=0.3)
    assert abs(bent_torque - COULOMB) < 3.5 * error
    before, after = ({band.window_ms: band for band in each.errors.bands}[20.0] for each in (bent, with_it))
    assert with_it.sliding.held_out_percent < 0.85 * bent.sliding.held_out_percent
    assert after.percent < 0.82 * before.percent
    assert after.held_out_percent < 0.82 * before.held_out_percent
    # The errors of the decisions held directions that smoothing turned, or that nobody knows: 5.01 and 5.99 without the
    # effect, where it is 3.9 and 4.5. Of the first ones 0.75 and 0.7 were asked for, which is more than these limits.
    most, most_kept_back = {5: (3.0, 3.1), 6: (4.0, 4.1)}[request.node.callspec.params["bent"]]
    assert with_it.sliding.percent < most
    assert with_it.sliding.held_out_percent < most_kept_back


def test_all_motion_has_the_rows_and_more(bent: Comparison) -> None:
    rows, all_motion = bent.problem, bent.problem.including_uncertain_motion
    assert all_motion.rows > rows.rows
    assert np.isin(rows.centre, all_motion.centre).mean() > 0.99
    assert all_motion.estimated == rows.estimated
    resting = rows.resting[all_motion.centre]
    assert not resting.any()


@pytest.mark.parametrize(
    ("before", "after", "far"),
    [(10.0, 8.9, True), (10.0, 9.1, False), (5.0, 4.4, True), (3.0, 2.7, False), (1.6, 0.4, True), (1.4, 0.0, False)],
)
def test_an_error_falls_far_by_its_size_and_its_share(before: float, after: float, far: bool) -> None:
    assert _falls_far(before, after, POLICY) is far


def test_the_rows_see_hardly_anything_of_a_bending_contact_and_all_of_an_offset(bent: Comparison) -> None:
    problem = replace(bent.problem)
    result = candidate_tests(
        problem.including_uncertain_motion, bent.estimate.parameters, only=["presliding", "torque-offset"]
    )
    share = {tested.name: _share_in_rows(problem, tested) for tested in result.tested}
    assert share["presliding"] < 0.1
    assert share["torque-offset"] == pytest.approx(1.0, abs=0.1)


def resonance(seed: int, *, hidden: bool = True) -> Comparison:
    """A joint that rings faster than the rows resolve: they see less of it than an effect must come to."""
    ringing = {"name": "joint-compliance", "frequency": 225.0, "load_inertia_share": 0.5, "damping_ratio": 0.034}
    rig = Rig.model_validate(
        {
            "inertia": 2.1,
            "friction": {"viscous": 11.0, "coulomb": 11.0},
            "effects": [ringing] if hidden else [],
            "excitation": {
                "kind": "trapezoid",
                "velocity": 1.08,
                "acceleration": 8.34,
                "span": 0.56,
                "rests": [0.016, 0.81],
                "slowest": 0.4,
                "bandwidth": 30.5,
                "damping_ratio": 0.97,
            },
            "sensors": {"velocity_noise_percent": 0.6, "position": True},
            "rest_speed": 1e-4,
            "rate": 945,
            "samples": 20_000,
            "seed": seed,
        }
    )
    return compare(rig.simulate(), "coulomb-viscous", 2.1)


@pytest.mark.long  # what is named on all motion, and how far an error falls, is above
@pytest.mark.parametrize("seed", [3])  # all of 3 to 8 are named
def test_what_the_rows_see_as_too_small_is_named_if_the_error_falls_far(seed: int) -> None:
    rung = resonance(seed)
    result = candidate_tests(replace(rung.problem), rung.estimate.parameters, only=["joint-compliance"])
    (tested,) = result.tested
    assert torque_share(result, tested.evidence) < POLICY.least_torque
    assert tested.evidence.explained > 0.8
    diagnosis = examine(rung)
    assert [finding.names for finding in diagnosis.findings] == [("joint-compliance",)]
    assert examine(resonance(seed, hidden=False)).verdict == "adequate"
    # What falls below the noise of single samples counts for nothing: if all of the error is noise there is no name.
    assert refit_check(Refits(rung, POLICY), result, (), None) is not None
    sample = rung.errors.bands[0]
    noisy = replace(POLICY, noise_known_to=sample.held_out_percent / sample.noise_floor_percent)
    assert refit_check(Refits(rung, noisy), replace(result, policy=noisy), (), None) is None


def test_an_effect_that_comes_out_as_nothing_is_not_what_lowers_the_error(
    stiff: Comparison, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where its coefficients are zero the rest of the model was fitted better, and that is no sign of the effect.

    Nor is it where the recording determines none of them. It is where their sum is determined, and one held at 0.
    """
    result = candidate_tests(replace(stiff.problem), stiff.estimate.parameters, only=["torque-offset", "asymmetry"])
    why, wide, narrow = "not determined", 0.05, 0.001
    cases: list[tuple[str, dict[str, float], list[str], float, bool]] = [
        ("torque-offset", {"tau_0": 0.3}, [], narrow, True),
        ("torque-offset", {"tau_0": 0.0}, [], narrow, False),
        ("torque-offset", {"tau_0": 0.3}, ["tau_0"], 0.3, True),  # the size of a single one may be uncertain
        ("asymmetry", {"c": 0.03, "d": 0.01}, ["d"], wide, True),
        ("asymmetry", {"c": 0.03, "d": 0.01}, ["c", "d"], wide, False),
        ("asymmetry", {"c": 0.03, "d": 0.0}, ["c", "d"], narrow, True),
    ]
    for name, own, doubtful, error, stays in cases:
        tested = next(t for t in result.tested if t.name == name)
        fitted = with_effect(stiff, tested.effect, tested.parameters)
        values = {**fitted.estimate.parameters, **{f"{name}.{symbol}": value for symbol, value in own.items()}}
        unknown = {f"{name}.{symbol}": why for symbol in doubtful}
        errors = {**fitted.estimate.standard_errors, **dict.fromkeys(unknown, error)}
        estimate = replace(fitted.estimate, parameters=values, not_identified=unknown, standard_errors=errors)
        given = replace(fitted, estimate=estimate)
        monkeypatch.setattr(refits, "with_effect", lambda *_, given=given: given)
        assert (Refits(stiff, POLICY).with_effect(tested) is not None) is stays
        monkeypatch.undo()


@pytest.mark.parametrize(
    ("samples", "names"),
    [
        pytest.param(0.6, [], marks=pytest.mark.long),
        pytest.param(0.64, [], marks=pytest.mark.long),
        (0.7, ["sensor-delay"]),
        pytest.param(1.2, ["sensor-delay"], marks=pytest.mark.long),
    ],
)
def test_a_delay_is_named_from_where_the_rows_see_it(
    made: Callable[..., Recording], samples: float, names: list[str]
) -> None:
    """Rows allow a shift by 0.6 samples: of more they see what is beyond that, at first too small a part for a name."""
    recording = made(noise=1.0, rate=100.0, samples=4000)
    time = recording.time
    late = recording.with_channels(torque=CubicSpline(time, recording.torque)(time + samples / 100.0))
    comparison = compare(late, "coulomb-viscous", 2.0)
    diagnosis = examine(comparison)
    assert diagnosis.result is not None
    assert [name for finding in diagnosis.findings for name in finding.names] == names
    small = [t for t in significant(diagnosis.result) if t not in passing_all_gates(diagnosis.result)]
    assert ("sensor-delay" in [t.name for t in small]) == (samples == 0.64)
    if names:
        found = diagnosis.findings[0].tested
        assert found.parameters["T"] == pytest.approx(samples / 100.0, rel=0.02)
        after = with_effect(comparison, found.effect, found.parameters)
        assert after.errors.held_out_percent < 0.5 * comparison.errors.held_out_percent


def led(made: Made, truth: dict[str, float], *names: str, once: float = 1e-9, bound: str = "") -> list[str]:
    """Return a class in the order in which it is named; the first of ``names`` is its first in the rows.

    ``once`` is the p-value of the others with what repeats counted once, ``bound`` is at its search bound.
    """
    effect = next(iter(truth)).partition(".")[0]
    comparison = compare(made(f"coulomb-viscous+{effect}", truth), "coulomb-viscous", 2.0)
    result = candidate_tests(replace(comparison.problem), comparison.estimate.parameters, only=names)
    members = tuple(replace(next(t for t in result.tested if t.name == name), once=once) for name in names)
    members = tuple(replace(t, found=replace(t.found, at_search_bound=t.name == bound)) for t in members)
    return _led_by_fit(Refits(comparison, POLICY), LookAlikes(members[0], members), POLICY).names


def test_of_look_alikes_that_which_fits_the_record_comes_first(made: Made) -> None:
    truth = {"gravity.a": 0.6, "gravity.b": 0.3}
    assert led(made, truth, "stiffness", "gravity")[0] == "gravity"
    assert led(made, truth, "gravity", "stiffness")[0] == "gravity"
    assert led(made, truth, "stiffness", "gravity", once=0.5) == ["stiffness", "gravity"], "it repeats, and is not sure"
    assert led(made, truth, "stiffness", "gravity", bound="gravity") == ["stiffness", "gravity"]


@pytest.mark.parametrize("least", [0.8, 0.1])
def test_what_explains_less_than_half_or_leaves_far_more_is_no_look_alike(
    made: Made, monkeypatch: pytest.MonkeyPatch, least: float
) -> None:
    """A torque ripple of 23.1 % stood in a class whose first left 3.8 of 22.8, a cogging of 25 beside 4.6 of 77 %."""
    truth = {"gravity.a": 0.6, "gravity.b": 0.3}
    sliding = compare(made("coulomb-viscous+gravity", truth), "coulomb-viscous", 2.0).sliding
    before, noise = sliding.held_out_percent, sliding.held_out_noise_percent / sliding.held_out_percent
    border = min(np.sqrt(0.5 * (1.0 + least**2)), 1.5 * max(least, noise))
    for share, names in ((1.01 * border, ["gravity"]), (0.99 * border, ["gravity", "stiffness"])):
        errors = {"gravity": least * before, "stiffness": share * before}
        monkeypatch.setattr(Refits, "test_error", lambda _, tested, errors=errors: errors[tested.name])
        assert led(made, truth, "stiffness", "gravity") == names


def test_what_happened_once_gives_way_to_what_repeats_and_fits_as_well(made: Made) -> None:
    assert led(made, {"torque-offset.tau_0": 0.4}, "step-change", "torque-offset")[0] == "torque-offset"
    once = {"step-change.c": 0.5, "step-change.t_0": 7.0}
    assert led(made, once, "step-change", "torque-offset")[0] == "step-change"


@pytest.mark.parametrize(
    ("decisions", "printed", "falls"),
    [
        (6.05, 1.81, True),
        (6.05, 5.7, False),
        (12.0, 3.5, False),
        (5.8, 5.8, True),
        (5.8, 5.9, False),
        (5.8, 6.1, False),
        (0.0, 0.0, True),
    ],
)
def test_the_printed_error_must_fall_by_more_than_that_of_the_decisions_rises(
    decisions: float, printed: float, falls: bool
) -> None:
    """An impact shows in the balance of momentum only: from 5.82 and 6.01 % a backlash came to 6.05 and 1.81 %.

    Where that of the decisions falls, the square of the printed one must fall by a twentieth.
    """
    assert falls_from(scored(5.82, 6.01), scored(decisions, printed), POLICY) is falls


@pytest.mark.parametrize(("noise", "falls"), [(0.5, True), (4.4, False)])
def test_what_falls_below_noise_counts_for_nothing(noise: float, falls: bool) -> None:
    """A link that takes all of the inertia takes the noise of the acceleration, too: 5.18 to 1.62 %."""
    assert falls_from(scored(0.717, 5.175, noise), scored(1.334, 1.62, noise), POLICY) is falls


def scored(sliding: float, headline: float, noise: float = 0.5) -> Any:
    """Return a comparison with the test errors of the decisions and of the headline, and the floor of the latter."""
    bands = [SimpleNamespace(held_out_percent=headline)]
    first = SimpleNamespace(noise_floor_percent=noise)
    errors = SimpleNamespace(held_out_percent=headline, bands=bands, headline=first)
    return SimpleNamespace(sliding=SimpleNamespace(held_out_percent=sliding), errors=errors)
