"""A stop that gives way ends a motion while the motor pushes on; a motor that stops a drive pushes less."""

import re

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.logcheck import findings
from fricmodels.recording import Recording

INERTIA, VISCOUS, COULOMB, LIMIT = 0.05, 0.1, 0.8, 3.0
RATE, FINE = 500, 20


def driven(wanted: np.ndarray, stop: float, stiffness: float) -> Recording:
    """Return a drive under a controller with an integrator and a limit; ``stop``: where it can go no further [rad]."""
    position = speed = held = 0.0
    rows, step = [], 1.0 / (RATE * FINE)
    for number, target in enumerate(wanted):
        error = target - position
        held = float(np.clip(held + 40.0 * error / RATE, -LIMIT, LIMIT))
        torque = float(np.clip(60.0 * error - 2.0 * speed + held, -LIMIT, LIMIT))
        rows.append((number / RATE, torque, speed, position))
        for _ in range(FINE):
            beyond = max(abs(position) - stop, 0.0) * np.sign(position)
            push = torque - (stiffness * beyond + 1.2 * speed * (beyond != 0.0)) - VISCOUS * speed
            slowed = speed + step * (push - COULOMB * np.sign(speed)) / INERTIA
            still = speed * slowed <= 0.0 and abs(push) <= COULOMB
            speed = 0.0 if still else slowed
            position += step * speed
    time, torque, velocity, place = np.array(rows).T
    rng = np.random.default_rng(5)
    channels = {
        "time": time,
        "torque": torque + 0.01 * rng.standard_normal(len(time)),
        "velocity": velocity + 0.003 * rng.standard_normal(len(time)),
        "position": np.round(place / 1e-3) * 1e-3,
    }
    return Recording("driven", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.fixture(scope="module")
def path() -> np.ndarray:
    """Targets in ramps with rests, every other one beyond 1 rad."""
    rng = np.random.default_rng(2)
    ends = [value for _ in range(6) for value in (1.15, *rng.uniform(-0.8, 0.8, 1), -1.15, *rng.uniform(-0.8, 0.8, 1))]
    whole, now = [], 0.0
    for end in ends:
        count = int(abs(end - now) / 2.0 * RATE)
        whole += [np.linspace(now, end, count), np.full(RATE // 4, end)]
        now = end
    return np.concatenate(whole)


@pytest.mark.parametrize("stiffness", [300.0, 3e4])
def test_a_stop_that_gives_way_is_seen(path: np.ndarray, stiffness: float):
    (found,) = (f for f in findings(driven(path, 1.0, stiffness)) if f.kind == "end-stop")
    upper, lower = map(float, re.findall(r"^at (\S+) and (\S+) rad", found.text)[0])
    assert upper == pytest.approx(1.01, abs=0.02)
    assert lower == pytest.approx(-1.01, abs=0.02)
    assert int(re.findall(r"pushes on, (\d+) times", found.text)[0]) >= 9


def test_a_motor_that_stops_its_drive_is_none(path: np.ndarray):
    assert "end-stop" not in {found.kind for found in findings(driven(path, 2.0, 0.0))}


def test_the_border_of_two_runs_hides_no_stop(path: np.ndarray):
    first, second = driven(path, 1.0, 3e4), driven(-path, 1.0, 3e4)
    later = first["time"][-1] + 100.0 + second["time"]
    channels = {name: np.r_[first[name], second[name]] for name in first.channels}
    run = np.repeat([0, 1], [len(first), len(second)])
    both = Recording("both", Motion.ROTARY, {**channels, "time": np.r_[first["time"], later]}, run)
    assert "end-stop" in {found.kind for found in findings(both)}
