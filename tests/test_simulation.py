"""The simulated drive against closed solutions, against itself refined, and its invariances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.drive import Drive
from fricmodels.effects.of_channel import OfChannel
from fricmodels.errors import InputError
from fricmodels.expressions import Expression
from fricmodels.model import Model
from fricmodels.parameter import Parameter, State
from fricmodels.simulation import measure, simulate, simulated_velocity, simulated_velocity_error
from fricmodels.term import Effect, Parameters, Signals

PAPER = {"K_v1": 1e-4, "K_v2": 6.6e-5, "K_c1": 1e-2, "K_c2": 6.6e-3}
J = 4.87e-6
OMEGA = 39.54


def paper_drive() -> Drive:
    return Drive(Model.parse("asymmetric-coulomb-viscous"), J)


def paper_time(samples: int = 2000) -> np.ndarray:
    return np.arange(samples) * np.pi / 100 / OMEGA


def test_constant_torque_reaches_the_closed_solution() -> None:
    time = np.linspace(0, 0.5, 501)
    values = {"K_v": 1e-4, "K_c": 1e-2}
    recording = simulate(Drive(Model.parse("coulomb-viscous"), J), values, time, 0.02)
    exact = (0.02 - 1e-2) / 1e-4 * (1 - np.exp(-1e-4 / J * time))
    assert np.max(np.abs(recording.velocity - exact)) < 3e-3


def test_coasting_stops_at_the_closed_time_and_stays_at_exactly_zero() -> None:
    values = {"K_v": 0.0, "K_c": 1e-2}
    time = np.linspace(0, 0.1, 1001)
    drive = Drive(Model.parse("coulomb-viscous"), J)
    recording = simulate(drive, values, time, 0.0, initial_velocity=100.0, with_position=True)
    stop = 100.0 * J / 1e-2
    assert np.all(recording.velocity[time > stop] == 0.0)
    assert np.all(recording.velocity[time < stop] > 0.0)
    assert recording["position"][-1] == pytest.approx(100.0 * stop / 2, rel=1e-12)


def test_sticks_below_the_limit_and_breaks_away_at_it() -> None:
    time = np.linspace(0, 1, 1001)
    recording = simulate(paper_drive(), PAPER, time, 0.02 * time)
    assert np.all(recording.velocity[time < 0.4995] == 0.0)
    assert np.all(recording.velocity[time > 0.5005] > 0.0)
    backward = simulate(paper_drive(), PAPER, time, -0.02 * time)
    assert np.all(backward.velocity[time < 0.3295] == 0.0)
    assert np.all(backward.velocity[time > 0.3305] < 0.0)


def test_the_breakaway_instant_is_found_within_a_step() -> None:
    time = np.linspace(0, 1, 14)
    values = {"K_v": 0.0, "K_c": 0.5}
    recording = simulate(Drive(Model.parse("coulomb-viscous"), 1.0), values, time, time)
    assert np.allclose(recording.velocity, np.clip(time - 0.5, 0, None) ** 2 / 2, atol=1e-12)


@pytest.mark.parametrize("law", ["asymmetric-coulomb-viscous", "asymmetric-exponential-stick-slip", "square-root"])
def test_second_order_convergence_through_reversals(law: str) -> None:
    values = {**PAPER, "C_1": 8e-3, "C_2": 5e-3, "B_1": 0.3, "B_2": 0.3, "K_v": 1e-4, "K_c": 8e-3}
    drive = Drive(Model.parse(law), J)
    time = np.linspace(0, 4 * np.pi / OMEGA, 401)
    torque = 0.02 * np.sin(OMEGA * time)
    true = simulate(drive, values, time, torque, substeps=64).velocity
    errors = [
        np.sqrt(np.mean((simulate(drive, values, time, torque, substeps=n).velocity - true) ** 2)) for n in (1, 4)
    ]
    assert errors[0] < 1e-3 * np.max(np.abs(true))
    assert errors[1] < errors[0] / 4


def test_swapping_directions_mirrors_the_motion() -> None:
    time = paper_time(600)
    torque = 0.02 * np.sin(OMEGA * time)
    mirrored = {"K_v1": PAPER["K_v2"], "K_v2": PAPER["K_v1"], "K_c1": PAPER["K_c2"], "K_c2": PAPER["K_c1"]}
    forward = simulate(paper_drive(), PAPER, time, torque)
    backward = simulate(paper_drive(), mirrored, time, -torque)
    assert np.allclose(forward.velocity, -backward.velocity, atol=1e-10)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.01, 100), st.floats(0.01, 100), st.floats(0.01, 100))
def test_scaling_the_units_scales_the_velocity(force: float, displacement: float, seconds: float) -> None:
    time = paper_time(300)
    torque = 0.02 * np.sin(OMEGA * time)
    reference = simulate(paper_drive(), PAPER, time, torque).velocity
    viscous = force * seconds / displacement
    values = {k: v * (viscous if k.startswith("K_v") else force) for k, v in PAPER.items()}
    drive = Drive(Model.parse("asymmetric-coulomb-viscous"), J * force * seconds**2 / displacement)
    scaled = simulate(drive, values, time * seconds, torque * force).velocity
    assert np.allclose(scaled, reference * displacement / seconds, rtol=1e-6, atol=1e-7 * displacement / seconds)


def test_a_load_torque_acts_like_less_motor_torque_and_time_may_be_uneven() -> None:
    rng = np.random.default_rng(1)
    time = np.cumsum(rng.uniform(2e-4, 1.2e-3, 1000))
    torque = 0.02 * np.sin(OMEGA * time)
    load = 0.004 * np.cos(11 * time)
    with_load = simulate(paper_drive(), PAPER, time, torque, load_torque=load)
    without = simulate(paper_drive(), PAPER, time, torque - load)
    assert np.allclose(with_load.velocity, without.velocity, atol=1e-9)


def test_energy_balance() -> None:
    time = paper_time(2000)
    torque = 0.02 * np.sin(OMEGA * time)
    r = simulate(paper_drive(), PAPER, time, torque, substeps=4)
    friction = paper_drive().friction(r, PAPER)
    friction[r.velocity == 0] = 0.0
    power = (r.torque - friction) * r.velocity
    work = np.sum((power[1:] + power[:-1]) / 2 * np.diff(time))
    kinetic = J * r.velocity[-1] ** 2 / 2
    assert abs(work - kinetic) < 2e-3 * np.sum(np.abs(r.torque * r.velocity)) * (time[1] - time[0])


class Bristle(Effect):
    """Dahl's bristle, for this test."""

    name = "test-bristle"
    stiffness = Parameter("stiffness", unit="N m/rad", initial=1.0, lower=0.0)
    limit = Parameter("limit", unit="N m", initial=1.0, lower=0.0)
    z = State("z", unit="rad")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        return p.stiffness * s.z

    def rates(self, s: Signals, p: Parameters) -> dict[str, Expression]:
        from fricmodels.expressions import absolute

        return {"z": s.velocity - p.stiffness * s.z * absolute(s.velocity) / p.limit}


