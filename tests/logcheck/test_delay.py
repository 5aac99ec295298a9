"""What is a late torque and what only looks so: a spring behind the drive, a contact that bends, cogging."""

from __future__ import annotations

import numpy as np
import pytest
from tests.logcheck.test_findings import CLEAN, changed, late

from fricmodels.dimension import Motion
from fricmodels.logcheck import Finding, findings
from fricmodels.logcheck.finding import Severity
from fricmodels.recording import Recording
from fricmodels.rig import Rig


def said(recording: Recording) -> list[Finding]:
    return [one for one in findings(recording) if one.kind == "torque-delay"]


@pytest.mark.parametrize("seed", [0, 1])
def test_cogging_and_a_stribeck_rise_are_no_delay(seed: int) -> None:
    """What the balance leaves out is a delay of 12 samples at one width, of none at the one that knows it best."""
    rig = Rig.model_validate(
        {
            "inertia": 0.05,
            "friction": {"viscous": 0.12, "coulomb": 0.8},
            "effects": [
                {"name": "cogging", "harmonics": [{"order": 7, "amplitude": 0.15}]},
                {"name": "stribeck", "rise": 0.4, "speed": 0.3},
            ],
            "excitation": {"kind": "tracking", "velocity": 3, "frequency": 0.3, "bandwidth": 8},
            "sensors": {"velocity_noise_percent": 0.1},
            "rate": 1000,
            "samples": 20_000,
            "seed": seed,
        }
    )
    assert not said(rig.simulate())


