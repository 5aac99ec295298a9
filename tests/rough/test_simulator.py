"""The simulator of the challenge on rough drives: its torque balance, its limits, and clean drives that come back."""

from __future__ import annotations

import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
H = 1 / 24_000


@pytest.fixture(scope="module")
def rough() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BENCHMARKS))
        from rough import drives, effects, judge, plant, record, trials

        yield type("Rough", (), {m.__name__.split(".")[1]: m for m in (drives, effects, judge, plant, record, trials)})


def moved(
    rough: Any, plant: Any, *, waves: Any = None, seconds: float = 1.0, torque: float = 0.0, kd: float = 20.0
) -> Any:
    """Run a drive behind a speed of 3 sin(8 t) rad/s, and return its course and inputs at every step."""
    time = np.arange(2000) / 2000
    reference = np.stack([np.zeros_like(time), 3 * np.sin(8 * time), np.zeros_like(time)])
    inputs = np.stack([0.7 * np.sin(5 * time), 0.1 * np.cos(3 * time), 1 + 0.2 * time, 1 - 0.1 * time])
    loop = rough.plant.Loop(0.0, 20.0, 0.0, 100.0, 0.0, 1.0, 12)
    waves = rough.plant.NO_WAVES if waves is None else waves
    return rough.plant.simulate(plant, loop, waves, reference, inputs, H), np.repeat(inputs, 12, axis=1)


def test_the_torque_balance_closes_to_machine_precision(rough: Any) -> None:
    """What the drive does at each step is what the written-out equation of all memoryless effects says."""
    p = rough.plant.Plant(
        inertia=0.5,
        coulomb_forward=1.0,
        coulomb_backward=0.8,
        viscous_forward=0.3,
        viscous_backward=0.25,
        offset=0.1,
        stribeck_rise=0.4,
        stribeck_speed=0.3,
        stribeck_exponent=1.5,
        power_coefficient=0.05,
        power_exponent=2.0,
        load_friction=0.1,
        driving_loss=0.2,
        driven_loss=0.05,
        gain=0.07,
        gravity_sine=0.3,
        gravity_cosine=-0.2,
        stiffness=0.4,
        neutral=0.1,
        bump_friction=0.2,
        bump_place=0.05,
        bump_width=0.02,
        zone_friction=0.3,
        zone_from=0.1,
        zone_to=0.2,
        zone_edge=0.01,
        droop=0.004,
    )
    waves = np.array([[0, 30.0, 0.2, 0.3], [1, 17.0, 0.1, 1.0], [2, 11.0, 0.05, 2.0]])
    c, (load, other, dry, smooth) = moved(rough, p, waves=waves)
    q, w = c.position, c.velocity
    s = np.sign(w)
    speed = np.abs(w)
    forward = w >= 0

    def wave(row: int) -> Any:
        return waves[row, 2] * np.cos(waves[row, 1] * q + waves[row, 3])

    acting = (1 + p.gain + wave(2)) * c.torque * (1 - p.droop * np.abs(c.torque))
    outside = load + other + p.offset + p.gravity_sine * np.sin(q) + p.gravity_cosine * np.cos(q)
    outside += p.stiffness * (q - p.neutral) + wave(0)
    viscous = np.where(forward, p.viscous_forward, p.viscous_backward) * smooth * speed + 0.05 * speed**2
    level = np.where(forward, p.coulomb_forward, p.coulomb_backward) * dry + 0.4 * np.exp(-((speed / 0.3) ** 1.5))
    level += (0.1 + np.where(load * w >= 0, 0.2, 0.05)) * np.abs(load) + wave(1)
    level += 0.2 * np.exp(-(((q - 0.05) / 0.02) ** 2))
    level += 0.15 * (np.tanh((q - 0.1) / 0.01) - np.tanh((q - 0.2) / 0.01))
    left = p.inertia * np.diff(w) / H - (acting - outside - s * (viscous + level))[:-1]
    sliding = (w[1:] * w[:-1] > 0) & (np.abs(w[:-1]) > 0)
    assert sliding.mean() > 0.9
    assert np.max(np.abs(left[sliding])) < 50 * np.finfo(float).eps * p.inertia * np.max(speed) / H
    np.testing.assert_allclose(np.diff(q), 0.5 * H * (w[1:] + w[:-1]), atol=1e-15)