def test_internal_states_are_integrated_and_a_stiff_bristle_is_coulomb_friction() -> None:
    law = Model.parse("coulomb-viscous")
    drive = Drive(law.plus(Bristle()), J)
    time = paper_time(600)
    torque = 0.02 * np.sin(OMEGA * time)
    values = {"K_v": 1e-4, "K_c": 0.0, "test-bristle.stiffness": 30.0, "test-bristle.limit": 8e-3}
    bristle = simulate(drive, values, time, torque, substeps=32).velocity
    coulomb = simulate(Drive(law, J), {"K_v": 1e-4, "K_c": 8e-3}, time, torque).velocity
    assert np.sqrt(np.mean((bristle - coulomb) ** 2)) < 0.03 * np.sqrt(np.mean(coulomb**2))
    finer = simulate(drive, values, time, torque, substeps=128).velocity
    assert np.max(np.abs(finer - bristle)) < 2e-3 * np.max(np.abs(finer))


def test_noise_is_a_percentage_of_the_rms_velocity_and_repeats_by_seed() -> None:
    time = paper_time()
    torque = 0.02 * np.sin(OMEGA * time)
    clean = simulate(paper_drive(), PAPER, time, torque).velocity
    noisy = simulate(paper_drive(), PAPER, time, torque, noise=10, seed=3).velocity
    again = simulate(paper_drive(), PAPER, time, torque, noise=10, seed=3).velocity
    assert np.array_equal(noisy, again)
    assert np.std(noisy - clean) == pytest.approx(0.1 * np.sqrt(np.mean(clean**2)), rel=0.05)


