"""Fits to simulated motion: the truth within its intervals, windows where a force drifts, larger models never worse."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import kept_back, ready
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.model import Model
from fricmodels.motion import Controller, Rung, Simulator, fit_motion, judged, motion_errors
from fricmodels.motion.evolution import evolved
from fricmodels.motion.fit import Problem
from fricmodels.motion.least_squares import minimised
from fricmodels.motion.search import searched
from fricmodels.motion.validate import folds
from fricmodels.recording import Recording
from fricmodels.simulation import simulate

TRUE = {"J": 0.01, "K_v": 0.05, "K_c": 0.03}
STRIBECK = {"stribeck.F_s": 0.02, "stribeck.omega_s": 0.5, "stribeck.delta": 1.0}
START = {"J": 0.013, "K_v": 0.03, "K_c": 0.05}


def drive(name: str = "coulomb-viscous") -> Drive:
    return Drive(Model.parse(name))


def recorded(
    count: int = 4000,
    noise: float = 0.0,
    force: float = 0.0,
    seed: int = 0,
    name: str = "coulomb-viscous",
    **values: float,
) -> Recording:
    """A simulated recording with noise on its position [rad], and a slow force that no channel has [N m]."""
    time = np.arange(count) * 1e-3
    torque = 0.15 * np.sin(3.0 * time) + 0.08 * np.sin(7.1 * time + 1.0)
    random = np.random.default_rng(seed)
    steps = np.convolve(random.standard_normal(count + 500), np.ones(500) / 500**0.5, mode="valid")[:count]
    made = simulate(Drive(Model.parse(name)), {**TRUE, **values}, time, torque + force * steps, with_position=True)
    position = made["position"] + noise * random.standard_normal(count)
    return made.with_channels(derived=False, torque=torque, position=position)


def test_the_truth_is_recovered_within_its_intervals() -> None:
    """Of noisy positions; over seeds the intervals hold as often as they say, within what so few can tell."""
    inside = []
    for seed in range(6):
        fit = fit_motion(Simulator(drive(), recorded(noise=2e-3, seed=seed)), [START])
        assert fit.converged
        errors = fit.standard_errors
        inside += [abs(fit.parameters[key] - TRUE[key]) < 1.96 * errors[key] for key in TRUE]
        assert all(errors[key] < 0.2 * TRUE[key] for key in TRUE)
    assert np.mean(inside) > 0.8


def test_without_noise_the_fit_is_exact() -> None:
    recording = recorded()
    simulator = Simulator(drive(), recording, initial_samples=1)
    for objective in ("position", "velocity"):
        fit = fit_motion(simulator, [START], objective=objective)
        assert fit.parameters == pytest.approx(TRUE, rel=1e-4)


def test_windows_bear_a_force_that_drifts() -> None:
    """A force that nobody recorded adds up over the record; windows forget it, and their parameters are nearer."""
    free, windows = [], []
    for seed in range(4):
        recording = recorded(count=8000, force=0.01, seed=seed)
        for errors, horizon in ((free, None), (windows, 300)):
            fit = fit_motion(Simulator(drive(), recording, horizon=horizon), [START])
            errors.append(max(abs(fit.parameters[key] / TRUE[key] - 1) for key in TRUE))
    assert np.median(windows) < 0.7 * np.median(free)


def test_a_larger_model_is_never_worse_from_the_optimum_of_the_smaller_one() -> None:
    recording = recorded(noise=1e-3, name="coulomb-viscous+stribeck", **STRIBECK)
    small = fit_motion(Simulator(drive(), recording), [START])
    large = Simulator(drive("coulomb-viscous+stribeck"), recording)
    for speed in (100.0, 0.3):
        start = {"stribeck.F_s": 0.0, "stribeck.omega_s": speed, "stribeck.delta": 1.0}
        fit = fit_motion(large, [{**small.parameters, **start}])
        assert fit.errors.position <= small.errors.position * (1 + 1e-9)
    assert fit.errors.position < small.errors.position


def test_absolute_errors_bear_a_few_gross_ones() -> None:
    recording = recorded()
    position = recording["position"].copy()
    position[1000:1150] += 3.0
    spoilt = recording.with_channels(derived=False, position=position)
    simulator = Simulator(drive(), spoilt)
    squares = fit_motion(simulator, [START])
    absolute = fit_motion(simulator, [START], loss="absolute")
    assert max(abs(absolute.parameters[key] / TRUE[key] - 1) for key in TRUE) < 0.01
    assert max(abs(squares.parameters[key] / TRUE[key] - 1) for key in TRUE) > 0.05


def test_constants_of_a_motor_are_found_through_the_closed_loop() -> None:
    """The torque was not recorded; gain and reference are known, torque constant and friction are found."""
    motor = {"resistance": 2.0, "supply": 1.0}
    controller = Controller.model_validate(
        {"kind": "pd", "reference": "reference", "gain": 10.0, "derivative": 0.5, "limit": 4.0, "motor": motor}
    )
    time = np.arange(4000) * 1e-3
    reference = np.sin(3.0 * time) + 0.4 * np.sin(8.0 * time)
    channels = {"time": time, "torque": np.zeros(4000), "position": np.zeros(4000), "velocity": np.zeros(4000)}
    channels["other.reference"] = reference
    base = recorded()
    empty = Recording("closed", base.motion, channels, np.zeros(4000, dtype=np.int64))
    truth = {**TRUE, "loop.k_t": 0.2}
    loop, known = controller.loop(), Drive(Model.parse("coulomb-viscous"), TRUE["J"])  # else no torque has a scale
    position, velocity = Simulator(known, empty, loop=loop)(truth)
    noisy = position + 1e-4 * np.random.default_rng(0).standard_normal(4000)
    recording = empty.with_channels(derived=False, position=noisy, velocity=velocity)
    fit = fit_motion(Simulator(known, recording, loop=loop), [{**START, "loop.k_t": 0.15}])
    assert fit.estimated == ("K_v", "K_c", "loop.k_t")
    assert fit.parameters["loop.R"] == 2.0
    for key, value in truth.items():
        assert fit.parameters[key] == pytest.approx(value, rel=0.02)


def test_the_structure_is_chosen_by_what_was_kept_back() -> None:
    """A Stribeck effect that is there is taken; without one the smaller model is, though the larger fits no worse."""
    names = ("coulomb-viscous", "coulomb-viscous+stribeck")
    extra = {"stribeck.F_s": 0.01, "stribeck.omega_s": 0.5, "stribeck.delta": 1.0}
    rungs = [Rung(drive(names[0]), START), Rung(drive(names[1]), {**START, **extra})]
    taken = []
    for there in (True, False):
        values = STRIBECK if there else {}
        whole = recorded(count=8000, noise=1e-3, name=names[there], **values)
        pieces = np.arange(8000) // 1000
        train, test = whole.select(pieces % 3 != 1), whole.select(pieces % 3 == 1)
        apart = [part.with_channels(derived=False) for part in (train, test)]
        masks = (pieces % 3 != 1, pieces % 3 == 1)
        cut = [Recording(p.name, p.motion, p.channels, pieces[m]) for p, m in zip(apart, masks, strict=True)]
        found = judged(rungs, *cut)
        assert sum(each.chosen for each in found) == 1
        taken.append(next(each.rung.name for each in found if each.chosen))
        assert motion_errors(found[0].kept, START).position > found[0].test.position  # type: ignore[union-attr]
    assert taken == [names[1], names[0]]


def test_bounds_hold_and_what_has_no_effect_stays() -> None:
    """A minimum outside of the bounds is found on them; a parameter that changes nothing stays where it was."""
    target = np.array([3.0, -2.0])
    at = minimised(
        lambda x: np.array([x[0] - target[0], 10 * (x[1] - target[1]) * (1 + 0.1 * x[0]), 0.0]),
        np.array([0.0, 0.0, 7.0]), np.ones(3), (np.array([-1.0, -1.0, 0.0]), np.array([1.0, 5.0, 9.0])),
    ).at  # fmt: skip
    assert at[1:] == pytest.approx([-1.0, 7.0])
    assert -1.0 <= at[0] <= 1.0


def test_a_fit_that_cannot_begin_says_so() -> None:
    simulator = Simulator(drive(), recorded())
    unstable = Simulator(drive("coulomb-viscous+stiffness"), recorded())
    with pytest.raises(EstimationError, match="horizon"):
        fit_motion(unstable, [{**TRUE, "stiffness.k": -1e9, "stiffness.tau_0": 0.0}])
    assert Problem.of(simulator).keys == ("J", "K_v", "K_c")


@pytest.mark.long
def test_each_part_is_held_out_in_turn_where_one_recording_was_cut() -> None:
    """What was not there is not taken, what was is; by one recording cut as `improve` cuts it."""
    names = ("coulomb-viscous", "coulomb-viscous+stribeck")
    extra = {"stribeck.F_s": 0.01, "stribeck.omega_s": 0.5, "stribeck.delta": 1.0}
    rungs = [Rung(drive(names[0]), START), Rung(drive(names[1]), {**START, **extra})]
    for there in (True, False):
        whole = recorded(count=3000, noise=1e-3, name=names[there], **(STRIBECK if there else {}))
        found = judged(rungs, *kept_back(ready(whole)))
        assert [each.chosen for each in found] == ([False, True] if there else [True, False])
        assert found[there].behind[0] <= found[there].behind[1]


def test_parts_that_are_held_out_cover_the_recording_once() -> None:
    prepared = ready(recorded(count=600))
    parts = folds(prepared)
    assert len(parts) == 6
    assert np.array_equal(np.sort(np.concatenate([part.held_out.time for part in parts])), prepared.time)
    assert all(len(part.fitted) + len(part.held_out) == 600 for part in parts)
    runs = prepared.select(np.arange(600))
    many = Recording("runs", runs.motion, runs.channels, np.arange(600) // 50)
    assert [np.unique(part.held_out.run).tolist() for part in folds(many)] == [[2 * i, 2 * i + 1] for i in range(6)]


def test_a_search_with_kinks_goes_on_where_derivatives_stop() -> None:
    """Many small steps on a bowl: a search by derivatives ends on one of them; a smooth bowl is left alone."""

    def rough(x: np.ndarray) -> np.ndarray:
        return np.array([x[0] - 3 + 0.5 * np.sin(25 * x[0]), 2 * (x[1] + 1) + 0.5 * np.sin(25 * x[1]), 1.0])

    bounds = (np.full(2, -10.0), np.full(2, 10.0))
    start, size = np.zeros(2), np.full(2, 0.01)
    with_kinks = searched(rough, [start], size, bounds)
    without = searched(rough, [start], size, bounds, kinks=False)
    assert with_kinks.cost <= without.cost
    assert with_kinks.cost < 1.02
    assert searched(rough, [start], size, bounds).at.tolist() == with_kinks.at.tolist()
    smooth = searched(lambda x: np.array([x[0] - 3, 2 * (x[1] + 1), 1.0]), [start], size, bounds)
    assert smooth.at == pytest.approx([3, -1], abs=1e-6)
    assert smooth.evaluations < 120


def test_evolution_finds_the_bottom_of_a_bent_valley() -> None:
    """Rosenbrock's, with a bound that cuts the way to it off, too."""

    def banana(x: np.ndarray) -> float:
        return float(100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2)

    free = (np.full(2, -5.0), np.full(2, 5.0))
    assert evolved(banana, np.array([-1.0, 1.0]), np.eye(2), free, most=2000).at == pytest.approx([1, 1], abs=1e-2)
    short = (np.full(2, -5.0), np.array([0.5, 5.0]))
    assert evolved(banana, np.array([-1.0, 1.0]), np.eye(2), short, most=2000).at == pytest.approx(
        [0.5, 0.25], abs=1e-2
    )
    nowhere = evolved(lambda x: float("nan"), np.zeros(2), np.eye(2), free, most=50)
    assert np.isinf(nowhere.cost)