def test_a_drive_pushed_by_less_than_its_friction_stands_still(rough: Any) -> None:
    p = rough.plant.Plant(0.5, 2.0, 2.0, 0.1, 0.1)
    time = np.zeros(400)
    reference = np.stack([time, time, np.full(400, 1.9)])
    inputs = np.stack([time, time, time + 1, time + 1])
    loop = rough.plant.Loop(0.0, 0.0, 0.0, 100.0, 0.0, 1.0, 12)
    still = rough.plant.simulate(p, loop, rough.plant.NO_WAVES, reference, inputs, H)
    assert not still.velocity.any()
    np.testing.assert_allclose(still.friction, 1.9)
    pushed = rough.plant.simulate(p, loop, rough.plant.NO_WAVES, reference * 1.1, inputs, H)
    assert pushed.velocity[-1] > 0


def test_an_elastic_contact_bends_back_over_its_distance(rough: Any) -> None:
    """After a reversal at q_r the deflection is ±(1 − 2 exp(−|q − q_r|/x_s)), whatever the speed."""
    p = rough.plant.Plant(0.5, 1.0, 1.0, 0.1, 0.1, presliding_distance=0.01, presliding_damping=1.0)
    c, _ = moved(rough, p)
    turns = np.flatnonzero((c.velocity[1:] < 0) & (c.velocity[:-1] >= 0)) + 1
    at = next(int(t) for t in turns if np.all(c.velocity[t : t + 1500] < 0) and c.deflection[t] > 0.99)
    until = at + 1500
    gone = np.abs(c.position[at:until] - c.position[at])
    expected = -1 + 2 * np.exp(-gone / 0.01)
    np.testing.assert_allclose(c.deflection[at:until], expected, atol=0.02)


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_two_masses_keep_their_momentum(rough: Any, gap: float) -> None:
    """Without friction all torque goes into momentum, and a stiff link moves with the motor."""
    p = rough.plant.Plant(
        0.5, 0.0, 0.0, 0.0, 0.0, link_inertia=0.3, gap=gap, contact_stiffness=2e5, contact_damping=50.0
    )
    c, (load, other, _, _) = moved(rough, p)
    momentum = 0.2 * c.velocity + 0.3 * c.link_velocity
    given = np.r_[0.0, np.cumsum((c.torque - load - other)[:-1])] * H
    np.testing.assert_allclose(momentum - momentum[0], given, atol=1e-10)
    assert np.max(np.abs(c.position - c.link_position)) < 0.5 * gap + 2e-3


@pytest.mark.parametrize("name", ["cogging", "torque-offset", "stiffness", "gravity"])
def test_an_effect_has_the_size_that_was_drawn(rough: Any, name: str) -> None:
    """The RMS of an effect's torque on the motion that is asked for is a share of the RMS torque within its bounds."""
    rng = np.random.default_rng(3)
    drive = rough.drives.drive(rng, turning=True)
    asked = rough.drives.nominal(rng, drive, "multisine")
    plant, waves = rough.effects.changed(drive.plant, (rough.effects.change(rng, name, drive, asked),))
    q = asked.position
    torque = plant.offset + plant.stiffness * (q - plant.neutral)
    torque = torque + plant.gravity_sine * np.sin(q) + plant.gravity_cosine * np.cos(q)
    torque = torque + sum(row[2] * np.cos(row[1] * q + row[3]) for row in waves)
    size = np.sqrt(np.mean(torque**2)) / asked.rms
    low, high = rough.effects.SIZES
    assert 0.5 * low < size < 1.5 * high


