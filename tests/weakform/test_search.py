"""Nonlinear parameters of candidates: wave numbers, instants and widths are found where they were hidden."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricmodels.diagnosis import candidate_tests as surveys
from fricmodels.diagnosis.candidate_tests import candidate_tests, noise_share
from fricmodels.dimension import ACCELERATION, DISPLACEMENT, FORCE, INERTIA, TIME, VELOCITY, Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.weakform.candidate import Candidate, within_recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.ranges import natural_size, scan_size
from fricmodels.weakform.search import _summit, search, starting_points

Made = Callable[..., Recording]


def examined(recording: Recording, effect: str) -> surveys.CandidateTest:
    """Return one candidate's test on what a Coulomb-viscous drive leaves over."""
    drive = Drive(Model.parse("coulomb-viscous"), 2.0, recording.motion)
    problem, found = estimate(drive, recording)
    (only,) = candidate_tests(problem, found.parameters, only=[effect]).tested
    return only


CASES: list[tuple[str, Mapping[str, float], str, float]] = [
    ("cogging", {"a": 0.3, "b": 0.4, "a_2": 0.1, "b_2": 0.0, "k": 3.37}, "k", 0.002),
    ("cogging", {"a": 0.3, "b": 0.4, "a_2": 0.1, "b_2": 0.0, "k": 11.9}, "k", 0.002),
    ("position-friction", {"a": 0.5, "b": 0.0, "a_2": 0.0, "b_2": 0.1, "k": 2.6}, "k", 0.002),
    ("torque-ripple", {"a": 0.0, "b": 0.02, "a_2": 0.0, "b_2": 0.0, "k": 6.1}, "k", 0.002),
    ("step-change", {"c": 0.6, "d": 0.2, "t_0": 6.3}, "t_0", 0.001),
    ("step-change", {"c": -0.4, "d": 0.0, "t_0": 11.1}, "t_0", 0.001),
    ("presliding", {"F_1": 3.0, "F_2": 3.0, "D": 0.0, "x_s": 0.05}, "x_s", 0.01),
    ("stribeck", {"F_s": 3.0, "omega_s": 1.0, "delta": 1.0}, "omega_s", 0.05),
]


@pytest.mark.parametrize(("effect", "hidden", "symbol", "within"), CASES)
def test_what_was_hidden_is_found(
    made: Made, effect: str, hidden: Mapping[str, float], symbol: str, within: float
) -> None:
    recording = made(f"coulomb-viscous+{effect}", {f"{effect}.{key}": value for key, value in hidden.items()})
    found = examined(recording, effect)
    assert found.parameters[symbol] == pytest.approx(hidden[symbol], rel=within)
    assert found.p_value < 1e-6
    assert found.evidence.explained > 0.6
    spread = np.sqrt(np.diag(found.evidence.covariance))
    linear = [key for key, kept in zip(found._linear_symbols, found.found.kept, strict=True) if kept]
    largest = max(abs(hidden[key]) for key in linear)
    for key, error in zip(linear, spread, strict=True):
        # The first test holds the nonlinear parameters at their estimates: a hundredth of bias is allowed for that.
        assert abs(found.parameters[key] - hidden[key]) < 4 * error + 0.01 * largest, key


def test_the_wave_number_does_not_depend_on_the_units_of_torque(made: Made) -> None:
    recording = made(
        "coulomb-viscous+cogging",
        {"cogging.a": 0.5, "cogging.b": 0.0, "cogging.a_2": 0.1, "cogging.b_2": 0.0, "cogging.k": 5.3},
    )
    drive = Drive(Model.parse("coulomb-viscous"), 2.0)
    problem, found = estimate(drive, recording)
    (one,) = candidate_tests(problem, found.parameters, only=["cogging"]).tested
    big = recording.with_channels(torque=1000 * recording.torque)
    problem, found = estimate(Drive(drive.model, 2000.0), big)
    (other,) = candidate_tests(problem, found.parameters, only=["cogging"]).tested
    assert other.parameters["k"] == pytest.approx(one.parameters["k"], rel=1e-9)
    assert other.parameters["a"] == pytest.approx(1000 * one.parameters["a"], rel=1e-6)
    assert other.evidence.explained == pytest.approx(one.evidence.explained, rel=1e-6)


