"""The sign of a torque, of a motion of few steps of its sensor."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.logcheck import Severity, findings
from fricmodels.recording import Recording


def relay(steps: int, interval: float = 0.006) -> Recording:
    """Return a motor that a relay holds about an angle, logged in whole degrees: it goes back and forth by a few.

    The row holds the command that was in force when the angle was read; the new one acts 0.4 ms later.
    """
    inertia, viscous, coulomb, step = 0.943, 8.76, 6.2, 1e-4
    velocity, angle, command, inside = 0.0, np.radians(133.2), 50.0, round(interval / step)
    rows = []
    for _ in range(steps):
        read = np.floor(np.degrees(angle))
        rows.append((command, np.radians(read)))
        acting, command = command, 50.0 * np.sign(135.0 - read)
        for i in range(inside):
            pushes = acting if i < 4 else command
            if abs(velocity) < 1e-7 and abs(pushes) <= coulomb:
                continue
            side = np.sign(velocity) if abs(velocity) >= 1e-7 else np.sign(pushes)
            later = velocity + step * (pushes - viscous * velocity - coulomb * side) / inertia
            velocity = 0.0 if abs(velocity) >= 1e-7 and velocity * later < 0 else later
            angle += step * velocity
    torque, position = np.array(rows).T
    channels = {"time": interval * np.arange(steps), "torque": torque, "position": position}
    return Recording("relay", Motion.ROTARY, channels, np.zeros(steps, dtype=np.int64))


def test_the_sign_of_a_torque_is_judged_by_the_positions_and_not_by_what_smoothing_leaves_of_them() -> None:
    recording = relay(3000)
    change = np.diff(recording["position"])
    assert min(recording.torque[:-1] @ change, recording.torque[1:] @ change) > 0.0
    assert "torque-sign" not in {one.kind for one in findings(recording)}


def moved_by_hand(inertia: float) -> Recording:
    """Return an arm that is swung to and fro; without inertia a motor answers, else it drives, turned."""
    rng, time = np.random.default_rng(0), 0.01 * np.arange(4000)
    waves = zip((1.3, 2.9, 4.3), rng.uniform(0, 6, 3), (0.8, 0.3, 0.1), strict=True)
    course = np.sum([[a * np.sin(f * time + p), a * f * np.cos(f * time + p), -a * f**2 * np.sin(f * time + p)]
                     for f, p, a in waves], axis=0)  # fmt: skip
    position, velocity, acceleration = course
    driven = inertia * acceleration + 0.05 * velocity + 0.2 * np.sign(velocity) * (inertia > 0.0)
    torque = 0.74 * np.sin(position) * (inertia == 0.0) - driven + 0.002 * rng.standard_normal(4000)
    channels = {
        "time": time,
        "torque": torque,
        "velocity": velocity + 0.003 * rng.standard_normal(4000),
        "position": position,
    }
    return Recording("hand", Motion.ROTARY, channels, np.zeros(4000, dtype=np.int64))


@pytest.mark.parametrize(("inertia", "else_"), [(0.0, True), (0.05, False)])
def test_where_no_inertia_shows_something_else_may_have_moved_it(inertia: float, else_: bool) -> None:
    (found,) = (one for one in findings(moved_by_hand(inertia)) if one.kind == "torque-sign")
    assert found.severity is Severity.STOP
    assert ("something else moved it" in found.remedy) is else_
