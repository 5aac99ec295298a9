"""Every hidden effect leaves in the residual torque what the effects table says."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.rig import Rig, random_rig
from fricmodels.rig.effects import AnyEffect


def rig(*effects, excitation=None, **changes):
    tracking = {"kind": "tracking", "velocity": 2.0, "frequency": 0.3, "lines": 4, "bandwidth": 15.0}
    content = {
        "inertia": 1.5,
        "friction": {"viscous": 4.0, "coulomb": 10.0},
        "effects": effects,
        "excitation": excitation or tracking,
        "load": {"amplitude": 12.0, "bias": 3.0, "frequency": 0.11},
        "rate": 500.0,
        "samples": 10_000,
    }
    return Rig.model_validate({**content, **changes})


MOVES = {
    "kind": "trapezoid",
    "velocity": 2.0,
    "acceleration": 10.0,
    "span": 2.0,
    "rests": (0.05, 2.0),
    "bandwidth": 15.0,
}


def explained(rig, columns):
    """Share of the effect's torque, while sliding, that the signature explains; and its coefficients."""
    torque, quiet = rig.effect_torque(), rig.noiseless().simulate()
    w = quiet.velocity
    keep = np.abs(w) > 0.02 * np.abs(w).max()
    keep[:5] = False
    x = np.column_stack([column[keep] for column in columns(quiet)])
    coefficients, *_ = np.linalg.lstsq(x, torque[keep], rcond=None)
    rest = torque[keep] - x @ coefficients
    return 1 - np.sum(rest**2) / np.sum(torque[keep] ** 2), coefficients


def net(r):
    return r.torque - r.load_torque


def sign(r):
    return np.sign(r.velocity)


K = 7.3
WAVE = {"harmonics": [{"order": K, "amplitude": 2.0, "phase": 0.4}]}
EXPECTED = [2.0 * np.cos(0.4), -2.0 * np.sin(0.4)]
SIGNATURES = [
    ({"name": "asymmetry", "coulomb": 0.2, "viscous": 0.1}, lambda r: (np.ones(len(r)), abs(r.velocity)), [2.0, 0.4]),
    ({"name": "torque-offset", "torque": 1.5}, lambda r: (np.ones(len(r)),), [1.5]),
    (
        {"name": "stribeck", "rise": 4.0, "speed": 0.5, "exponent": 1.0},
        lambda r: (sign(r) * np.exp(-abs(r.velocity) / 0.5),),
        [4.0],
    ),
    (
        {"name": "nonlinear-viscous", "coefficient": 2.0, "exponent": 1.5},
        lambda r: (sign(r) * abs(r.velocity) ** 1.5,),
        [2.0],
    ),
    ({"name": "load-friction", "coefficient": 0.15}, lambda r: (sign(r) * abs(r.load_torque),), [0.15]),
    (
        {"name": "directional-efficiency", "driving": 0.2, "driven": 0.05},
        lambda r: [sign(r) * abs(r.load_torque) * (r.load_torque * r.velocity * side > 0) for side in (1, -1)],
        [0.2, 0.05],
    ),
    ({"name": "torque-gain", "error": 0.1}, lambda r: (r.torque,), [-0.1]),
    ({"name": "inertia-error", "error": 0.2}, lambda r: (np.gradient(r.velocity, r.time),), [0.3]),
    ({"name": "gravity", "sine": 2.0, "cosine": 1.0}, lambda r: (np.sin(r["position"]), np.cos(r["position"])), [2, 1]),
    ({"name": "stiffness", "stiffness": 3.0, "neutral": 0.5}, lambda r: (r["position"], np.ones(len(r))), [3, -1.5]),
    ({"name": "cogging", **WAVE}, lambda r: (np.cos(K * r["position"]), np.sin(K * r["position"])), EXPECTED),
    (
        {"name": "position-friction", **WAVE},
        lambda r: (sign(r) * np.cos(K * r["position"]), sign(r) * np.sin(K * r["position"])),
        EXPECTED,
    ),
    (
        {"name": "torque-ripple", "harmonics": [{"order": K, "amplitude": 0.1}]},
        lambda r: (r.torque * np.cos(K * r["position"]), r.torque * np.sin(K * r["position"])),
        [-0.1, 0.0],
    ),
    (
        {"name": "sensor-delay", "delay": 0.004, "channel": "motion"},
        lambda r: (net(r) - np.roll(net(r), 2),),
        [1.0],
    ),
    (
        {"name": "thermal", "end": 40.0, "time": 10.0, "coulomb": 0.01},
        lambda r: (sign(r) * (r["temperature"] - 30.0),),
        [-0.1],
    ),
    (
        {"name": "drift", "coulomb": 0.3, "time": 1000.0},
        lambda r: (sign(r) * r.time,),
        [10.0 * 0.3 / 1000.0],
    ),
    ({"name": "step-change", "time": 9.0, "coulomb": 2.0}, lambda r: (sign(r) * (r.time >= 9.0),), [2.0]),
]