def test_natural_sizes_are_the_recordings_own(made: Made) -> None:
    recording = made(noise=0.0)
    peak, span = np.max(np.abs(recording.velocity)), np.ptp(recording["position"])
    rms = float(np.sqrt(np.mean(recording.torque**2)))
    assert natural_size(recording, VELOCITY) == pytest.approx(peak)
    assert natural_size(recording, DISPLACEMENT) == pytest.approx(span)
    assert natural_size(recording, TIME) == pytest.approx(np.ptp(recording.time))
    assert natural_size(recording, FORCE) == pytest.approx(rms)
    assert natural_size(recording, VELOCITY**-1) == pytest.approx(1 / peak)
    assert natural_size(recording, ACCELERATION) == pytest.approx(peak**2 / span)
    assert natural_size(recording, INERTIA) == pytest.approx(rms * span / peak**2)


def test_play_is_found_with_a_load_and_without(made: Made) -> None:
    """Width, braking and the load's share of the inertia; its friction counts only where there is a load torque."""
    hidden = {"J_l": 0.8, "w": 0.02, "a": 3.0, "omega_v": 5.0, "F": 2.4}
    recording = made("coulomb-viscous+backlash", {f"backlash.{key}": value for key, value in hidden.items()})
    found = examined(recording, "backlash")
    assert found.evidence.explained > 0.9
    for symbol in ("J_l", "w", "a"):
        assert found.parameters[symbol] == pytest.approx(hidden[symbol], rel=0.3), symbol
    load_torque = np.zeros(len(recording))
    loaded = examined(recording.with_channels(load_torque=load_torque, derived=False), "backlash")
    assert loaded.parameters == pytest.approx(found.parameters)
    assert loaded.found.trials == found.found.trials


# ---- columns that consist of noise ------------------------------------------------------------------------------


def test_the_share_of_noise_grows_with_its_square(made: Made) -> None:
    shares = []
    for noise in (0.1, 1.0):
        recording = made(noise=noise, samples=4000)
        drive = Drive(Model.parse("coulomb-viscous"), 2.0)
        problem, found = estimate(drive, recording)
        result = candidate_tests(problem, found.parameters, only=["gravity"])
        effect = load().effects["nonlinear-viscous"]()
        (candidate,) = candidate_tests(problem, found.parameters, only=["nonlinear-viscous"]).tested or (None,)
        assert result.tested
        if candidate is None:
            shares.append(1.0)
            continue
        shares.append(noise_share(problem, problem.perturbed, result.regression, effect, candidate.found))
    assert 0 <= shares[0] < 1e-3
    assert shares[1] > 10 * shares[0]


def test_a_column_of_position_holds_no_noise_of_the_velocity(made: Made) -> None:
    recording = made(noise=3.0, samples=4000)
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    result = candidate_tests(problem, found.parameters, only=["gravity"])
    share = noise_share(
        problem, problem.perturbed, result.regression, load().effects["gravity"](), result.tested[0].found
    )
    assert share < 1e-9


def late(recording: Recording, samples: int) -> Recording:
    """Return the record with the motion, or if negative the motor torque, that many samples late; with a load."""
    load = 2 * np.sin(1.3 * recording.time)
    loaded = recording.with_channels(derived=False, torque=recording.torque + load, load_torque=load)
    delayed = ("velocity", "position") if samples > 0 else ("torque",)
    ahead = {name: values[abs(samples) :] for name, values in loaded.channels.items()}
    behind = {name: loaded.channels[name][: len(recording) - abs(samples)] for name in delayed}
    return Recording("late", recording.motion, {**ahead, **behind}, recording.run[abs(samples) :])


