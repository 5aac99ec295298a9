"""Rigs: sensors, seeds, sizes, and rigs drawn at random."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.rig import SCALES, Rig, random_rig, strength, with_size

BASE = {
    "inertia": 1.5,
    "friction": {"viscous": 4.0, "coulomb": 10.0},
    "excitation": {"kind": "multisine", "amplitude": 30.0, "frequency": 0.3},
    "rate": 500.0,
    "samples": 4000,
}


def rig(**changes):
    return Rig.model_validate({**BASE, **changes})


def test_the_same_seed_gives_the_same_recording_and_another_seed_another():
    noisy = {"velocity_noise_percent": 2.0, "jitter_percent": 10.0, "dropout_percent": 2.0}
    first, again, other = (rig(sensors=noisy, runs=2, seed=seed).simulate() for seed in (1, 1, 2))
    assert first.checksum == again.checksum
    assert first.checksum != other.checksum
    assert first.run[0] == 0
    assert first.run[-1] == 1
    assert not np.array_equal(first.torque[first.run == 0][:50], first.torque[first.run == 1][:50])


def test_velocity_noise_is_its_percentage_of_the_rms_velocity():
    clean, noisy = rig().simulate(), rig(sensors={"velocity_noise_percent": 3.0}).simulate()
    noise = noisy.velocity - clean.velocity
    assert np.std(noise) / np.sqrt(np.mean(clean.velocity**2)) == pytest.approx(0.03, rel=0.05)
    np.testing.assert_array_equal(noisy.torque, clean.torque)


def test_an_encoder_counts_and_a_log_may_have_positions_only():
    recording = rig(sensors={"velocity": "none", "encoder_step": 1e-3}).simulate()
    assert set(recording.channels) == {"time", "torque", "position"}
    counts = recording["position"] / 1e-3
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


def test_jitter_and_drop_outs_keep_true_time_stamps():
    quiet = rig().simulate()
    uneven = rig(sensors={"jitter_percent": 50.0, "dropout_percent": 10.0}).simulate()
    assert np.all(np.diff(uneven.time) > 0)
    assert len(uneven) / len(quiet) == pytest.approx(0.9, abs=0.04)
    assert np.diff(uneven.time).std() > 1e-4
    np.testing.assert_allclose(uneven.velocity, np.interp(uneven.time, quiet.time, quiet.velocity), atol=0.02)


def test_a_sensor_delay_shifts_motion_behind_torque():
    quiet = rig().simulate()
    delayed = rig(effects=[{"name": "sensor-delay", "delay": 0.006}]).simulate()
    np.testing.assert_allclose(delayed.velocity[3:], quiet.velocity[:-3], atol=1e-12)
    np.testing.assert_array_equal(delayed.torque, quiet.torque)
    late = rig(effects=[{"name": "sensor-delay", "delay": 0.006, "channel": "torque"}]).simulate()
    np.testing.assert_allclose(late.torque[3:], quiet.torque[:-3])


def test_feedback_noise_reaches_the_torque_only_where_asked():
    tracking = {"kind": "tracking", "velocity": 2.0, "frequency": 0.3, "bandwidth": 10.0}
    clean, outside, inside = (
        rig(excitation=tracking, sensors=sensors).simulate().torque
        for sensors in (
            {},
            {"velocity_noise_percent": 2.0},
            {"velocity_noise_percent": 2.0, "noisy_feedback": True},
        )
    )
    np.testing.assert_array_equal(clean, outside)
    assert np.std(inside - clean) > 0.05 * np.std(clean)


def test_the_torque_stays_within_its_limit():
    tracking = {"kind": "tracking", "velocity": 2.0, "frequency": 0.3, "bandwidth": 10.0}
    torque = rig(excitation=tracking, torque_limit=12.0).simulate().torque
    assert np.max(np.abs(torque)) == 12.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"friction": {"viscous": 1.0, "coulomb": 2.0, "stick": 1.0, "fall": 1.0}}, "below"),
        ({"friction": {"viscous": 1.0, "coulomb": 2.0, "stick": 3.0}}, "together"),
        ({"effects": [{"name": "torque-gain", "error": 0.1}] * 2}, "twice"),
        (
            {
                "effects": [
                    {"name": "backlash", "gap": 0.1, "contact_frequency": 50.0},
                    {"name": "joint-compliance", "frequency": 20.0},
                ]
            },
            "together",
        ),
        ({"effects": [{"name": "cogging", "harmonics": [{"order": 3, "amplitude": 0.1}] * 17}]}, "16"),
    ],
)
def test_impossible_rigs_are_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        rig(**changes)


@pytest.mark.parametrize(
    ("friction", "keys"),
    [
        ({"viscous": 4.0, "coulomb": 10.0}, ["K_v", "K_c"]),
        ({"viscous": (4.0, 3.0), "coulomb": 10.0}, ["K_v1", "K_v2", "K_c1", "K_c2"]),
        ({"viscous": 4.0, "coulomb": 10.0, "stick": 12.0, "fall": 3.0}, ["K_v", "K_c", "C", "B"]),
    ],
)
def test_the_truth_has_the_names_of_the_law(friction, keys):
    from fricmodels.model import Model

    drawn = rig(friction=friction)
    assert [key for key in drawn.truth["true_parameters"] if key != "J"] == keys
    assert {parameter.key for parameter in Model.parse(drawn.friction.law).parameters} == set(keys)


def test_two_effects_can_be_hidden_at_once():
    drawn = random_rig(np.random.default_rng(3), ("cogging", "stribeck"), size=(0.2, 0.1), samples=4000)
    assert [effect.name for effect in drawn.effects] == ["cogging", "stribeck"]
    assert strength(drawn) == pytest.approx(np.hypot(0.2, 0.1), rel=0.3)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("excitation", ["sine", "multisine", "tracking", "trapezoid", "stair", "ramp"])
def test_every_scale_moves_under_every_excitation(scale, excitation):
    drawn = random_rig(np.random.default_rng(1), (), scale=scale, excitation=excitation, samples=4000)
    assert drawn.motion is SCALES[scale].motion
    assert drawn.excitation.kind == excitation
    assert strength(drawn) < 0.02


def test_random_rigs_are_reproducible_and_refuse_what_they_do_not_know():
    first, again = (random_rig(np.random.default_rng(5), ("thermal",), samples=2000) for _ in range(2))
    assert first == again
    with pytest.raises(InputError, match="did you mean 'cogging'"):
        random_rig(np.random.default_rng(5), ("coging",))
    with pytest.raises(InputError, match="does not show rising-stiction"):
        random_rig(np.random.default_rng(5), ("rising-stiction",), excitation="sine")
    with pytest.raises(InputError, match="together"):
        random_rig(np.random.default_rng(5), ("backlash", "joint-compliance"))


def test_scaling_to_a_size_is_exact_for_what_is_linear():
    drawn = with_size(rig(effects=[{"name": "torque-offset", "torque": 1.0}]), 0.1)
    assert strength(drawn) == pytest.approx(0.1, rel=0.05)


def test_a_rig_that_never_moves_has_no_strength():
    stuck = rig(excitation={"kind": "sine", "amplitude": 5.0, "frequency": 1.0})
    assert np.isnan(strength(stuck))


def test_a_copy_is_simulated_anew():
    first = rig()
    assert first.simulate().checksum != first.model_copy(update={"seed": 5}).simulate().checksum


def test_a_rig_travels_to_another_process_without_its_motion():
    first = rig()
    first.simulate()
    assert "histories" in first.__dict__
    assert "histories" not in first.__getstate__()["__dict__"]
    assert "histories" in first.__dict__


def test_a_drive_whose_controller_is_unstable_is_refused():
    closed = {"kind": "tracking", "velocity": 2.0, "frequency": 0.3, "lines": 3, "bandwidth": 20.0}
    joint = [{"name": "joint-compliance", "frequency": 25.0, "load_inertia_share": 0.9, "damping_ratio": 0.01}]
    stable = rig(excitation={**closed, "bandwidth": 2.0}, effects=joint)
    assert np.max(np.abs(stable.simulate().velocity)) < 4.0
    unstable = rig(excitation=closed, effects=joint, sensors={"velocity_noise_percent": 5.0, "noisy_feedback": True})
    with pytest.raises(InputError, match="runs away: its controller is unstable"):
        unstable.simulate()
    second_lost = rig(runs=2)
    second_lost.__dict__["histories"] = tuple(
        replace(h, velocity=np.full_like(h.velocity, value))
        for h, value in zip(second_lost.histories, (1.0, np.nan), strict=True)
    )
    with pytest.raises(InputError, match="runs away: nothing bounds"):
        second_lost.simulate()
    assert strength(unstable) > 100