def moved(low: float, high: float, fastest: float, elastic: str, seed: int) -> Recording:
    """Return a drive on nine sines between two frequencies [Hz], with a link on a spring or a contact that bends."""
    rng = np.random.default_rng(seed)
    time = 2e-3 * np.arange(15_000)
    pulsation = 2 * np.pi * np.geomspace(low, high, 9) * rng.uniform(0.9, 1.1, 9)
    angle = np.outer(time, pulsation) + rng.uniform(0, 6, 9)
    size = fastest / np.abs(np.cos(angle).sum(axis=1)).max()
    velocity, position = size * np.cos(angle).sum(axis=1), size * np.sin(angle) @ (1 / pulsation)
    if elastic == "spring":  # of 6 Hz
        natural, damping = 2 * np.pi * 6.0, 0.08
        above = natural**2 + 2j * damping * natural * pulsation
        link = above / (above - pulsation**2)
        inertia = (0.25 + 0.12 * link) * 1j * pulsation
        torque = size * (np.exp(1j * angle) @ inertia).real + 0.8 * velocity + 3.0 * np.sign(velocity)
    else:  # Dahl's, over 0.02 rad
        state, bent = 0.0, np.zeros(len(time))
        for k in range(1, len(time)):
            step = position[k] - position[k - 1]
            state = (state + step / 0.02) / (1 + abs(step) / 0.02)
            bent[k] = state
        acceleration = -size * np.sin(angle) @ pulsation
        torque = 0.02 * acceleration + 0.05 * velocity + 0.02 * np.sign(velocity) + 0.28 * bent
    channels = {
        "time": time,
        "torque": torque + 0.02 * np.std(torque) * rng.standard_normal(len(time)),
        "velocity": velocity + 1e-3 * fastest * rng.standard_normal(len(time)),
        "position": position + 1e-6 * rng.standard_normal(len(time)),
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


SPRING, BENT = (0.3, 8.0, 3.0, "spring"), (0.4, 3.0, 0.6, "contact")


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("drive", [SPRING, BENT])
def test_a_spring_and_a_contact_that_bends_are_no_delay(drive: tuple[float, float, float, str], seed: int) -> None:
    """One is late at some frequencies, the other after reversals only; no shift of the torque undoes that."""
    assert not said(moved(*drive, seed))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("fastest", [5.0, 6.0])
def test_what_may_be_a_spring_is_not_to_be_shifted(fastest: float, seed: int) -> None:
    """A heavy link that is moved up to its resonance is late nearly as if its torque was."""
    found = said(moved(0.3, fastest, 3.0, "spring", seed))
    assert all("looks as if" in one.text and "improve" in one.remedy for one in found)
    assert all(one.severity is Severity.NOTE for one in found)


@pytest.mark.parametrize("samples", [4, 8, 20])
def test_a_known_delay_is_told_as_long_as_it_is(samples: int) -> None:
    [found] = said(changed(torque=late(CLEAN.torque, samples)))
    assert float(found.text.partition("(")[2].partition(" samples")[0]) == pytest.approx(samples, abs=0.3)
    assert "looks as if" not in found.text
    assert found.severity is Severity.WARN
    assert found.remedy.startswith("shift it")


def started(seed: int) -> Recording:
    """Return moves of 1.5 to 3 s with rests between them, and a friction that fades within 0.3 s of each start."""
    rng, step = np.random.default_rng(seed), 2e-3
    speed, since = [], []
    while sum(map(len, speed)) < 20_000:
        going = step * np.arange(int(rng.uniform(1.5, 3.0) / step))
        share = going / going[-1]
        peak = rng.uniform(0.6, 1.5) * rng.choice([-1.0, 1.0])
        speed += [peak * np.clip(4.0 * np.minimum(share, 1.0 - share), 0.0, 1.0), np.zeros(150)]
        since += [going, np.full(150, 10.0)]
    velocity, age = np.concatenate(speed)[:20_000], np.concatenate(since)[:20_000]
    friction = 8.0 * velocity + np.sign(velocity) * (12.0 + 12.0 * np.exp(-age / 0.3))
    noise = rng.standard_normal((2, 20_000))
    channels = {
        "time": step * np.arange(20_000),
        "torque": 1.2 * np.gradient(velocity, step) + friction + 0.1 * noise[0],
        "velocity": velocity + 1e-4 * noise[1],
        "position": np.cumsum(velocity) * step,
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(20_000, dtype=np.int64))


@pytest.mark.parametrize("seed", range(4))
def test_friction_that_fades_after_each_start_is_no_delay(seed: int) -> None:
    """It falls once the speed has risen, as if the torque was late: by two samples at one width, by 20 at another."""
    assert not said(started(seed))


def counted(bits: int, samples: int = 15_000) -> Recording:
    """Return a servo that follows two sines, with an encoder of so many bits and without a velocity."""
    inertia, viscous, coulomb, step = 0.0031, 0.012, 0.06, 5e-4
    time = step * np.arange(4.0 * samples)
    wanted = 0.7 * np.sin(np.pi * time) + 0.1 * np.sin(3.0 * np.pi * time + 2.0)
    rate = np.gradient(wanted, step)
    angle = speed = lasting = 0.0
    position, torque = np.empty(len(time)), np.empty(len(time))
    for k in range(len(time)):
        lasting += step * (wanted[k] - angle)
        torque[k] = 5.0 * (wanted[k] - angle) + 0.15 * (rate[k] - speed) + 0.5 * lasting
        position[k] = angle
        free, held = (x / (inertia + step * viscous) for x in (inertia * speed + step * torque[k], step * coulomb))
        speed = float(np.sign(free)) * max(abs(free) - held, 0.0)
        angle += step * speed
    count = 2.0 * np.pi / 2**bits
    noisy = torque[::4] + 0.02 * np.std(torque) * np.random.default_rng(0).standard_normal(samples)
    channels = {"time": time[::4], "torque": noisy, "position": count * np.round(position[::4] / count)}
    return Recording("counts", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))


@pytest.mark.parametrize("bits", [10, 11])
def test_coarse_counts_are_no_delay(bits: int) -> None:
    """Counts blur the acceleration: what the balance then misses of the inertia goes with the change of K_v ω."""
    assert not said(counted(bits))


def test_a_late_torque_beside_counts_that_are_fine_enough_is_still_one() -> None:
    recording = counted(16)
    assert said(changed(recording, torque=late(recording.torque, 8)))
