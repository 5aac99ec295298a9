"""The rig's motion against analytic limits and an independent integration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricmodels.rig.motion import simulate
from fricmodels.rig.physics import PHYSICS

STEP = 1e-3


def physics(**values):
    p = np.zeros(1, dtype=PHYSICS)[0]
    fixed = {"motor_inertia": 1.0, "motor_share": 1.0, "step_time": np.inf, "torque_limit": np.inf}
    fixed |= {"stribeck_speed": 1.0, "stribeck_exponent": 1.0, "ageing_time": 1.0, "ageing_distance": 1.0}
    for name, value in {**fixed, **values}.items():
        p[name] = value
    return p


def both(name, value):
    return {f"{name}_forward": value, f"{name}_backward": value}


def run(p, torque, *, start=(0.0, 0.0), load=None, hold=False, substeps=20, interval=STEP):
    torque = np.array(torque, dtype=float)
    n = len(torque)
    position, velocity = np.zeros(n * substeps), np.zeros(n * substeps)
    known, temperature = np.zeros(n), np.zeros(n)
    given = np.zeros(n) if load is None else load
    reference, quiet = np.zeros((n, 2)), np.zeros(n)
    begin = np.array(start, dtype=float)
    simulate(
        p, torque, reference, quiet, given, begin, hold, interval, substeps, 0.0, position, velocity, known, temperature
    )
    return np.arange(n * substeps) * interval / substeps, position, velocity


def test_constant_torque_reaches_the_speed_where_friction_balances_it():
    p = physics(**both("viscous", 2.0), **both("coulomb", 0.5))
    _, _, w = run(p, np.full(8000, 3.0))
    assert w[-1] == pytest.approx((3.0 - 0.5) / 2.0, rel=1e-5)


def test_speed_decays_exponentially_under_viscous_friction():
    p = physics(**both("viscous", 3.0))
    t, q, w = run(p, np.zeros(1000), start=(0.0, 2.0))
    np.testing.assert_allclose(w, 2.0 * np.exp(-3.0 * t), rtol=1e-6)
    np.testing.assert_allclose(q, 2.0 / 3.0 * -np.expm1(-3.0 * t), atol=1e-8)


def test_coulomb_friction_stops_the_drive_at_the_exact_instant_and_place():
    p = physics(**both("coulomb", 2.0))
    t, q, w = run(p, np.zeros(1000), start=(0.0, 1.0))
    assert np.all(w[t > 0.5] == 0.0)
    assert q[-1] == pytest.approx(0.25, rel=1e-9)


def test_the_drive_sticks_until_the_torque_exceeds_the_breakaway_torque():
    p = physics(**both("coulomb", 1.0), **both("rise", 0.5), **both("fall", 4.0))
    torque = np.linspace(0.0, 2.0, 2000)
    t, _, w = run(p, torque)
    breakaway = 1.5 / 2.0 * 1.999
    assert np.all(w[t < breakaway - 1e-4] == 0.0)
    assert np.all(w[t > breakaway + 2e-4] > 0.0)


def test_a_held_torque_waits_for_its_sample():
    p = physics()
    torque = np.zeros(100)
    torque[50:] = 1.0
    t, _, w = run(p, torque, hold=True)
    np.testing.assert_allclose(w, np.maximum(t - 0.050, 0.0), atol=1e-12)


def test_a_spring_swings_at_its_own_frequency():
    p = physics(stiffness=400.0)
    t, q, _ = run(p, np.zeros(2000), start=(0.1, 0.0))
    np.testing.assert_allclose(q, 0.1 * np.cos(20.0 * t), atol=2e-5)


def test_two_masses_swing_at_the_resonance_of_their_joint():
    p = physics(motor_inertia=1.0, load_inertia=3.0, coupling_stiffness=300.0)
    n = 4000
    torque = np.where(np.arange(n) < 5, 100.0, 0.0)
    t, _, w = run(p, torque)
    free = t > 0.01
    omega = np.sqrt(300.0 * (1 + 1 / 3))
    columns = np.column_stack([np.ones(free.sum()), np.cos(omega * t[free]), np.sin(omega * t[free])])
    _, residual, *_ = np.linalg.lstsq(columns, w[free], rcond=None)
    assert residual[0] < 1e-5 * np.sum((w[free] - w[free].mean()) ** 2)


def test_backlash_frees_the_motor_over_the_width_of_the_gap():
    gap = 0.2
    p = physics(motor_inertia=1.0, load_inertia=50.0, coupling_stiffness=1e5, coupling_damping=600.0, gap=gap)
    t, q, w = run(p, np.full(800, 1.0))
    meets = np.argmax(w > 0.5 * w.max()) and np.argmax(np.diff(w) < 0)
    assert q[meets] == pytest.approx(gap / 2, abs=1e-3)
    assert w[meets] == pytest.approx(np.sqrt(gap), rel=1e-2)
    assert w[-1] == pytest.approx(t[-1] / 51.0, rel=0.05)


@pytest.mark.parametrize("kind", [1.0, 2.0, 3.0])
def test_presliding_is_a_spring_of_coulomb_torque_over_width(kind):
    width, coulomb = 0.01, 2.0
    p = physics(presliding=kind, elastic_width=width, **both("coulomb", coulomb), **both("viscous", 20.0))
    _, q, _ = run(p, np.full(4000, 0.02))
    slope = coulomb / width if kind != 3.0 else coulomb / width * np.mean([4.0, 2.0, 4 / 3, 1.0])
    assert q[-1] == pytest.approx(0.02 / slope, rel=0.02)


@pytest.mark.parametrize("kind", [1.0, 2.0, 3.0])
def test_presliding_gives_full_coulomb_friction_far_beyond_its_width(kind):
    p = physics(presliding=kind, elastic_width=0.01, **both("coulomb", 2.0), **both("viscous", 1.0))
    _, _, w = run(p, np.full(9000, 3.0))
    assert w[-1] == pytest.approx(1.0, rel=1e-3)


def test_breakaway_torque_grows_with_the_time_at_rest():
    p = physics(**both("coulomb", 1.0), ageing_rise=1.0, ageing_time=0.5, ageing_distance=1e-3)
    reached = []
    for rest in (200, 500, 2000):
        torque = np.concatenate([np.zeros(rest), np.linspace(0.0, 3.0, 3000)])
        t, _, w = run(p, torque)
        at = t[np.argmax(w > 0)]
        reached.append((3.0 * (at - rest * STEP) / (2999 * STEP), 1.0 + at / (at + 0.5)))
    measured, expected = np.array(reached).T
    np.testing.assert_allclose(measured, expected, rtol=1e-3)
    assert np.all(np.diff(measured) > 0.02)


def test_frictional_lag_delays_friction_behind_speed():
    p = physics(**both("viscous", 5.0), lag=0.02)
    t, _, w = run(p, np.sin(2 * np.pi * np.arange(3000) * STEP), start=(0.0, 0.0))
    step = t[1]
    behind = round(0.02 / step)
    k = np.arange(30_000, 58_000)
    torque = np.interp(t[k], np.arange(3000) * STEP, np.sin(2 * np.pi * np.arange(3000) * STEP))
    sliding = np.abs(w[k]) > 0.02
    residual = torque - np.gradient(w, step)[k] - 5.0 * np.abs(w[k - behind]) * np.sign(w[k])
    assert np.max(np.abs(residual[sliding])) < 2e-3


def test_energy_is_what_the_torque_puts_in_less_what_friction_takes():
    p = physics(motor_inertia=2.0, stiffness=5.0, **both("viscous", 0.7), **both("coulomb", 1.0))
    torque = 4.0 * np.sin(2 * np.pi * 0.7 * np.arange(5000) * STEP)
    t, q, w = run(p, torque)
    motor = np.interp(t, np.arange(5000) * STEP, torque)
    lost = 0.7 * w**2 + np.abs(w)
    work = np.concatenate([[0], np.cumsum(0.5 * ((motor * w - lost)[1:] + (motor * w - lost)[:-1]) * np.diff(t))])
    stored = 0.5 * 2.0 * w**2 + 0.5 * 5.0 * q**2
    assert np.max(np.abs(work - stored)) < 1e-4 * stored.max()


def reference(torque, coulomb, viscous, duration):
    """Integrate dω/dt = τ − τ_F with SciPy, switching between sliding and sticking at located events."""
    t, w, place = 0.0, 0.0, 0.0
    times, speeds = [0.0], [0.0]
    while t < duration:
        side = 0.0 if abs(torque(t)) <= coulomb else np.sign(torque(t))

        def stops(_, y):
            return y[1]

        def breaks(time, _):
            return abs(torque(time)) - coulomb

        event = breaks if side == 0 else stops
        event.terminal, event.direction = True, (1.0 if side == 0 else -side)

        def rate(time, y, side=side):
            return [y[1], 0.0 if side == 0 else torque(time) - side * coulomb - viscous * y[1]]

        begin = t + (1e-9 if side else 0.0)
        begins = [place, w + 1e-12 * side]
        solution = solve_ivp(
            rate, (begin, duration), begins, events=event, dense_output=True, rtol=1e-10, atol=1e-13, max_step=0.01
        )
        dense = np.linspace(begin, solution.t[-1], 20_000)[1:]
        times.extend(dense)
        speeds.extend(solution.sol(dense)[1])
        t, place = solution.t[-1] + 1e-12, solution.y[0][-1]
        w = 0.0
    return np.array(times), np.array(speeds), place


def test_coulomb_viscous_motion_agrees_with_an_event_based_integration():
    def torque(t):
        return 1.7 * np.sin(2 * np.pi * t) + 0.4 * np.cos(6 * np.pi * t)

    p = physics(**both("coulomb", 1.0), **both("viscous", 0.8))
    samples = np.arange(6000) * 5e-4
    t, q, w = run(p, torque(samples), interval=5e-4)
    times, speeds, place = reference(torque, 1.0, 0.8, t[-1])
    assert np.mean(w == 0) > 0.1
    np.testing.assert_allclose(w, np.interp(t, times, speeds), rtol=0, atol=2e-5 * np.abs(speeds).max())
    assert q[-1] == pytest.approx(place, abs=1e-5)


@pytest.mark.parametrize(
    "extra",
    [
        {},
        {"stribeck_rise": 0.5, "stribeck_speed": 0.1, "stribeck_exponent": 2.0},
        {"presliding": 1.0, "elastic_width": 0.01},
        {"load_inertia": 1.0, "coupling_stiffness": 2000.0, "coupling_damping": 5.0, "motor_share": 0.6},
        {"gravity_sine": 1.0, "power_coefficient": 0.1, "power_exponent": 2.0},
    ],
)
def test_halving_the_sub_steps_changes_little_and_quarters_the_error(extra):
    torque = 4.0 * np.sin(2 * np.pi * 1.3 * np.arange(2000) * STEP)
    p = physics(**both("coulomb", 1.0), **both("viscous", 0.8), **extra)
    ends = {m: run(p, torque, substeps=m)[2][::m] for m in (10, 20, 80)}
    coarse, fine = (np.sqrt(np.mean((ends[m] - ends[80]) ** 2)) for m in (10, 20))
    assert fine < 1e-4 * np.sqrt(np.mean(ends[80] ** 2))
    assert fine < 0.45 * coarse