@pytest.mark.parametrize("samples", [25, 3, -4, -18])
def test_a_whole_delay_is_found_and_explains_all(made: Made, samples: int) -> None:
    recording = late(made(noise=0.05), samples)
    found = examined(recording, "sensor-delay")
    assert found.parameters["T"] / recording.interval == pytest.approx(samples, abs=0.2)
    assert found.evidence.coefficients == pytest.approx([found.parameters["T"]], rel=0.02)
    assert found.evidence.explained > 0.97
    assert found.p_value < 1e-6


def test_a_shift_within_a_sample_is_no_delay(made: Made) -> None:
    recording = made(noise=0.05)
    half = (recording.torque[1:] + recording.torque[:-1]) / 2
    shifted = recording.select(slice(1, None)).with_channels(derived=False, torque=half)
    drive = Drive(Model.parse("coulomb-viscous"), 2.0, recording.motion)
    problem, parameters = estimate(drive, shifted)
    tested = candidate_tests(problem, parameters.parameters, only=["sensor-delay"]).tested
    assert all(t.evidence.gain < 0.05 for t in tested)


def test_no_length_is_longer_than_the_travel(made: Made) -> None:
    """A gap that is never crossed would imitate whatever grows with the torque."""
    recording = made("coulomb-viscous+torque-gain", {"torque-gain.g": 0.1})
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    lengths = {"backlash": "w", "presliding": "x_s", "rising-stiction": "x_s"}
    for tested in candidate_tests(problem, found.parameters, only=lengths).tested:
        assert 0 < tested.parameters[lengths[tested.name]] <= np.ptp(recording["position"])


@pytest.mark.parametrize("samples", [0.7, 30.0])
def test_no_duration_is_shorter_than_two_samples(made: Made, samples: float) -> None:
    """Sampling alone delays friction by part of a sample: a lag of that size explains nothing."""
    lagging = {"F_s": 4.0, "omega_s": 0.3, "T": samples * 2e-3, "r": 0.0}
    recording = made("coulomb-viscous+frictional-lag", {f"frictional-lag.{key}": x for key, x in lagging.items()})
    problem, found = estimate(Drive(Model.parse("coulomb-viscous+stribeck"), 2.0), recording)
    (tested,) = candidate_tests(problem, found.parameters, only=["frictional-lag"]).tested
    assert tested.parameters["T"] >= 2.0 * recording.interval * (1 - 1e-9)
    if samples > 2.0:
        assert not tested.found.at_search_bound
        assert tested.parameters["T"] == pytest.approx(samples * recording.interval, rel=0.1)
    else:
        assert tested.evidence.explained < 0.05 or tested.found.at_search_bound


@pytest.mark.parametrize(("lower", "instant"), [(-np.inf, True), (0.0, True), (0.0, False), (-1.0, False)])
def test_an_instant_is_not_bounded_as_a_duration(made: Made, lower: float, instant: bool) -> None:
    """A step at the first sample is possible, a duration of no sample is not, whatever its lower bound."""
    problem, _ = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), made(samples=4000))
    declared = Parameter("t", unit="s", initial=5.0, lower=lower, scan=(0.1, 0.5), instant=instant)
    bounded = within_recording(problem, declared)
    assert (bounded == declared) is instant
    assert (bounded.lower >= 2 * problem.recording.interval) is not instant


@pytest.mark.parametrize("samples", [5_000, 20_000, 80_000])
def test_a_time_of_the_drive_is_sought_where_it_is_however_long_the_record(samples: int) -> None:
    time = np.arange(samples) * 1e-3
    channels = {"time": time, "torque": np.cos(time), "velocity": np.sin(time), "position": -np.cos(time)}
    recording = Recording("sine", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))
    own, whole = Parameter("T", unit="s", own_time=True), Parameter("T", unit="s")
    records = max(samples / 20_000, 1.0)
    assert scan_size(recording, own) == pytest.approx(samples * 1e-3 / records, rel=1e-3)
    assert scan_size(recording, whole) == pytest.approx(samples * 1e-3, rel=1e-3)
    rate, length = replace(own, unit="1/s"), replace(own, unit="rad")
    assert scan_size(recording, rate) == pytest.approx(1e3 / samples * records, rel=1e-3)
    assert scan_size(recording, length) == pytest.approx(2.0, rel=1e-2)