@pytest.mark.parametrize("seed", [0, 2, pytest.param(3, marks=pytest.mark.long)])
def test_a_clean_drive_comes_back(rough: Any, seed: int) -> None:
    from fricmodels.diagnosis import compare

    case = rough.trials.drawn(np.random.default_rng([77, seed]), [], [])
    recording = rough.record.record(case)
    found = compare(recording, "coulomb-viscous", case.inertia).estimate.parameters
    assert found["K_c"] == pytest.approx(case.drive.plant.coulomb_forward, rel=0.02)
    assert found["K_v"] == pytest.approx(case.drive.plant.viscous_forward, rel=0.05)
    again = rough.record.record(case)
    assert again.checksum == recording.checksum


def test_only_what_cannot_be_told_apart_counts_as_alike(rough: Any) -> None:
    row = {"listed": ["torque-offset"], "lag_samples": 0.0, "hidden": [{"name": "torque-offset"}], "load": ""}
    row |= {"motion": "sweeps", "turned": 20.0, "rests": 0.0}
    assert rough.judge.is_right(row, ["asymmetry"])
    assert not rough.judge.is_right({**row, "rests": 0.2}, ["asymmetry"])
    assert not rough.judge.is_right(row, ["sensor-delay"])
    assert rough.judge.is_right({**row, "lag_samples": -0.5}, ["sensor-delay"])
    assert not rough.judge.is_right(row, ["stiffness", "gravity"])


@pytest.mark.parametrize("index", [9, 32, 59])
def test_a_drive_that_rests_in_noise_keeps_its_friction(rough: Any, index: int) -> None:
    """Drives of the challenge whose rests the noise hid: K_c came out 40 % too small, or the error ten times the noise.

    9 also needs that a fit at the model's velocity be refused, 32 the position beside the velocity, 59 what happens at
    most from sample to sample.
    """
    from fricmodels.diagnosis import compare

    seeds = np.random.default_rng([11, zlib.crc32(b"null:"), index])
    case = rough.trials.drawn(seeds, [], [])
    fitted = compare(rough.record.record(case), "coulomb-viscous", case.inertia)
    assert fitted.estimate.parameters["K_c"] == pytest.approx(case.drive.plant.coulomb_forward, rel=0.01)
    assert fitted.errors.headline.held_out_percent < 2.0 * fitted.errors.headline.noise_floor_percent + 1.0


@pytest.mark.long
def test_two_causes_that_one_pair_of_channels_predicts_are_both_named(rough: Any) -> None:
    """Friction of the load and an asymmetry: load torque and direction together hold both, and nothing beyond them."""
    from fricmodels.diagnosis import diagnose

    rng = np.random.default_rng([63, zlib.crc32(b"several:"), 15])
    listed, unlisted = rough.trials.hidden(rng, "several", "")
    assert sorted(listed) == ["asymmetry", "load-friction"]
    case = rough.trials.drawn(rng, listed, unlisted, delayed=True)
    found = diagnose(rough.record.record(case), "coulomb-viscous", case.inertia)
    classes = [finding.names for finding in found.findings]
    assert len(classes) == 2
    assert any("load-friction" in names for names in classes)
    assert any("asymmetry" in names for names in classes)


def test_a_spring_is_not_the_inertia_torque_without_its_noise(rough: Any) -> None:
    """A clean spindle that swings at one frequency far from zero, without a position; the inertia is estimated."""
    from fricmodels.diagnosis import compare
    from fricmodels.diagnosis.candidate_tests import candidate_tests

    rng = np.random.default_rng([337, zlib.crc32(b"null:"), 40])
    case = rough.trials.drawn(rng, [], [])
    recording = rough.record.record(case)
    known = {name: values for name, values in recording.channels.items() if name != "position"}
    found = compare(replace(recording, channels=known), "coulomb-viscous", case.inertia)
    assert found.estimate.parameters["J"] == pytest.approx(case.drive.plant.inertia, rel=1e-3)
    result = candidate_tests(found.problem, found.estimate.parameters, only=["stiffness"])
    assert "noise of the velocity" in result.untested["stiffness"]