def test_quantisation_and_hold() -> None:
    velocity = np.linspace(0, 1, 101)
    quantised = measure(velocity, quantisation=0.1)
    assert np.allclose(quantised / 0.1, np.round(quantised / 0.1))
    assert np.max(np.abs(quantised - velocity)) <= 0.05 + 1e-12
    held = measure(velocity, hold=5)
    assert np.array_equal(held[:10], np.repeat(velocity[[0, 5]], 5))


def test_simulated_velocity_restarts_at_each_run() -> None:
    import dataclasses

    time = paper_time(800)
    torque = 0.02 * np.sin(OMEGA * time)
    recording = simulate(paper_drive(), PAPER, time, torque)
    two = dataclasses.replace(recording, run=(np.arange(800) >= 333).astype(np.int64))
    assert np.max(np.abs(simulated_velocity_error(paper_drive(), PAPER, two))) < 1e-9
    changed = {**PAPER, "K_c2": 7e-3}
    velocity = simulated_velocity(paper_drive(), changed, two)
    assert velocity[0] == recording.velocity[0]
    assert velocity[333] == recording.velocity[333]
    assert velocity[332] != recording.velocity[332]


def test_bad_input_is_named() -> None:
    with pytest.raises(InputError, match="K_c2"):
        simulate(paper_drive(), {k: v for k, v in PAPER.items() if k != "K_c2"}, [0, 1], 0.0)
    with pytest.raises(InputError, match="increasing"):
        simulate(paper_drive(), PAPER, [0, 0], 0.0)
    with pytest.raises(InputError, match="inertia"):
        simulate(Drive(Model.parse("coulomb-viscous")), {"J": -1, "K_v": 0, "K_c": 0}, [0, 1], 0.0)


@pytest.mark.long
def test_every_effect_can_be_simulated_and_converges() -> None:
    from fricmodels import plugins

    time = paper_time(400)
    torque = 0.02 * np.sin(OMEGA * time)
    small = {"N m": 1e-3, "kg m^2": 5e-7, "1": 0.05, "rad": 1e-2}
    registered = plugins.load().effects
    for effect in registered:
        named = f"{effect}(j2)" if issubclass(registered[effect], OfChannel) else effect
        drive = Drive(Model.parse(f"asymmetric-coulomb-viscous+{named}"), J)
        values = dict(PAPER)
        for parameter in drive.model.parameters:
            declared = parameter.declared
            usual = declared.initial or small.get(declared.unit, 1e-6 if declared.unit.startswith("N m") else 1e-3)
            values.setdefault(parameter.key, float(np.clip(usual, declared.lower, declared.upper)))
        coarse, fine = (
            simulate(
                drive, values, time, torque, load_torque=1e-3 * np.cos(7 * time), temperature=20 + time,
                further={"other.j2": np.sin(5 * time)}, substeps=n,
            ).velocity
            for n in (8, 32)
        )  # fmt: skip
        assert np.max(np.abs(coarse - fine)) < 1e-3 * np.max(np.abs(fine)), effect


@pytest.mark.parametrize("late", [7, -7])
def test_a_delay_of_the_record_is_a_shift_of_the_motion(late: int) -> None:
    """Not the first order of one: the torque moves by seven hundredths of its shortest period."""
    time = np.arange(3000) * 1e-3
    torque = 0.15 * np.sin(3.0 * time) + 0.08 * np.sin(62.0 * time)
    values = {"J": 0.01, "K_v": 0.05, "K_c": 0.03}
    plain = simulate(Drive(Model.parse("coulomb-viscous")), values, time, torque)
    delayed = simulate(
        Drive(Model.parse("coulomb-viscous+sensor-delay")), {**values, "sensor-delay.T": late * 1e-3}, time, torque
    )
    here, there = (plain.velocity, delayed.velocity) if late > 0 else (delayed.velocity, plain.velocity)
    shift, settled = abs(late), 2000  # where the first state, at rest, is forgotten
    assert np.max(np.abs(here[settled:-shift] - there[settled + shift :])) < 2e-3 * np.max(np.abs(here))
    np.testing.assert_array_equal(delayed.torque, torque)