def test_no_duration_is_many_times_the_recordings(made: Made) -> None:
    """A drift in proportion to time has no end of its own."""
    recording = made("coulomb-viscous+drift", {"drift.a": 0.0, "drift.b": 0.1, "drift.T": 1e6})
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    (tested,) = candidate_tests(problem, found.parameters, only=["drift"]).tested
    assert 10 < tested.parameters["T"] / np.ptp(recording.time) <= 15
    assert tested.evidence.explained > 0.9


def test_a_period_must_be_passed_as_a_whole(made: Made) -> None:
    """A stop at one end of the travel is no cogging of a period that the drive never passed."""
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), made())
    cogging = load().effects["cogging"]()
    (wave_number,) = [replace(p, lower=0.1, initial=0.1) for p in cogging.parameters if p.periodic]
    regression = surveys.regression_of(problem, found.parameters)
    *_, (bounded,) = starting_points(problem, regression, problem.alone(cogging), [wave_number])
    assert bounded.lower == pytest.approx(2 * np.pi / np.ptp(problem.recording["position"]), rel=0.01)
    assert bounded.initial >= bounded.lower


@pytest.mark.parametrize(("motion", "seen"), [(Motion.ROTARY, True), (Motion.LINEAR, False)])
def test_a_linear_axis_does_not_turn(made: Made, motion: Motion, seen: bool) -> None:
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0, motion), made(motion=motion))
    result = candidate_tests(problem, found.parameters, only=["gravity"])
    assert bool(result.tested) is seen
    assert ("gravity" in result.untested) is not seen


def test_an_estimated_inertia_has_no_error_of_its_own(made: Made) -> None:
    """Its momentum is that of the velocity, and the acceleration another filter's: their difference is no cause."""
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), None), made())
    result = candidate_tests(problem, found.parameters, only=["inertia-error", "joint-compliance"])
    assert "inertia-error" not in {tested.name for tested in result.tested}
    assert "inertia is estimated" in result.untested["inertia-error"]
    assert "inertia is estimated" not in result.untested.get("joint-compliance", "")


# ---- the end of what a recording can tell -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hidden", "values", "resembles"),
    [
        ("presliding", {"F_1": 3.0, "F_2": 3.0, "D": 0.0, "x_s": 0.05}, "backlash"),
        ("stribeck", {"F_s": 3.0, "omega_s": 0.2, "delta": 1.0}, "rising-stiction"),
    ],
)
def test_what_resembles_an_effect_is_stretched_and_the_effect_is_not(
    made: Made, hidden: str, values: Mapping[str, float], resembles: str
) -> None:
    recording = made(f"coulomb-viscous+{hidden}", {f"{hidden}.{key}": value for key, value in values.items()})
    assert not examined(recording, hidden).found.at_search_bound
    other = examined(recording, resembles)
    assert other.found.at_search_bound
    assert other.evidence.explained > 0.3, "it would be a candidate"


def test_no_parameter_goes_far_beyond_what_is_tried_first(made: Made) -> None:
    recording = made(
        "coulomb-viscous+presliding", {"presliding.F_1": 3.0, "presliding.F_2": 3.0, "presliding.x_s": 0.05}
    )
    found = examined(recording, "backlash")
    for parameter in found.effect.parameters:
        if len(parameter.scan) > 1:
            size = found.parameters[parameter.symbol] / scan_size(recording, parameter)
            assert min(parameter.scan) / 5.001 <= size <= 5.001 * max(parameter.scan), parameter.symbol