@pytest.mark.parametrize(("effect", "columns", "expected"), SIGNATURES, ids=[s[0]["name"] for s in SIGNATURES])
def test_the_residual_is_the_signature(effect, columns, expected):
    share, coefficients = explained(rig(effect), columns)
    assert share > 0.98
    np.testing.assert_allclose(coefficients, expected, rtol=0.03, atol=0.02 * np.max(np.abs(expected)))


def test_nothing_hidden_leaves_nothing():
    plain = rig()
    sliding = np.abs(plain.simulate().velocity) > 0.02
    assert np.sqrt(np.mean(plain.effect_torque()[sliding] ** 2)) < 1e-2


def since_reversal(recording):
    """Distance travelled since the last reversal or rest."""
    w, q = recording.velocity, recording["position"]
    turned = np.concatenate([[True], (np.sign(w[1:]) != np.sign(w[:-1]))])
    start = np.maximum.accumulate(np.where(turned, np.arange(len(w)), 0))
    return np.abs(q - q[start])


@pytest.mark.parametrize("kind", ["dahl", "lugre", "maxwell-slip"])
def test_presliding_shows_within_its_width_after_each_reversal(kind):
    hidden = rig({"name": "presliding", "kind": kind, "width": 0.05}, load=None)
    torque, travelled = hidden.effect_torque(), since_reversal(hidden.noiseless().simulate())
    near, far = torque[(travelled > 0) & (travelled < 0.02)], torque[travelled > 0.4]
    assert np.sqrt(np.mean(near**2)) > 3.0
    assert np.quantile(np.abs(far), 0.95) < 0.05


def test_backlash_shows_a_pulse_after_each_reversal():
    gap = 0.1
    effect = {"name": "backlash", "gap": gap, "contact_frequency": 60.0, "load_friction_share": 0.5}
    hidden = rig(effect, load=None, excitation={"kind": "ramp", "velocity": 2.0, "period": 4.0, "bandwidth": 15.0})
    torque, travelled = hidden.effect_torque(), since_reversal(hidden.noiseless().simulate())
    inside = torque[(travelled > 0.1 * gap) & (travelled < 0.8 * gap)]
    beyond = torque[travelled > 4 * gap]
    assert np.median(np.abs(inside)) > 2.0
    assert np.quantile(np.abs(beyond), 0.9) < 0.2


def test_rising_stiction_shows_a_breakaway_peak_that_grows_with_the_rest():
    effect = {"name": "rising-stiction", "rise": 6.0, "time": 0.5, "distance": 0.05}
    hidden = rig(effect, load=None, excitation=MOVES, samples=20_000)
    recorded, torque = hidden.noiseless().simulate(), hidden.effect_torque()
    starts = np.flatnonzero((recorded.velocity[1:] != 0) & (recorded.velocity[:-1] == 0)) + 1
    stops = np.flatnonzero((recorded.velocity[1:] == 0) & (recorded.velocity[:-1] != 0)) + 1
    rests, peaks = [], []
    for start in starts:
        before = stops[stops < start]
        if len(before):
            rests.append((start - before[-1]) / 500.0)
            peaks.append(np.max(np.abs(torque[start : start + 3])))
    long, short = np.array(rests) > 0.5, np.array(rests) < 0.1
    assert np.median(np.array(peaks)[long]) > 2 * np.median(np.array(peaks)[short])
    assert np.sqrt(np.mean(torque[since_reversal(recorded) > 0.5] ** 2)) < 0.1


def test_frictional_lag_opens_a_loop_between_speeding_up_and_slowing_down():
    law = {"viscous": 4.0, "coulomb": 10.0, "stick": 15.0, "fall": 5.0}
    hidden = rig({"name": "frictional-lag", "delay": 0.03}, friction=law, load=None)
    recorded, torque = hidden.noiseless().simulate(), hidden.effect_torque()
    w = recorded.velocity
    rising = np.gradient(np.abs(w)) > 0
    slow = (np.abs(w) > 0.1) & (np.abs(w) < 0.5)
    loop = np.mean((torque * np.sign(w))[slow & rising]) - np.mean((torque * np.sign(w))[slow & ~rising])
    assert loop > 0.5


def test_joint_compliance_rings_against_the_resting_motor():
    effect = {"name": "joint-compliance", "frequency": 40.0, "load_inertia_share": 0.5}
    hidden = rig(effect, load=None, excitation=MOVES)
    torque = hidden.effect_torque()
    spectrum = np.abs(np.fft.rfft(torque * np.hanning(len(torque)))) ** 2
    frequencies = np.fft.rfftfreq(len(torque), 1 / 500.0)
    band = frequencies > 20.0
    peak = frequencies[band][np.argmax(spectrum[band])]
    assert peak == pytest.approx(40.0 * np.sqrt(0.5), rel=0.1)


@pytest.mark.parametrize("name", [e.model_fields["name"].default for e in AnyEffect.__origin__.__args__])
def test_every_effect_can_be_drawn_at_a_wanted_size(name):
    from fricmodels.rig import strength

    drawn = random_rig(np.random.default_rng(8), (name,), size=0.15, samples=4000)
    assert [effect.name for effect in drawn.effects] == [name]
    assert strength(drawn) == pytest.approx(0.15, rel=0.3)