def test_the_load_behind_a_gap_has_no_more_friction_than_the_drive(made: Made) -> None:
    recording = made("coulomb-viscous+stribeck", {"stribeck.F_s": 3.0, "stribeck.omega_s": 0.2, "stribeck.delta": 1.0})
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    (tested,) = candidate_tests(problem, found.parameters, only=["backlash"]).tested
    peak = float(np.max(np.abs(recording.velocity)))
    assert 0 < tested.effect.own_friction(peak, tested.parameters) <= problem.friction_limits[1] * (1 + 1e-9)


def test_of_several_starts_that_with_the_highest_summit_goes_to_the_top() -> None:
    """The first start is the highest, but stands beside the lower summit."""

    def two_summits(point: tuple[float, ...]) -> float:
        low, high = (sum((x - at) ** 2 for x in point) for at in (-2.0, 2.0))
        return float(np.exp(-low / 0.5) + 2.0 * np.exp(-high / 0.5))

    starts = [(-2.1, -1.9), (1.3, 2.6)]
    assert two_summits(starts[0]) > two_summits(starts[1])
    top = _summit(two_summits, starts, [(-5.0, 5.0)] * 2, [-0.5, -0.5], 0.0)
    assert top == pytest.approx((2.0, 2.0), abs=1e-4)


def test_a_search_that_cannot_compare_with_a_rival_ends_early(made: Made) -> None:
    recording = made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5})
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    regression = surveys.regression_of(problem, found.parameters)
    effect = load().effects["backlash"]()
    total = float(regression.residual @ regression.residual)
    asked: list[int] = []
    for rival in (0.0, total):
        fresh = replace(problem)
        calls: list[float] = []
        whole = fresh.columns

        def counted(*given: Any, calls: list[float] = calls, whole: Any = whole) -> Any:
            calls.append(1.0)
            return whole(*given)

        object.__setattr__(fresh, "columns", counted)
        search(fresh, regression, effect, fresh.alone(effect), rival)
        asked.append(len(calls))
    assert asked[1] < asked[0]


def test_a_part_of_the_drive_has_no_more_friction_than_the_drive(made: Made) -> None:
    """The same torque, told to be a million times the friction of a part, cannot explain anything."""
    recording = made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5})
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    regression = surveys.regression_of(problem, found.parameters)
    free = load().effects["gravity"]()

    class Part(type(free)):  # type: ignore[misc]
        def own_friction(self, speed: float, parameters: Mapping[str, float]) -> float:
            return 1e6 * sum(abs(value) for value in parameters.values()) * speed

    explained = [
        Candidate(problem, regression, effect, problem.alone(effect)).explained(()) for effect in (free, Part())
    ]
    assert explained[0] > 0.5 * float(regression.residual @ regression.residual)
    assert explained[1] < 1e-3 * explained[0]


@pytest.mark.parametrize("instant", [31.0, 37.0, 45.0])
def test_a_jump_is_found_where_strokes_are_long_and_the_drive_rests(instant: float) -> None:
    """The first stroke is longer than the spacing of the instants that are tried; in a rest all explain the same."""
    rng = np.random.default_rng(4)
    time = 0.01 * np.arange(6000)
    turn = np.mod(time, 14.0)
    rests = ((turn > 6.0) & (turn < 7.0)) | (turn > 13.0)
    velocity = np.where(rests, 0.0, np.where(turn < 7.0, 1.0, -1.0) * np.sin(np.pi * np.mod(turn, 7.0) / 6.0) ** 2)
    friction = (1.0 + 0.4 * (time >= instant)) * np.sign(velocity) + 0.3 * velocity
    channels = {
        "time": time,
        "torque": 2.0 * np.gradient(velocity, time) + friction + 0.02 * rng.standard_normal(6000),
        "velocity": velocity + 1e-3 * rng.standard_normal(6000),
        "position": np.cumsum(velocity) * 0.01,
    }
    found = examined(Recording("few", Motion.ROTARY, channels, np.zeros(6000, dtype=np.int64)), "step-change")
    assert found.parameters["t_0"] == pytest.approx(instant, abs=0.15)
    assert found.parameters["c"] == pytest.approx(0.4, abs=0.03)
